"""Textures that look up pictures."""

from typing import Any

from .compiler import NodeView, value_node
from .emitter import UNCONNECTED, Register

_EXTENSIONS = {"REPEAT": 0, "EXTEND": 1, "CLIP": 2, "MIRROR": 3}
_INTERPOLATIONS = {"Linear": 0, "Closest": 1, "Cubic": 2, "Smart": 2}
_PLANES = {"FLAT": 0, "SPHERE": 1, "TUBE": 2}
_PROJECTIONS = {"EQUIRECTANGULAR": 0, "MIRROR_BALL": 1}
# Added to an interpolation: colours come multiplied by alpha.
_MULTIPLIED = 4
# What stands for an image that is missing or cannot be read.
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
    if node.image.source == "TILED":
        tiles = view.resources.images.tiles(node.image)
        return tiles[1] if tiles else None
    return view.resources.images.texture(node.image, node.image_user, view.resources.frame)


def _reading(node: Any) -> int:
    """The number of the interpolation. As in Cycles, colours are divided by alpha again only where that is used as well."""
    number = _INTERPOLATIONS.get(node.interpolation, 0)
    uses_alpha = "Alpha" in node.outputs and node.outputs["Alpha"].is_linked
    has_alpha = node.image.alpha_mode in ("STRAIGHT", "PREMUL")
    return number + (_MULTIPLIED if has_alpha and not uses_alpha else 0)


@value_node("ShaderNodeTexImage")
def image(view: NodeView, output: str) -> Register:
    """Image Texture. Without an image that can be read it is pink, as in Blender."""
    name_hidden_mapping(view)
    node, emitter = view.node, view.emitter
    texture = _texture(view)
    if texture is None:
        return emitter.scalar(1.0) if output == "Alpha" else emitter.constant(*_PINK)
    vector = view.linked("Vector")
    if vector == UNCONNECTED:
        vector = emitter.operation("uv", ints=[view.resources.active_uv()])
    ints = [texture, _EXTENSIONS[node.extension], _reading(node)]
    opaque = output == "Alpha" and node.image.alpha_mode == "NONE"
    if opaque:
        return emitter.scalar(1.0)
    if node.projection == "BOX":
        return _box(view, vector, ints, output)
    ints.append(_PLANES[node.projection])
    if node.image.source == "TILED":
        ints += view.resources.images.tiles(node.image)
    result = emitter.operation("image", [vector], ints)
    return emitter.component(result, 3) if output == "Alpha" else result


def _box(view: NodeView, vector: Register, ints: list[int], output: str) -> Register:
    """The sum of three lookups, each with its share."""
    emitter = view.emitter
    normal, blend = emitter.operation("object_normal"), emitter.scalar(view.node.projection_blend)
    total = emitter.scalar(0.0)
    for axis in range(3):
        side = emitter.operation("box_projection", [vector, normal, blend], [axis])
        share = emitter.component(side, 3)
        seen = emitter.operation("image", [side], ints)
        if output == "Alpha":
            total = emitter.add(total, emitter.multiply(emitter.component(seen, 3), share))
        else:
            scaled = emitter.operation("vector_math", [seen, share], text="MULTIPLY")
            total = emitter.operation("vector_math", [total, scaled], text="ADD")
    return total


@value_node("ShaderNodeTexEnvironment")
def environment(view: NodeView, output: str) -> Register:
    """Environment Texture."""
    name_hidden_mapping(view)
    node, emitter = view.node, view.emitter
    texture = _texture(view)
    if texture is None:
        return emitter.constant(*_PINK)
    direction = view.linked("Vector")
    if direction == UNCONNECTED:
        direction = emitter.operation("position")
    ints = [texture, _PROJECTIONS[node.projection], _reading(node)]
    return emitter.operation("environment", [direction], ints)
