"""Shader nodes: what they add to a point's closures, with a weight."""

from ...cycles_versions import (
    facets_hide_jointly,
    follows_light_between_facets,
    glass_reflects_by_facet,
    rough_diffuse_keeps_energy,
    toon_ends_at_right_angles,
)
from .compiler import NodeView, closure_node
from .emitter import UNCONNECTED, Register


@closure_node("ShaderNodeBsdfDiffuse")
def diffuse(view: NodeView, weight: Register) -> None:
    """Diffuse BSDF."""
    operands = [weight, view.input("Color"), view.input("Roughness"), view.normal("Normal")]
    view.emitter.operation("diffuse", operands, [1] if rough_diffuse_keeps_energy() else [])


@closure_node("ShaderNodeBsdfTranslucent")
def translucent(view: NodeView, weight: Register) -> None:
    """Translucent BSDF."""
    view.emitter.operation("translucent", [weight, view.input("Color"), view.normal("Normal")])


@closure_node("ShaderNodeBsdfGlossy", "ShaderNodeBsdfAnisotropic")
def glossy(view: NodeView, weight: Register) -> None:
    """Glossy BSDF; in Blender 4 it is the anisotropic node."""
    operands = [weight, view.input("Color"), view.input("Roughness"), view.normal("Normal")]
    if view.socket("Anisotropy") is not None:
        anisotropy = view.input("Anisotropy")
        if may_be_other_than(view, anisotropy, 0.0):
            operands += [anisotropy, view.input("Rotation"), tangent_of(view)]
    if view.node.distribution == "ASHIKHMIN_SHIRLEY":
        view.warn("Ashikhmin-Shirley is rendered as Beckmann")
    view.emitter.operation("glossy", operands, _masking(), text=view.node.distribution)


def _masking() -> list[int]:
    """Of microfacets, as the core's operations take it."""
    return [1] if facets_hide_jointly() else []


def may_be_other_than(view: NodeView, register: Register, value: float) -> bool:
    """False if it is known to be that number."""
    known = view.emitter.value_of(register)
    return known is None or known[0] != value


def tangent_of(view: NodeView) -> Register:
    """What is linked, else Blender's own: around the object's z axis."""
    tangent = view.linked("Tangent")
    return view.emitter.operation("radial_tangent", ints=[2]) if tangent == UNCONNECTED else tangent


@closure_node("ShaderNodeBsdfVelvet")
def velvet(view: NodeView, weight: Register) -> None:
    """Velvet BSDF."""
    operands = [weight, view.input("Color"), view.input("Sigma"), view.normal("Normal")]
    view.emitter.operation("velvet", operands)


@closure_node("ShaderNodeBsdfSheen")
def sheen(view: NodeView, weight: Register) -> None:
    """Sheen BSDF, Velvet's successor since 4.0, whose model is one of its two."""
    operands = [weight, view.input("Color"), view.input("Roughness"), view.normal("Normal")]
    fibres = view.node.distribution == "MICROFIBER"
    view.emitter.operation("microfibres" if fibres else "velvet", operands)


@closure_node("ShaderNodeBsdfToon")
def toon(view: NodeView, weight: Register) -> None:
    """Toon BSDF."""
    operands = [weight, view.input("Color"), view.input("Size"), view.input("Smooth"), view.normal("Normal")]
    view.emitter.operation("toon", operands, [1] if toon_ends_at_right_angles() else [], text=view.node.component)


@closure_node("ShaderNodeBsdfGlass")
def glass(view: NodeView, weight: Register) -> None:
    """Glass BSDF."""
    multiple = view.node.distribution == "MULTI_GGX"  # has always been by facet
    at_normal = not (multiple or glass_reflects_by_facet())
    _dielectric(view, weight, "glass", [int(facets_hide_jointly()), 1] if at_normal else _masking())


@closure_node("ShaderNodeBsdfRefraction")
def refraction(view: NodeView, weight: Register) -> None:
    """Refraction BSDF."""
    _dielectric(view, weight, "refraction", _masking())


def thin_film(view: NodeView) -> list[Register]:
    """Thickness and index of a film, of Principled since 4.2 and others since 5.0; nothing where there is none."""
    if view.socket("Thin Film Thickness") is None:
        return []
    thickness = view.input("Thin Film Thickness")
    return [thickness, view.input("Thin Film IOR")] if may_be_other_than(view, thickness, 0.0) else []


def tell_of_facets(view: NodeView) -> None:
    """Of glass, whose light Cycles may follow from facet to facet."""
    if view.node.distribution == "MULTI_GGX" and follows_light_between_facets():
        view.warn("Multiscatter GGX: what one facet scatters is scaled; rough glass looks other than in Cycles")


def _dielectric(view: NodeView, weight: Register, operation: str, ints: list[int]) -> None:
    tell_of_facets(view)
    if view.socket("Anisotropy") is not None and may_be_other_than(view, view.input("Anisotropy"), 0.0):  # 5.3
        view.warn("Anisotropy is not supported; as rough all around")
    operands = [weight, view.input("Color"), view.input("Roughness"), view.input("IOR"), view.normal("Normal")]
    view.emitter.operation(operation, operands + thin_film(view), ints, text=view.node.distribution)


@closure_node("ShaderNodeBsdfMetallic")
def metallic(view: NodeView, weight: Register) -> None:
    """Metallic BSDF, of Blender 4.3."""
    conducts = view.node.fresnel_type == "PHYSICAL_CONDUCTOR"
    names = ("IOR", "Extinction") if conducts else ("Base Color", "Edge Tint")
    operands = [weight, *(view.input(name) for name in names), view.input("Roughness"), view.normal("Normal")]
    anisotropy, film = view.input("Anisotropy"), thin_film(view)
    is_anisotropic = may_be_other_than(view, anisotropy, 0.0)
    if is_anisotropic or film:
        operands += [anisotropy, view.input("Rotation"), tangent_of(view) if is_anisotropic else UNCONNECTED]
    view.emitter.operation("metal", operands + film, [int(conducts)], text=view.node.distribution)


@closure_node("ShaderNodeBsdfTransparent")
def transparent(view: NodeView, weight: Register) -> None:
    """Transparent BSDF."""
    view.emitter.operation("transparent", [weight, view.input("Color")])


@closure_node("ShaderNodeBsdfRayPortal")
def ray_portal(view: NodeView, weight: Register) -> None:
    """Ray Portal BSDF, since 4.2: the ray goes on from another place."""
    operands = [weight, view.input("Color"), view.place("Position"), view.input("Direction")]
    view.emitter.operation("ray_portal", operands)


@closure_node("ShaderNodeEmission", "ShaderNodeBackground")
def emission(view: NodeView, weight: Register) -> None:
    """Emission and Background; the world shines by either."""
    operation = "background" if view.compiler.is_world else "emission"
    view.emitter.operation(operation, [weight, view.input("Color"), view.input("Strength")])


@closure_node("ShaderNodeHoldout")
def holdout(view: NodeView, weight: Register) -> None:
    """Holdout."""
    view.emitter.operation("holdout", [weight])
