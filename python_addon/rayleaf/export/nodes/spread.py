"""Shader nodes of light that goes through what it meets: hair, and bodies below their surface."""

from ... import cycles_versions
from ..attributes import STRAND_INFO, STRAND_NORMAL, STRAND_RANDOM
from .closures import may_be_other_than
from .compiler import NodeView, closure_node
from .emitter import UNCONNECTED, Register

# The core's methods of subsurface scattering, by Blender's names.
_FIXED_RADIUS, _PHYSICAL, _MEAN_FREE_PATH, _PROFILE = range(4)
_METHODS = {
    "RANDOM_WALK_FIXED_RADIUS": _FIXED_RADIUS,
    "RANDOM_WALK": _PHYSICAL,
    "RANDOM_WALK_SKIN": _PHYSICAL,
    "RANDOM_WALK_LEGACY": _FIXED_RADIUS,  # 5.2's name
    "BURLEY": _PROFILE,  # Christensen's and Burley's
}


def method_of(view: NodeView, identifier: str) -> int:
    """The core's method."""
    if identifier == "RANDOM_WALK" and cycles_versions.random_walk_has_mean_free_path():
        return _MEAN_FREE_PATH
    # Since 4.0 "Random Walk" is the one of fixed radius, and the other is called "Skin".
    if identifier == "RANDOM_WALK" and "RANDOM_WALK_SKIN" in {
        item.identifier for item in view.node.bl_rna.properties[_method_property(view)].enum_items
    }:
        return _FIXED_RADIUS
    return _METHODS[identifier]


def _method_property(view: NodeView) -> str:
    return "falloff" if hasattr(view.node, "falloff") else "subsurface_method"


@closure_node("ShaderNodeSubsurfaceScattering")
def subsurface(view: NodeView, weight: Register) -> None:
    """Subsurface Scattering."""
    operands = [weight, view.input("Color"), view.input("Scale"), view.input("Radius")]
    operands += [view.input("IOR", default=1.4), view.input("Anisotropy", "Subsurface Anisotropy")]
    operands.append(view.normal("Normal"))
    roughness = view.socket("Roughness")  # 4.2: light enters refracted
    if roughness is not None and view.node.falloff != "BURLEY":
        ints, more = [method_of(view, view.node.falloff), 1], [view.input("Roughness")]
    else:
        ints, more = [method_of(view, view.node.falloff), 0], []
    ints.append(int(cycles_versions.bodies_scatter_after_diffuse_bounces()))
    view.emitter.operation("subsurface", [*operands, *more], ints)


@closure_node("ShaderNodeBsdfHair")
def hair(view: NodeView, weight: Register) -> None:
    """Hair BSDF."""
    operands = [weight, view.input("Color"), view.input("Offset"), view.input("RoughnessU"), view.input("RoughnessV")]
    operation, kinds = view.emitter.operation, {"Reflection": "REFLECTION", "Transmission": "TRANSMISSION"}
    operation("hair", [*operands, view.linked("Tangent")], text=kinds[view.node.component])


@closure_node("ShaderNodeBsdfHairPrincipled")
def principled_hair(view: NodeView, weight: Register) -> None:
    """Principled Hair BSDF, of Chiang's model or, since Blender 4.0, of Huang's."""
    emitter, coloring = view.emitter, view.node.parametrization
    color = view.input("Absorption Coefficient" if coloring == "ABSORPTION" else "Color", default=0.0)
    random = view.linked("Random")
    if random == UNCONNECTED:  # the strand's own, where there is one
        is_strand, own = (
            emitter.operation("attribute", ints=[view.resources.attribute(name)])
            for name in (STRAND_INFO["IS_STRAND"], STRAND_RANDOM)
        )
        random = emitter.operation("mix", [is_strand, view.input("Random"), own], [1, 0], text="MIX")
    absorbs = [weight, color, view.input("Melanin"), view.input("Melanin Redness"), view.input("Tint", default=1.0)]
    refracts = [view.input("IOR", default=1.55), view.input("Offset")]
    varies = [random, view.input("Random Color"), view.input("Random Roughness")]
    if getattr(view.node, "model", "CHIANG") == "CHIANG":
        rough = [view.input("Roughness"), view.input("Radial Roughness"), view.input("Coat")]
        emitter.operation("hair_fibre", [*absorbs, *rough, *refracts, *varies], text=coloring)
        return
    ratio = view.input("Aspect Ratio", default=1.0)
    factors = [view.input(name, default=1.0) for name in ("Reflection", "Transmission", "Secondary Reflection")]
    axis = UNCONNECTED
    if may_be_other_than(view, ratio, 1.0):
        axis = emitter.operation("attribute", ints=[view.resources.attribute(STRAND_NORMAL)])
    thickness = emitter.operation("attribute", ints=[view.resources.attribute(STRAND_INFO["THICKNESS"])])
    operands = [*absorbs, view.input("Roughness"), *refracts, *varies, ratio, *factors, axis, thickness]
    emitter.operation("hair_facets", operands, text=coloring)
