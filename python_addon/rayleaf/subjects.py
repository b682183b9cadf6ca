"""Finds in the open file what a message is about, and selects it."""

from collections.abc import Iterator
from typing import Any

from .messages import Subject
from .names import find, name_of

_OBJECTS = {"Object", "Light", "Camera"}
SELECTABLE = {*_OBJECTS, "Material", "World", "Image"}


def select(context: Any, data: Any, subject: Subject) -> bool:
    """Select what is meant, and nothing else; `data` is Blender's `bpy.data`. False if the view layer does not have it."""
    if subject.kind in _OBJECTS:
        item = find(context.view_layer.objects, subject.name)
        if item is None:
            return False
        _select_object(context, item)
        _select_node(getattr(item.data, "node_tree", None), subject.node)
        return True
    if subject.kind == "World":
        world = context.scene.world
        _select_node(None if world is None else world.node_tree, subject.node)
        return world is not None
    if subject.kind == "Material":
        material = find(data.materials, subject.name)
        return material is not None and _select_material(context, material, subject.node)
    return _select_image(context, data, subject.name)


def _select_object(context: Any, item: Any) -> None:
    for each in context.view_layer.objects:
        each.select_set(each == item)
    context.view_layer.objects.active = item


def _select_material(context: Any, material: Any, node: str) -> bool:
    """Select the first object that shows a material, its slot, and a node."""
    for item in context.view_layer.objects:
        for index, slot in enumerate(item.material_slots):
            if slot.material == material:
                _select_object(context, item)
                item.active_material_index = index
                _select_node(material.node_tree, node)
                return True
    return False


def _select_image(context: Any, data: Any, name: str) -> bool:
    """Select the first node of a material that shows an image."""
    for material in data.materials:
        for _, node in _nodes(material.node_tree):
            image = getattr(node, "image", None)
            if image is not None and name_of(image) == name and _select_material(context, material, name_of(node)):
                return True
    return False


def _nodes(tree: Any) -> Iterator[tuple[Any, Any]]:
    """(tree, node) of a tree and the groups in it, each tree once."""
    trees, seen = [tree], set()
    while trees:
        each = trees.pop()
        if each is None or each.as_pointer() in seen:
            continue
        seen.add(each.as_pointer())
        for node in each.nodes:
            yield each, node
            trees.append(getattr(node, "node_tree", None))


def _select_node(tree: Any, name: str) -> None:
    """Make a node the active one of its tree; an empty name means none."""
    found = next(((owner, node) for owner, node in _nodes(tree) if name_of(node) == name), None) if name else None
    if found is None:
        return
    owner, node = found
    for each in owner.nodes:
        each.select = each == node
    owner.nodes.active = node
