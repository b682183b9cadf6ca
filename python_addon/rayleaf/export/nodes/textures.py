"""Textures that look up pictures."""

from .compiler import NodeView, value_node
from .emitter import UNCONNECTED, Register

_EXTENSIONS = {"REPEAT": 0, "EXTEND": 1, "CLIP": 2, "MIRROR": 3}
_INTERPOLATIONS = {"Linear": 0, "Closest": 1, "Cubic": 2, "Smart": 2}
_PROJECTIONS = {"EQUIRECTANGULAR": 0, "MIRROR_BALL": 1}
# What stands for an image that cannot be read.
_PINK = (1.0, 0.0, 1.0, 1.0)


def name_hidden_mapping(view: NodeView) -> None:
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
    name_hidden_mapping(view)
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
    name_hidden_mapping(view)
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
