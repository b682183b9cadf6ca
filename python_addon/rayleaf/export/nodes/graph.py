"""Node trees as a graph: what tells sockets apart, groups, the graph of shaders."""

from dataclasses import dataclass, field
from typing import Any

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
