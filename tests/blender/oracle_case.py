"""A node as it is compared with Cycles."""

from dataclasses import dataclass, field
from typing import Any, Callable

import bpy

# What shapes a node's result and is kept beside its properties.
_PARTS = ("color_ramp", "mapping")


@dataclass
class Case:
    """A node, its settings, what is linked (by the name of a source that the comparison has) or written to its inputs, and
    the output that is compared. `shape` makes what settings cannot say: curves, ramps, values of outputs."""

    node: str
    settings: dict[str, Any] = field(default_factory=dict)
    inputs: dict[Any, Any] = field(default_factory=dict)
    output: str = ""
    shape: Callable[[Any], None] | None = None

    @property
    def name(self) -> str:
        """What failures show."""
        shape = f" {self.shape.__name__}" if self.shape else ""
        return f"{self.node.removeprefix('ShaderNode')} {self.settings} {self.inputs} {self.output}{shape}"

    def add(self, tree: Any, sources: dict[str, Any]) -> Any:
        """Makes the node in a tree; the output that is compared. Images are named."""
        node = tree.nodes.new(self.node)
        for name, value in self.settings.items():
            put(node, name, bpy.data.images[value] if name == "image" and isinstance(value, str) else value)
        if self.shape:
            self.shape(node)
        for name, value in self.inputs.items():
            target = socket(node.inputs, name)
            if isinstance(value, str) and value in sources:
                tree.links.new(sources[value], target)
            else:
                target.default_value = value
        return socket(node.outputs, self.output) if self.output else node.outputs[0]


def put(thing: Any, path: str, value: Any) -> None:
    """Set a property, by its path from the thing."""
    *way, name = path.split(".")
    for step in way:
        thing = getattr(thing, step)
    setattr(thing, name, value)


def socket(sockets: Any, name: Any) -> Any:
    """A socket by identifier, else by name or number."""
    return next((s for s in sockets if s.identifier == name), None) or sockets[name]


def choices(kind: str, name: str) -> list[str]:
    """What a node's choice may be in this Blender; nothing where it has no such node or choice."""
    prop = getattr(bpy.types, kind).bl_rna.properties.get(name) if hasattr(bpy.types, kind) else None
    return [item.identifier for item in prop.enum_items] if prop else []


def _switches(thing: Any, shared: Any = ()) -> dict[str, Any]:
    return {
        prop.identifier: getattr(thing, prop.identifier)
        for prop in thing.bl_rna.properties
        if prop.type in ("ENUM", "BOOLEAN") and not (prop.identifier in shared or prop.is_readonly)
    }


def modes(node: Any) -> dict[str, Any]:
    """The choices and switches that a node has of its own, as they are set."""
    found = _switches(node, bpy.types.ShaderNode.bl_rna.properties.keys())
    for name in _PARTS:
        part = getattr(node, name, None)
        if hasattr(part, "bl_rna"):
            found |= {f"{name}.{key}": value for key, value in _switches(part).items()}
    return found


def described(output: Any) -> dict[str, Any]:
    """What a comparison of an output is about: the node, its modes, the inputs that are linked or changed."""
    node = output.node
    plain = node.id_data.nodes.new(node.bl_idname)
    fresh = {each.identifier: _value(each) for each in plain.inputs}
    changed = [each.identifier for each in node.inputs if each.is_linked or _value(each) != fresh.get(each.identifier)]
    kind, switches = node.bl_idname, modes(node)
    node.id_data.nodes.remove(plain)
    return {"node": kind, "modes": switches, "inputs": changed, "output": output.identifier}


def described_nodes(tree: Any, kinds: Any) -> list[dict[str, Any]]:
    """The outputs of a tree's nodes of these kinds that its result is made of."""
    waiting = [link for link in tree.links if link.to_node.bl_idname.startswith("ShaderNodeOutput")]
    found: dict[Any, Any] = {}
    while waiting:
        output = waiting.pop().from_socket
        if output.as_pointer() not in found:
            found[output.as_pointer()] = output
            waiting += [link for link in tree.links if link.to_node == output.node]
    return [described(output) for output in found.values() if output.node.bl_idname in kinds]


def _value(socket_of_node: Any) -> Any:
    value = getattr(socket_of_node, "default_value", None)
    return tuple(value) if hasattr(value, "__len__") and not isinstance(value, str) else value
