"""Shader nodes: what they add to a point's closures, with a weight."""

from ...versions import PRINCIPLED_SOCKETS
from .compiler import NodeView, closure_node
from .emitter import UNCONNECTED, Register
from .spread import method_of

# Inputs of Blender 4 that are not supported, by the value that changes nothing.
PRINCIPLED_NEUTRAL = {
    "Sheen Roughness": 0.5,
    "Diffuse Roughness": 0.0,
    "Thin Film Thickness": 0.0,
    "Coat IOR": 1.5,
    "Coat Tint": 1.0,
}
# Blender 4's coat of 1 is a whole lacquer, a clearcoat of 1 a quarter of it.
_COAT_SCALE = 4.0
_NEAR = 1e-5  # single precision's share in a value that a person typed
# Blender 4 sets the reflectance by the index of refraction; before, "Specular" of 1 meant this reflectance.
_SPECULAR_SCALE = 0.08


@closure_node("ShaderNodeBsdfDiffuse")
def diffuse(view: NodeView, weight: Register) -> None:
    """Diffuse BSDF."""
    operands = [weight, view.input("Color"), view.input("Roughness"), view.normal("Normal")]
    view.emitter.operation("diffuse", operands)


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
        if _may_be_other_than(view, anisotropy, 0.0):
            operands += [anisotropy, view.input("Rotation"), _tangent(view)]
    view.emitter.operation("glossy", operands, text=view.node.distribution)


def _may_be_other_than(view: NodeView, register: Register, value: float) -> bool:
    known = view.emitter.value_of(register)
    return known is None or known[0] != value


def _tangent(view: NodeView) -> Register:
    """What is linked, else Blender's own: around the object's z axis."""
    tangent = view.linked("Tangent")
    return view.emitter.operation("radial_tangent", ints=[2]) if tangent == UNCONNECTED else tangent


@closure_node("ShaderNodeBsdfVelvet")
def velvet(view: NodeView, weight: Register) -> None:
    """Velvet BSDF."""
    operands = [weight, view.input("Color"), view.input("Sigma"), view.normal("Normal")]
    view.emitter.operation("velvet", operands)


@closure_node("ShaderNodeBsdfToon")
def toon(view: NodeView, weight: Register) -> None:
    """Toon BSDF."""
    operands = [weight, view.input("Color"), view.input("Size"), view.input("Smooth"), view.normal("Normal")]
    view.emitter.operation("toon", operands, text=view.node.component)


@closure_node("ShaderNodeBsdfGlass")
def glass(view: NodeView, weight: Register) -> None:
    """Glass BSDF."""
    _dielectric(view, weight, "glass")


@closure_node("ShaderNodeBsdfRefraction")
def refraction(view: NodeView, weight: Register) -> None:
    """Refraction BSDF."""
    _dielectric(view, weight, "refraction")


def _dielectric(view: NodeView, weight: Register, operation: str) -> None:
    operands = [weight, view.input("Color"), view.input("Roughness"), view.input("IOR"), view.normal("Normal")]
    view.emitter.operation(operation, operands, text=view.node.distribution)


@closure_node("ShaderNodeBsdfTransparent")
def transparent(view: NodeView, weight: Register) -> None:
    """Transparent BSDF."""
    view.emitter.operation("transparent", [weight, view.input("Color")])


@closure_node("ShaderNodeEmission", "ShaderNodeBackground")
def emission(view: NodeView, weight: Register) -> None:
    """Emission and Background; the world shines by either."""
    operation = "background" if view.compiler.is_world else "emission"
    view.emitter.operation(operation, [weight, view.input("Color"), view.input("Strength")])


@closure_node("ShaderNodeHoldout")
def holdout(view: NodeView, weight: Register) -> None:
    """Holdout."""
    view.emitter.operation("holdout", [weight])


def _named(view: NodeView, name: str, default: float = 0.0) -> Register:
    return view.input(*PRINCIPLED_SOCKETS[name], default=default)


