"""The nodes that test_surface_oracle.py compares with Cycles on real surfaces: those that ask where the ray hit."""

from itertools import permutations

import bpy

from oracle_case import Case


def _coordinates() -> list[Case]:
    names = "Generated Normal UV Object Camera Window Reflection".split()
    found = [Case("ShaderNodeTexCoord", output=name) for name in names]
    # What nothing makes; instances are compared by test_instancer_oracle.py.
    found += [Case("ShaderNodeTexCoord", {"from_instancer": True}, output=name) for name in ("Generated", "UV")]
    found.append(Case("ShaderNodeUVMap", {"from_instancer": True}))
    names = "Position Normal Tangent Incoming Parametric Backfacing".split()
    names += ["True Normal", "Pointiness", "Random Per Island"]
    found += [Case("ShaderNodeNewGeometry", output=name) for name in names]
    found += [Case("ShaderNodeTangent", {"direction_type": "RADIAL", "axis": axis}) for axis in "XYZ"]
    found += [Case("ShaderNodeTangent", {"direction_type": "UV_MAP", "uv_map": name}) for name in ("", "Other")]
    for kind in ("POINT", "VECTOR", "NORMAL"):
        for start, end in permutations(("WORLD", "OBJECT", "CAMERA"), 2):
            settings = {"vector_type": kind, "convert_from": start, "convert_to": end}
            found.append(Case("ShaderNodeVectorTransform", settings, {"Vector": "object"}))
    for name in ("Location", "Color", "Alpha", "Object Index", "Material Index", "Random"):
        found.append(Case("ShaderNodeObjectInfo", output=name))
    for name, output in (("weight", "Fac"), ("tint", "Color"), ("missing", "Color"), ("location", "Vector")):
        settings = {"attribute_type": "OBJECT", "attribute_name": name}
        found.append(Case("ShaderNodeAttribute", settings, output=output))
    for name in ("Color", "Vector", "Fac", "Alpha"):
        found.append(Case("ShaderNodeAttribute", {"attribute_name": "Paint"}, output=name))
        found.append(Case("ShaderNodeAttribute", {"attribute_name": "Wear"}, output=name))
    found.append(Case("ShaderNodeAttribute", {"attribute_name": "missing"}, output="Alpha"))
    found.append(Case("ShaderNodeAttribute", {"attribute_type": "OBJECT", "attribute_name": "tint"}, output="Alpha"))
    for layer in ("", "Paint", "Other paint"):
        found += [Case("ShaderNodeVertexColor", {"layer_name": layer}, output=name) for name in ("Color", "Alpha")]
    found += [Case("ShaderNodeUVMap", {"uv_map": name}) for name in ("", "Other", "missing")]
    found += [Case("ShaderNodeCameraData", output=f"View {name}") for name in ("Vector", "Z Depth", "Distance")]
    names = ("Index", "Random", "Age", "Lifetime", "Location", "Size", "Velocity", "Angular Velocity")
    found += [Case("ShaderNodeParticleInfo", output=name) for name in names]
    found.append(Case("ShaderNodeWireframe", {}, {"Size": 0.05}))
    found.append(Case("ShaderNodeWireframe", {"use_pixel_size": True}, {"Size": 1.5}))
    for output in ("Quadratic", "Linear", "Constant"):
        found.append(Case("ShaderNodeLightFalloff", {}, {"Strength": "height", "Smooth": 0.7}, output))
    return found + [Case("ShaderNodePointInfo", output=name) for name in ("Position", "Radius", "Random")]


def _bumps() -> list[Case]:
    found = []
    for strength, distance, invert in ((1.0, 0.3, False), (0.4, 0.3, False), (2.0, 0.2, True), (1.0, -0.3, False)):
        inputs = {"Height": "height", "Strength": strength, "Distance": distance}
        found.append(Case("ShaderNodeBump", {"invert": invert}, inputs))
    found.append(Case("ShaderNodeBump", {}, {"Height": "height", "Distance": 0.2, "Normal": "bumped"}))
    found.append(Case("ShaderNodeBump", {}, {"Height": 0.7}))
    for name in ("Diffuse", "Glossy", "Velvet", "Sheen", "Toon", "Principled"):
        found.append(Case(f"ShaderNodeBsdf{name}", {}, {"Normal": "bumped"}))
    # Wide highlights: narrow ones show how the two bumps differ.
    inputs = {"Roughness": 0.8, "Anisotropy": 0.3, "Rotation": 0.25, "Normal": "bumped"}
    found.append(Case("ShaderNodeBsdfAnisotropic", {"distribution": "GGX"}, inputs))
    found += [
        Case("ShaderNodeFresnel", {}, {"Normal": "bumped"}),
        *(Case("ShaderNodeLayerWeight", {}, {"Normal": "bumped"}, output) for output in ("Fresnel", "Facing")),
        *(Case("ShaderNodeLayerWeight", {}, {"Blend": 0.3}, output) for output in ("Fresnel", "Facing")),
    ]
    for space in ("TANGENT", "OBJECT", "WORLD", "BLENDER_OBJECT", "BLENDER_WORLD"):
        inputs = {"Color": (0.3, 0.6, 0.9, 1), "Strength": 0.7}
        found.append(Case("ShaderNodeNormalMap", {"space": space}, inputs))
    # Of the length 1.7, and steeper than the surface is smooth.
    for color, strength in (((1, 0, 1, 1), 0.5), ((0.2, 0.6, 0.8, 1), 2.5), ((0.6, 0.45, 0.9, 1), -1.0)):
        found.append(Case("ShaderNodeNormalMap", {"space": "TANGENT"}, {"Color": color, "Strength": strength}))
    if "convention" in bpy.types.ShaderNodeNormalMap.bl_rna.properties:  # 5.1
        for space in ("TANGENT", "OBJECT", "WORLD", "BLENDER_OBJECT", "BLENDER_WORLD"):
            inputs = {"Color": (0.3, 0.6, 0.9, 1), "Strength": 0.7}
            found.append(Case("ShaderNodeNormalMap", {"space": space, "convention": "DIRECTX"}, inputs))
    return found


