"""Texture nodes."""

from .compiler import NodeView, value_node
from .emitter import UNCONNECTED, Register

_EXTENSIONS = {"REPEAT": 0, "EXTEND": 1, "CLIP": 2, "MIRROR": 3}
_INTERPOLATIONS = {"Linear": 0, "Closest": 1, "Cubic": 2, "Smart": 2}
_PROJECTIONS = {"EQUIRECTANGULAR": 0, "MIRROR_BALL": 1}
# What stands for an image that cannot be read.
_PINK = (1.0, 0.0, 1.0, 1.0)


def _name_hidden_mapping(view: NodeView) -> None:
    """Files of old Blenders move textures by settings of the node that no panel shows any more."""
    mapping = view.node.texture_mapping
    moved = (*mapping.translation, *mapping.rotation) != (0.0,) * 6 or tuple(mapping.scale) != (1.0,) * 3
    axes = (mapping.mapping_x, mapping.mapping_y, mapping.mapping_z)
    bounded = mapping.use_min or mapping.use_max
    if moved or bounded or axes != ("X", "Y", "Z") or mapping.mapping != "FLAT":
        view.warn("its hidden texture mapping is not supported; rendered without")


def _texture(view: NodeView) -> int | None:
    """The id of the node's image; None if there is none to read."""
    node = view.node
    if node.image is None:
        return None
    return view.resources.images.texture(node.image, node.image_user, view.resources.frame)


@value_node("ShaderNodeTexImage")
def image(view: NodeView, output: str) -> Register:
    """Image Texture. Without an image it is black, as in Blender; an image that cannot be read is pink."""
    _name_hidden_mapping(view)
    node, emitter = view.node, view.emitter
    if node.image is None:
        return emitter.scalar(0.0) if output == "Alpha" else emitter.constant(0, 0, 0)
    texture = _texture(view)
    if texture is None:
        return emitter.scalar(1.0) if output == "Alpha" else emitter.constant(*_PINK)
    if node.projection != "FLAT":
        view.warn(f"{node.projection.title()} projection is not supported; taken as flat")
    vector = view.linked("Vector")
    if vector == UNCONNECTED:
        vector = emitter.operation("uv", ints=[view.resources.active_uv()])
    ints = [texture, _EXTENSIONS[node.extension], _INTERPOLATIONS.get(node.interpolation, 0)]
    result = emitter.operation("image", [vector], ints)
    if output != "Alpha":
        return result
    return emitter.scalar(1.0) if node.image.alpha_mode == "NONE" else emitter.component(result, 3)


@value_node("ShaderNodeTexEnvironment")
def environment(view: NodeView, output: str) -> Register:
    """Environment Texture."""
    _name_hidden_mapping(view)
    node, emitter = view.node, view.emitter
    if node.image is None:
        return emitter.constant(0, 0, 0)
    texture = _texture(view)
    if texture is None:
        return emitter.constant(*_PINK)
    direction = view.linked("Vector")
    if direction == UNCONNECTED:
        direction = emitter.operation("position")
    ints = [texture, _PROJECTIONS[node.projection], _INTERPOLATIONS.get(node.interpolation, 0)]
    return emitter.operation("environment", [direction], ints)


@value_node("ShaderNodeTexChecker")
def checker(view: NodeView, output: str) -> Register:
    """Checker Texture."""
    _name_hidden_mapping(view)
    operands = [view.vector("Vector"), view.input("Color1"), view.input("Color2"), view.input("Scale")]
    result = view.emitter.operation("checker", operands)
    return view.emitter.component(result, 3) if output == "Fac" else result


@value_node("ShaderNodeTexNoise")
def noise(view: NodeView, output: str) -> Register:
    """Noise Texture."""
    _name_hidden_mapping(view)
    node = view.node
    if getattr(node, "noise_type", "FBM") not in ("FBM", ""):
        view.warn(f"noise of type {node.noise_type.title()} is not supported; taken as fBM")
    if not getattr(node, "normalize", True):
        view.warn("noise that is not normalized is not supported; taken as normalized")
    lacunarity = view.emitter.value_of(view.input("Lacunarity", default=2.0))
    if lacunarity is None or lacunarity[0] != 2.0:
        view.warn("a lacunarity other than 2 is not supported; taken as 2")
    operands = [view.vector("Vector"), view.input("W")]
    operands += [view.input(name) for name in ("Scale", "Detail", "Roughness", "Distortion")]
    result = view.emitter.operation("noise", operands, [int(node.noise_dimensions[0])])
    return view.emitter.component(result, 3) if output == "Fac" else result
