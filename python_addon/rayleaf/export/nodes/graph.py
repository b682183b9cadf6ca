"""Node trees as a graph: what tells sockets apart, groups, links past all that merely passes values on, the graph of shaders."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from ... import cycles_versions
from ...names import text_of

# The way into nested groups: the group nodes entered, outermost first.
Path = tuple[Any, ...]


@dataclass
class Shader:
    """A node of the graph of shaders: a closure, a mixing node, or a value that shines."""

    key: Any
    socket: Any
    path: Path
    uses: "list[Shader | None]" = field(default_factory=list)


def is_group(node: Any) -> bool:
    """Whether a node stands for a tree: Blender's groups, and those that add-ons define."""
    return hasattr(node, "node_tree")


def output_of(tree: Any) -> Any:
    """The output node of a material, world or lamp that counts; None without one, or if it is muted."""
    output = tree.get_output_node("CYCLES")
    return None if output is None or output.mute else output


def group_output(tree: Any) -> Any:
    """The node at which a group's outputs arrive; None without one."""
    outputs = [node for node in tree.nodes if node.bl_idname == "NodeGroupOutput"]
    return next((node for node in outputs if node.is_active_output), outputs[0] if outputs else None)


def by_identifier(sockets: Any, twin: Any) -> Any:
    """The socket at the other side of a group's border."""
    identifier = text_of(twin, "identifier")
    return next((socket for socket in sockets if text_of(socket, "identifier") == identifier), None)


def key_of(socket: Any, path: Path) -> tuple[int, ...]:
    """Tells an output of one use of a group from those of all others."""
    return (*(group.as_pointer() for group in path), socket.as_pointer())


class Links:
    """The links of a tree and of the groups in it."""

    def __init__(self, warn: Callable[[Any, str], None]) -> None:
        """`warn` tells about a node."""
        self._warn = warn
        self._links: dict[int, dict[int, Any]] = {}  # by the pointer of the tree, then of the input

    def into(self, socket: Any) -> Any:
        """The link into an input, None if nothing valid is linked."""
        tree = socket.id_data
        key = tree.as_pointer()
        if key not in self._links:
            self._links[key] = {link.to_socket.as_pointer(): link for link in tree.links if not link.is_muted}
        return self._links[key].get(socket.as_pointer())

    def forward(self, socket: Any, path: Path) -> tuple[Any, Path] | None:
        """The input that an output merely passes on (reroutes, muted nodes, groups and their borders), with its path.

        None for outputs of nodes that compute; the input is None where nothing is passed on.
        """
        node = socket.node
        if node.bl_idname == "NodeReroute":
            return node.inputs[0], path
        if node.mute:
            inner = next((link.from_socket for link in node.internal_links if link.to_socket == socket), None)
            return inner, path
        if is_group(node):
            if node.node_tree is None:
                self._warn(node, "its node group is missing")
                return None, path
            output = group_output(node.node_tree)
            return (by_identifier(output.inputs, socket) if output else None), (*path, node)
        if node.bl_idname == "NodeGroupInput" and path:
            return by_identifier(path[-1].inputs, socket), path[:-1]
        return None

    def feeding(self, socket: Any, path: Path) -> Any:
        """The link into an input of a value; None too where in Cycles the input has its own value although it is linked: to
        nothing but an input that nothing is linked to, or to a shader."""
        first = link = self.into(socket)
        seen: set[Any] = set()
        while link is not None:
            key = key_of(link.from_socket, path)
            forward = None if key in seen else self.forward(link.from_socket, path)
            if forward is None:
                return None if self._ignores_shader(link, socket) else first
            seen.add(key)
            node, (inner, path) = link.from_node, forward
            link = None if inner is None else self.into(inner)
            if link is None:
                return first if _passes_on(node, inner, socket) else None
        return None

    def _ignores_shader(self, link: Any, asked: Any) -> bool:
        """Whether an input of a value is linked to a shader; then the user is told."""
        if link.from_socket.type != "SHADER" or asked.type == "SHADER":
            return False
        self._warn(
            asked.node,
            f"its input {text_of(asked, 'name')} is linked to a shader, which has no value; the link is ignored",
        )
        return True


def _passes_on(node: Any, unlinked: Any, asked: Any) -> bool:
    """Whether an input receives what a node passes on: what nothing is linked to, or (None) nothing."""
    if unlinked is None:
        return not node.mute
    if cycles_versions.passes_unlinked_on():
        return not (asked.hide_value and asked.type == "VECTOR")  # a normal or a coordinate
    return not (node.mute or node.bl_idname == "NodeReroute")
