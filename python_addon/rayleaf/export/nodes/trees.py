"""The node trees that shaders are read from."""

import re
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from ...names import name_of
from .graph import is_group

# What the compiler reads itself, beside the nodes that compute: those that pass values on, and frames.
_PLAIN = {"NodeFrame", "NodeReroute", "NodeGroupInput", "NodeGroupOutput"}
# How Blender names a tree that it has written out; the nodes in it are numbered: "12_Noise Texture".
_WRITTEN_OUT = "Nodetree Inlined"
_NUMBER = re.compile(r"\d+_(?=.)")


def _is_plain(tree: Any, seen: set[int]) -> bool:
    """Whether the compiler reads a tree and the groups in it as they are."""
    key = tree.as_pointer()
    if key in seen:
        return True
    seen.add(key)
    for node in tree.nodes:
        if is_group(node):
            if node.node_tree is not None and not _is_plain(node.node_tree, seen):
                return False
        elif not node.bl_idname.startswith("ShaderNode") and node.bl_idname not in _PLAIN:
            return False
    return True


@contextmanager
def shader_tree(owner: Any) -> Iterator[Any]:
    """The tree of a material, world or lamp, None for one without nodes. Its nodes are valid inside the context.

    Since 5.0 trees may hold repeat zones, closures, bundles, switches and functions. Blender writes such a tree out: what is left
    are nodes that compute. It does so for Cycles too.
    """
    if not owner.use_nodes or owner.node_tree is None:
        yield None
        return
    written = None
    if hasattr(owner, "inline_shader_nodes") and not _is_plain(owner.node_tree, set()):
        written = owner.inline_shader_nodes()  # owns its tree
    yield owner.node_tree if written is None else written.node_tree


def name_in_file(node: Any) -> str:
    """The name of a node in the user's tree."""
    name = name_of(node)
    return _NUMBER.sub("", name, count=1) if name_of(node.id_data).endswith(_WRITTEN_OUT) else name
