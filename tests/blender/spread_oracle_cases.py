"""The materials that test_spread_oracle.py compares with Cycles: bodies that light goes through, hair, and all other shaders."""

import bpy
import scenes
from oracle_case import Case

RADIUS = (0.3, 0.15, 0.08)
# Names of Blender 3 and of 4.
FIXED, PHYSICAL = (
    ("RANDOM_WALK_FIXED_RADIUS", "RANDOM_WALK")
    if bpy.app.version < (4, 0, 0)
    else ("RANDOM_WALK", "RANDOM_WALK_SKIN")
    if bpy.app.version < (5, 2, 0)
    else ("RANDOM_WALK_LEGACY", "RANDOM_WALK_SKIN")
)


NEWER = ["RANDOM_WALK"] if bpy.app.version >= (5, 2, 0) else []


def subsurface_cases():
    """The node and the Principled shader, by method, index, anisotropy and share."""
    color = {"Color": (0.8, 0.5, 0.3, 1), "Radius": RADIUS}
    node = "ShaderNodeSubsurfaceScattering"
    found = []
    for falloff in (FIXED, PHYSICAL, *NEWER):
        for more in ({}, {"Scale": 4.0}, {"Anisotropy": 0.8}, {"Radius": (0.3, 0.0, 0.08)}):
            found.append(Case(node, {"falloff": falloff}, {**color, **more}))
    if bpy.app.version >= (4, 2, 0):
        found += [Case(node, {"falloff": FIXED}, {**color, "Roughness": each, "Scale": 4.0}) for each in (0.2, 0.8)]
    found.append(Case(node, {"falloff": PHYSICAL}, {**color, "IOR": 2.5}))
    found.append(Case(node, {"falloff": PHYSICAL}, {**color, "Color": (1.0, 0.02, 0.0, 1)}))
    found.append(Case(node, {"falloff": PHYSICAL}, {**color, "Normal": "leaning"}))
    for more in ({}, {"Scale": 4.0}, {"Radius": (0.3, 0.0, 0.08)}, {"Normal": "leaning"}):
        found.append(Case(node, {"falloff": "BURLEY"}, {**color, **more}))
    node = "ShaderNodeBsdfPrincipled"
    both = {"Base Color": (0.8, 0.5, 0.3, 1), "Subsurface Radius": RADIUS}
    both |= {"Subsurface Color": (0.3, 0.7, 0.8, 1)} if bpy.app.version < (4, 0, 0) else {"Subsurface Scale": 1.0}
    share = scenes.SUBSURFACE
    for method in (FIXED, PHYSICAL, "BURLEY", *NEWER):
        for more in ({share: 1.0}, {share: 0.3, "Roughness": 1.0}, {share: 1.0, "Metallic": 0.5}):
            found.append(Case(node, {"subsurface_method": method}, {**both, **more}))
    inputs = {share: 1.0, "Subsurface IOR": 1.8, "Subsurface Anisotropy": 0.5}
    return found + [Case(node, {"subsurface_method": PHYSICAL}, {**both, **inputs})]


def hair_cases():
    """Both components of the node, and the principled one by all its colours."""
    found = []
    for component in ("Reflection", "Transmission"):
        for more in (
            {},
            {"Offset": 0.4},
            {"RoughnessU": 0.4, "RoughnessV": 0.5},
            {"Tangent": "across", "RoughnessU": 0.5, "RoughnessV": 0.8},
        ):
            inputs = {"Color": (0.8, 0.5, 0.3, 1), **more}
            found.append(Case("ShaderNodeBsdfHair", {"component": component}, inputs))
    node = "ShaderNodeBsdfHairPrincipled"
    color = {"Color": (0.5, 0.2, 0.08, 1)}
    for more in (
        {},
        {"Roughness": 0.1, "Radial Roughness": 0.2},
        {"Roughness": 0.8, "Radial Roughness": 0.9},
        {"Coat": 0.7},
        {"IOR": 1.2},
        {"Offset": 0.3},
        {"Random Color": 0.8},
        {"Random Roughness": 0.9, "Random": 0.3},
    ):
        found.append(Case(node, {"parametrization": "COLOR"}, {**color, **more}))
    for more in (
        {"Melanin": 0.3, "Melanin Redness": 0.5},
        {"Melanin": 0.6, "Melanin Redness": 0.0, "Tint": (1, 0.5, 0.4, 1)},
    ):
        found.append(Case(node, {"parametrization": "MELANIN"}, more))
    absorbed = {"Absorption Coefficient": (0.1, 0.5, 2.0)}
    found.append(Case(node, {"parametrization": "ABSORPTION"}, absorbed))
    if bpy.app.version >= (4, 0, 0):
        found += _hair_of_facets(node, {"parametrization": "COLOR", "model": "HUANG"}, color)
    names = ("Is Strand", "Intercept", "Length", "Thickness", "Tangent Normal", "Random")
    return found + [Case("ShaderNodeHairInfo", output=name) for name in names]