def _displacements() -> list[Case]:
    """Of materials that bend normals by what would displace."""
    found = []
    for space in ("OBJECT", "WORLD"):
        for inputs in ({"Height": "height", "Scale": 0.3}, {"Height": "height", "Midlevel": 0.2, "Scale": -0.2}):
            found.append(Case("ShaderNodeDisplacement", {"space": space}, inputs))
        bent = {"Height": "height", "Scale": 0.3, "Normal": "bumped"}
        found.append(Case("ShaderNodeDisplacement", {"space": space}, bent))
    for space in ("OBJECT", "WORLD", "TANGENT"):
        inputs = {"Vector": "object", "Scale": 0.2}
        found.append(Case("ShaderNodeVectorDisplacement", {"space": space}, inputs))
        found.append(Case("ShaderNodeVectorDisplacement", {"space": space}, {**inputs, "Midlevel": 0.3}))
    return found


def _images() -> list[Case]:
    found = []
    for source in ("object", "generated"):
        for projection in ("FLAT", "SPHERE", "TUBE"):
            settings = {"image": "Picture", "projection": projection}
            found.append(Case("ShaderNodeTexImage", settings, {"Vector": source}, "Color"))
        for blend in (0.0, 0.3, 1.0):
            settings = {"image": "Picture", "projection": "BOX", "projection_blend": blend}
            found.append(Case("ShaderNodeTexImage", settings, {"Vector": source}, "Color"))
    return found


def _shaders() -> list[Case]:
    color = {"Color": (0.8, 0.5, 0.3, 1)}
    found = [Case("ShaderNodeBsdfDiffuse", {}, {**color, "Roughness": rough}) for rough in (0.0, 0.7)]
    found += [Case("ShaderNodeBsdfVelvet", {}, {**color, "Sigma": sigma}) for sigma in (0.3, 0.9)]
    for distribution, roughness in (("ASHIKHMIN", 0.4), ("MICROFIBER", 0.2), ("MICROFIBER", 0.5), ("MICROFIBER", 1.0)):
        found.append(Case("ShaderNodeBsdfSheen", {"distribution": distribution}, {**color, "Roughness": roughness}))
    for component in ("DIFFUSE", "GLOSSY"):
        for size, smooth in ((0.5, 0.0), (0.3, 0.4), (1.0, 0.5), (0.6, 0.6)):
            inputs = {**color, "Size": size, "Smooth": smooth}
            found.append(Case("ShaderNodeBsdfToon", {"component": component}, inputs))
    for distribution in ("BECKMANN", "GGX"):
        for anisotropy, rotation, tangent in (
            (0.7, 0.0, None),
            (-0.5, 0.15, None),
            (0.6, 0.1, "radial"),
            (0.0, 0.3, None),
        ):
            inputs = {**color, "Roughness": 0.5, "Anisotropy": anisotropy, "Rotation": rotation}
            inputs |= {"Tangent": tangent} if tangent else {}
            found.append(Case("ShaderNodeBsdfAnisotropic", {"distribution": distribution}, inputs))
    for anisotropic, rotation, tangent in ((0.8, 0.0, None), (0.6, 0.2, None), (0.9, 0.1, "radial")):
        inputs = {"Metallic": 1.0, "Roughness": 0.5, "Anisotropic": anisotropic, "Anisotropic Rotation": rotation}
        inputs |= {"Tangent": tangent} if tangent else {}
        found.append(Case("ShaderNodeBsdfPrincipled", {"distribution": "GGX"}, inputs))
    # Brighter than white, as nodes may make it: a metal reflects no more than all.
    for more in ({"Metallic": 1.0}, {"Metallic": 0.6}):
        inputs = {**more, "Roughness": 0.7, "Base Color": (0.4, 2.0, 0.1, 1)}
        found.append(Case("ShaderNodeBsdfPrincipled", {"distribution": "GGX"}, inputs))
    return found


def _principled_up_to_3() -> list[Case]:
    inputs = {"Sheen": 1.0, "Sheen Tint": 0.7, "Base Color": (0.8, 0.5, 0.3, 1), "Specular": 0.0}
    return [Case("ShaderNodeBsdfPrincipled", {}, inputs)]


