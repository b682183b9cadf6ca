"""The Principled node: Disney's model up to Blender 3.6, one of layers since 4.0. The node's sockets say which it is."""

from ...cycles_versions import bodies_scatter_after_diffuse_bounces, coats_reflect_by_facet, thin_films_are_newer
from .closures import may_be_other_than, tangent_of, tell_of_facets, thin_film
from .compiler import NodeView, closure_node
from .emitter import UNCONNECTED, Emitter, Register
from .spread import method_of


_OF_SUBSURFACE = 4  # operands of the layers' model


@closure_node("ShaderNodeBsdfPrincipled")
def principled(view: NodeView, weight: Register) -> None:
    """Principled BSDF."""
    has_layers = view.socket("Coat Weight") is not None
    operation, operands = ("principled_layers", _of_layers) if has_layers else ("principled", _of_disney)
    scattered, ints = _subsurface(view, has_layers)
    film, wall = thin_film(view), _thin_wall(view)
    always = bool(scattered) and bodies_scatter_after_diffuse_bounces()
    if has_layers:
        ints = [*(ints or [0]), int(not thin_films_are_newer()), int(always), int(coats_reflect_by_facet())]
    if film or wall:
        scattered = scattered or [UNCONNECTED] * _OF_SUBSURFACE
    if wall:
        film = film or [UNCONNECTED] * 2
    registers = [weight, *operands(view), *scattered, *film, *wall]
    view.emitter.operation(operation, registers, ints, text=getattr(view.node, "distribution", ""))


def _anisotropy(view: NodeView) -> tuple[Register, Register]:
    """How strong it is, and along what."""
    strength = view.input("Anisotropic")
    return strength, tangent_of(view) if may_be_other_than(view, strength, 0.0) else UNCONNECTED


def _subsurface(view: NodeView, has_layers: bool) -> tuple[list[Register], list[int]]:
    """The operands of subsurface scattering, and its method; none where there is none."""
    share = view.input("Subsurface Weight" if has_layers else "Subsurface")
    if not may_be_other_than(view, share, 0.0):
        return [], []
    radius = view.input("Subsurface Radius")
    if has_layers:
        scale = view.input("Subsurface Scale")
        own = [view.emitter.operation("vector_math", [radius, scale], text="MULTIPLY")]
    else:
        own = [view.input("Subsurface Color"), radius]
    # The sockets of the index and the anisotropy are hidden where the method has none.
    operands = [share, *own, view.input("Subsurface IOR"), view.input("Subsurface Anisotropy")]
    return operands, [method_of(view, view.node.subsurface_method)]


def _of_disney(view: NodeView) -> list[Register]:
    if may_be_other_than(view, view.input("Transmission"), 0.0):
        tell_of_facets(view)
    anisotropic, tangent = _anisotropy(view)
    return [
        *(view.input(name) for name in ("Base Color", "Metallic", "Specular", "Specular Tint", "Roughness")),
        anisotropic,
        *(view.input(name) for name in ("Anisotropic Rotation", "Sheen", "Sheen Tint")),
        *(view.input(name) for name in ("Clearcoat", "Clearcoat Roughness")),
        *(view.input(name) for name in ("IOR", "Transmission", "Transmission Roughness")),
        *(view.input(name) for name in ("Emission", "Emission Strength", "Alpha")),
        view.normal("Normal"),
        view.normal("Clearcoat Normal"),
        tangent,
    ]


def _thin_wall(view: NodeView) -> list[Register]:
    """Whether the surface stands for a thin sheet, since 5.2; nothing where it does not."""
    if view.socket("Thin Wall") is None:
        return []
    wall = view.input("Thin Wall")
    return [wall] if may_be_other_than(view, wall, 0.0) else []


def _name_dispersion(view: NodeView) -> None:
    """Since 5.3 glass may refract each colour another way."""
    name = "Transmission Dispersion Scale"
    if view.socket(name) is not None and may_be_other_than(view, view.input(name), 0.0):
        view.warn("dispersion is not supported; all colours are refracted alike")


def _of_layers(view: NodeView) -> list[Register]:
    _name_dispersion(view)
    anisotropic, tangent = _anisotropy(view)
    return [
        *(view.input(name) for name in ("Base Color", "Metallic", "Specular IOR Level", "Specular Tint", "Roughness")),
        anisotropic,
        view.input("Anisotropic Rotation"),
        *(view.input(f"Sheen {name}") for name in ("Weight", "Roughness", "Tint")),
        *(view.input(f"Coat {name}") for name in ("Weight", "Roughness", "IOR", "Tint")),
        *(view.input(name) for name in ("Emission Color", "Emission Strength", "Alpha", "IOR", "Transmission Weight")),
        view.normal("Normal"),
        view.normal("Coat Normal"),
        tangent,
        view.input("Diffuse Roughness"),  # since 4.3
    ]


def write_default_surface(emitter: Emitter) -> None:
    """What objects without a material look like since Blender 5.0: a node with all its defaults."""
    zero, half, one = emitter.scalar(0.0), emitter.scalar(0.5), emitter.scalar(1.0)
    grey, white, ior = emitter.constant(0.8, 0.8, 0.8), emitter.constant(1.0, 1.0, 1.0), emitter.scalar(1.5)
    body, sheen, coat = [grey, zero, half, white, half, zero, zero], [zero, half, white], [zero, zero, ior, white]
    rest = [white, zero, one, ior, zero, UNCONNECTED, UNCONNECTED, UNCONNECTED, zero]
    emitter.operation("principled_layers", [one, *body, *sheen, *coat, *rest], text="MULTI_GGX")