def _hair_of_facets(node, settings, color):
    """Huang's model: round, and of strands that have no normal of their own, elliptical."""
    found = [
        Case(node, settings, {**color, "Aspect Ratio": 1.0, **more})
        for more in (
            {},
            {"Roughness": 0.1},
            {"Roughness": 0.8},
            {"IOR": 1.2},
            {"Offset": 0.3},
            {"Random Roughness": 0.9, "Random": 0.3},
            {"R lobe": 0.0},
            {"TT lobe": 0.0},
            {"TRT lobe": 0.0},
            {"Color": (0.95, 0.9, 0.8, 1)},
        )
    ]
    found += [Case(node, settings, {**color, "Aspect Ratio": ratio}) for ratio in (0.85, 0.5, 2.0)]
    melanin = {"Aspect Ratio": 1.0, "Melanin": 0.3, "Melanin Redness": 0.5}
    return [*found, Case(node, {**settings, "parametrization": "MELANIN"}, melanin)]


def _distributions(node):
    """Of a node, in this Blender; none where it has no such node."""
    kind = getattr(bpy.types, node, None)
    return [] if kind is None else [item.identifier for item in kind.bl_rna.properties["distribution"].enum_items]


def _dielectrics():
    found = []
    for node in ("ShaderNodeBsdfGlass", "ShaderNodeBsdfRefraction"):
        for distribution in _distributions(node):
            for more in ({"Roughness": 0.4}, {"Roughness": 0.2, "IOR": 1.15}, {"Roughness": 0.5, "Normal": "leaning"}):
                inputs = {"Color": (0.8, 0.5, 0.3, 1), **more}
                found.append(Case(node, {"distribution": distribution}, inputs))
    return found


def _glossy():
    found = []
    for node in ("ShaderNodeBsdfGlossy", "ShaderNodeBsdfAnisotropic"):
        for distribution in _distributions(node):
            for more in ({"Roughness": 0.4}, {"Roughness": 0.7}):
                inputs = {"Color": (0.8, 0.5, 0.3, 1), **more}
                found.append(Case(node, {"distribution": distribution}, inputs))
    return found


def _principled():
    """What sees through it or shines; layers above a body."""
    color = {"Base Color": (0.8, 0.5, 0.3, 1), "Roughness": 0.5}
    through, shine = (
        ("Transmission", "Emission") if bpy.app.version < (4, 0, 0) else ("Transmission Weight", "Emission Color")
    )
    varied = [
        {"Alpha": 0.4},
        {through: 1.0},
        {through: 0.7, "IOR": 1.8},
        {shine: (0.2, 0.4, 0.9, 1), "Emission Strength": 0.8},
    ]
    if bpy.app.version < (4, 0, 0):
        varied += [
            {through: 1.0, "Transmission Roughness": 0.6},
            {"Clearcoat": 1.0, "Clearcoat Roughness": 0.4},
            {"Clearcoat": 1.0, "Clearcoat Roughness": 0.4, "Clearcoat Normal": "leaning"},
            {"Specular Tint": 0.9, "Specular": 1.0},
        ]
    if bpy.app.version >= (5, 2, 0):
        sheet = {through: 1.0, "Thin Wall": True}
        varied += [sheet, {**sheet, "Roughness": 0.2, "IOR": 2.0}, {**sheet, through: 0.5, "Roughness": 0.0}]
        varied.append({"Thin Wall": True, "Subsurface Weight": 0.8, "Subsurface Anisotropy": 0.5})
    node = "ShaderNodeBsdfPrincipled"
    return [Case(node, {"distribution": name}, {**color, **more}) for more in varied for name in _distributions(node)]


def shader_cases():
    """All that no other comparison has."""
    color = {"Color": (0.8, 0.5, 0.3, 1)}
    found = [Case("ShaderNodeBsdfTranslucent", {}, {**color, **more}) for more in ({}, {"Normal": "leaning"})]
    for kind, inputs in (
        ("Diffuse", {}),
        ("Diffuse", {"Roughness": 0.7}),
        ("Toon", {}),
        ("Glossy", {}),
        ("Velvet", {}),
    ):
        found.append(Case(f"ShaderNodeBsdf{kind}", {}, {**color, **inputs, "Normal": "leaning"}))
    found += [Case("ShaderNodeBsdfTransparent", {}, color), Case("ShaderNodeHoldout")]
    found.append(Case("ShaderNodeEmission", {}, {**color, "Strength": 0.7}))
    every = found + _dielectrics() + _glossy() + _principled()
    return [case for case in every if hasattr(bpy.types, case.node)]