def _principled_since_4() -> list[Case]:
    """Each layer alone, and over what it takes light from. None shines: it would light the others, by chance."""
    tint, full = (0.4, 0.7, 0.9, 1), {"Coat Weight": 1.0, "Coat Roughness": 0.4}
    sheen = {"Sheen Weight": 1.0, "Sheen Roughness": 0.4}
    varied = [
        {},
        {"IOR": 2.2, "Specular Tint": tint},
        {"Specular IOR Level": 1.0},
        {"Specular IOR Level": 0.0},
        {"IOR": 0.7},
        {"Metallic": 1.0},
        {"Metallic": 1.0, "Specular Tint": tint},
        {"Metallic": 0.5, "Roughness": 0.9},
        {"Transmission Weight": 0.6, "Roughness": 0.4},
        {"Transmission Weight": 0.6, "Roughness": 0.4, "Specular Tint": tint},
        full,
        {**full, "Coat IOR": 2.5, "Metallic": 1.0},
        {**full, "Coat Tint": tint, "Specular IOR Level": 0.0},
        {**full, "Coat Weight": 0.5, "Coat Tint": tint, "Coat Roughness": 0.6},
        {**full, "Coat Normal": "bumped"},
        sheen,
        {**sheen, "Sheen Roughness": 0.8, "Sheen Tint": tint, "Sheen Weight": 0.7},
        {**sheen, **full, "Coat Normal": "bumped"},
    ]
    color = {"Base Color": (0.8, 0.5, 0.3, 1), "Roughness": 0.5}
    node = "ShaderNodeBsdfPrincipled"
    cases = [Case(node, {"distribution": name}, {**color, **more}) for more in varied for name in ("GGX", "MULTI_GGX")]
    if bpy.app.version >= (4, 3, 0):
        cases.append(Case(node, {}, {**color, "Diffuse Roughness": 0.8, "Specular IOR Level": 0.0}))
    return cases


def _films() -> list[Case]:
    """In thin films, over what each version can have below them: rough, so that the sun is seen in many directions."""
    color, rough, tint = (0.8, 0.5, 0.3, 1), {"Roughness": 0.5}, (0.4, 0.7, 0.9, 1)
    films = [(200.0, 1.33), (350.0, 1.8), (500.0, 1.33), (800.0, 2.2)]
    found = []
    for thickness, index in films:
        film = {**rough, "Thin Film Thickness": thickness, "Thin Film IOR": index}
        dielectrics = [{}, {"IOR": 2.2}, {"IOR": 0.8}, {"Specular IOR Level": 1.0}, {"Specular Tint": tint}]
        dielectrics += [{"Transmission Weight": 0.6, "Roughness": 0.4}]
        dielectrics += [{"Metallic": 1.0, "Roughness": 0.6}, {"Metallic": 1.0, "Specular Tint": tint}]
        for more in dielectrics:
            inputs = {"Base Color": color, **film, **more}
            found.append(Case("ShaderNodeBsdfPrincipled", {"distribution": "GGX"}, inputs))
        if bpy.app.version >= (5, 0, 0):
            found.append(Case("ShaderNodeBsdfGlass", {"distribution": "GGX"}, film))
            found += _metals("GGX", film | {"Roughness": 0.6})
    return found


def _metals(distribution: str, inputs: dict[str, float]) -> list[Case]:
    node, settings = "ShaderNodeBsdfMetallic", {"distribution": distribution}
    colors = {"Base Color": (0.8, 0.5, 0.3, 1), "Edge Tint": (0.4, 0.7, 0.9, 1)}
    gold = {"IOR": (0.183, 0.421, 1.373), "Extinction": (3.425, 2.346, 1.770)}
    return [
        Case(node, {**settings, "fresnel_type": "F82"}, {**colors, **inputs}),
        Case(node, {**settings, "fresnel_type": "PHYSICAL_CONDUCTOR"}, {**gold, **inputs}),
    ]


def _since_4_2() -> list[Case]:
    found = _films() if bpy.app.version >= (4, 2, 0) else []
    if bpy.app.version >= (4, 3, 0):
        for distribution in ("GGX", "BECKMANN", "MULTI_GGX"):
            found += _metals(distribution, {"Roughness": 0.6})
        found += _metals("GGX", {"Roughness": 0.5, "Anisotropy": 0.8, "Rotation": 0.1})
        found += _metals("GGX", {"Roughness": 0.8, "Normal": "bumped"})
        found += _metals("GGX", {"Roughness": 0.6, "Anisotropy": 0.5, "Tangent": "radial"})
    return found


def _of_this_version() -> list[Case]:
    principled = _principled_up_to_3 if bpy.app.version < (4, 0, 0) else _principled_since_4
    every = _coordinates() + _bumps() + _displacements() + _images() + _shaders() + principled() + _since_4_2()
    # Nodes come and go: Velvet became a kind of Sheen in 4.0.
    return [case for case in every if hasattr(bpy.types, case.node)]


CASES = _of_this_version()