def _specular(view: NodeView) -> Register:
    """The reflectance at normal incidence over 0.08. Blender 4: that of the index of refraction times twice the level."""
    emitter = view.emitter
    if view.socket("Specular IOR Level") is None:
        return view.input("Specular")
    level, ior = view.input("Specular IOR Level"), view.input("IOR")
    known_level, known_ior = emitter.value_of(level), emitter.value_of(ior)
    if known_level is not None and known_ior is not None:
        reflectance = ((known_ior[0] - 1.0) / (known_ior[0] + 1.0)) ** 2
        return emitter.scalar(reflectance * 2.0 * known_level[0] / _SPECULAR_SCALE)
    one = emitter.scalar(1.0)
    ratio = emitter.math("DIVIDE", emitter.math("SUBTRACT", ior, one), emitter.math("ADD", ior, one))
    factor = emitter.math("MULTIPLY", level, emitter.scalar(2.0 / _SPECULAR_SCALE))
    return emitter.math("MULTIPLY", emitter.math("MULTIPLY", ratio, ratio), factor)


def _tint(view: NodeView, name: str) -> Register:
    """A tint by the base colour, 0..1. Since Blender 4 tints are colours of their own: white is none."""
    socket = view.socket(name)
    if socket is None or socket.type != "RGBA":
        return view.input(name)
    known = view.emitter.value_of(view.input(name))
    if known is not None and min(known[:3]) >= 1.0:
        return view.emitter.scalar(0.0)
    view.warn(f"a coloured {name} is not supported; taken as a tint by the base colour")
    return view.emitter.scalar(1.0)


def _coat(view: NodeView) -> Register:
    """The clearcoat; Blender 4's coat as one."""
    emitter, weight = view.emitter, _named(view, "clearcoat")
    if view.socket("Coat Weight") is None:
        return weight
    return emitter.multiply(weight, emitter.scalar(_COAT_SCALE))


def _warn_of_unsupported(view: NodeView) -> None:
    for name, neutral in PRINCIPLED_NEUTRAL.items():
        if view.socket(name) is None:
            continue
        known = view.emitter.value_of(view.input(name))
        if known is None or any(abs(channel - neutral) > _NEAR for channel in known[:3]):
            view.warn(f"{name} is not supported; rendered without")


def _subsurface(view: NodeView) -> tuple[list[Register], list[int]]:
    """The operands of subsurface scattering, and its method; none where there is none."""
    emitter, share = view.emitter, _named(view, "subsurface")
    if not _may_be_other_than(view, share, 0.0):
        return [], []
    radius = view.input("Subsurface Radius")
    if view.socket("Subsurface Scale") is not None:
        # Since 4.0 the share is one, and the radius has a scale of its own.
        view.warn("the part of light that is scattered below the surface is taken as of Blender 3")
        scaled = emitter.operation("vector_math", [radius, view.input("Subsurface Scale")], text="MULTIPLY")
        radius = emitter.operation("vector_math", [scaled, share], text="DIVIDE")
    color = view.input("Subsurface Color") if view.socket("Subsurface Color") is not None else view.input("Base Color")
    operands = [share, color, radius, view.input("Subsurface IOR", default=1.4), view.input("Subsurface Anisotropy")]
    return operands, [method_of(view, view.node.subsurface_method)]


@closure_node("ShaderNodeBsdfPrincipled")
def principled(view: NodeView, weight: Register) -> None:
    """Principled BSDF, with the sockets of 3.4 and of 4.x."""
    _warn_of_unsupported(view)
    anisotropic = view.input("Anisotropic")
    tangent = _tangent(view) if _may_be_other_than(view, anisotropic, 0.0) else UNCONNECTED
    subsurface, method = _subsurface(view)
    view.emitter.operation(
        "principled",
        [
            weight,
            view.input("Base Color"),
            view.input("Metallic"),
            _specular(view),
            _tint(view, "Specular Tint"),
            view.input("Roughness"),
            anisotropic,
            view.input("Anisotropic Rotation"),
            _named(view, "sheen"),
            _tint(view, "Sheen Tint"),
            _coat(view),
            _named(view, "clearcoat_roughness"),
            view.input("IOR", default=1.45),
            _named(view, "transmission"),
            view.input("Transmission Roughness"),
            _named(view, "emission_color"),
            view.input("Emission Strength", default=1.0),
            view.input("Alpha", default=1.0),
            view.normal("Normal"),
            view.normal(*PRINCIPLED_SOCKETS["clearcoat_normal"]),
            tangent,
            *subsurface,
        ],
        method,
        text=getattr(view.node, "distribution", ""),
    )
