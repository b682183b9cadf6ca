"""Repeat zones, closures, bundles, switches and functions, for test_nodes_oracle.py: Blender writes them out since 5.0."""

from dataclasses import dataclass
from typing import Any, Callable

import bpy

Sockets = dict[str, Any]


@dataclass
class Zone:
    """A case of several nodes: `build` makes them in a tree from its sources, and returns the output that is compared."""

    node: str  # without which this Blender does not have it
    build: Callable[[Any, Sockets], Any]

    @property
    def name(self) -> str:
        """What failures show."""
        return f"{self.node} {self.build.__name__}"

    def add(self, tree: Any, sources: Sockets) -> Any:
        """Makes the nodes; the output that is compared."""
        return self.build(tree, sources)


def _made(tree: Any, kind: str, *inputs: Any, **settings: Any) -> Any:
    """A node; its inputs are linked to outputs or written, None leaves them."""
    node = tree.nodes.new(kind)
    for name, value in settings.items():
        setattr(node, name, value)
    for socket, value in zip(node.inputs, inputs):
        if hasattr(value, "is_linked"):
            tree.links.new(value, socket)
        elif value is not None:
            socket.default_value = value
    return node


def _math(tree: Any, operation: str, *inputs: Any) -> Any:
    return _made(tree, "ShaderNodeMath", *inputs, operation=operation).outputs[0]


def _repeated(tree: Any, first: Any, step: Any, count: int) -> Any:
    """v becomes sin(2 v + step * iteration), so many times."""
    start, end = tree.nodes.new("GeometryNodeRepeatInput"), tree.nodes.new("GeometryNodeRepeatOutput")
    start.pair_with_output(end)
    end.repeat_items.new("FLOAT", "v")
    start.inputs["Iterations"].default_value = count
    tree.links.new(first, start.inputs["v"])
    moved = _math(tree, "MULTIPLY_ADD", step, start.outputs["Iteration"], start.outputs["v"])
    tree.links.new(_math(tree, "SINE", _math(tree, "MULTIPLY", moved, 2.0)), end.inputs["v"])
    return end.outputs["v"]


def repeat(tree: Any, sources: Sockets) -> Any:
    """A zone in the tree itself."""
    return _repeated(tree, sources["x"], sources["y"], 3)


def repeat_in_group(tree: Any, sources: Sockets) -> Any:
    """A zone in a group, whose inputs are linked."""
    group = bpy.data.node_groups.new("Repeats", "ShaderNodeTree")
    for name, way in (("first", "INPUT"), ("step", "INPUT"), ("result", "OUTPUT")):
        group.interface.new_socket(name, in_out=way, socket_type="NodeSocketFloat")
    start, end = group.nodes.new("NodeGroupInput"), group.nodes.new("NodeGroupOutput")
    group.links.new(_repeated(group, start.outputs["first"], start.outputs["step"], 2), end.inputs["result"])
    node = _made(tree, "ShaderNodeGroup", node_tree=group)
    tree.links.new(sources["y"], node.inputs["first"])
    tree.links.new(sources["x"], node.inputs["step"])
    return node.outputs["result"]


def closure_in_bundle(tree: Any, sources: Sockets) -> Any:
    """A closure that multiplies by y, sent in a bundle and evaluated with x."""
    start, end = tree.nodes.new("NodeClosureInput"), tree.nodes.new("NodeClosureOutput")
    start.pair_with_output(end)
    end.input_items.new("FLOAT", "a")
    end.output_items.new("FLOAT", "b")
    tree.links.new(_math(tree, "MULTIPLY", start.outputs["a"], sources["y"]), end.inputs["b"])
    pack, unpack = tree.nodes.new("NodeCombineBundle"), tree.nodes.new("NodeSeparateBundle")
    for node in (pack, unpack):
        node.bundle_items.new("CLOSURE", "f")
    tree.links.new(end.outputs[0], pack.inputs["f"])
    tree.links.new(pack.outputs[0], unpack.inputs[0])
    evaluated = tree.nodes.new("NodeEvaluateClosure")
    evaluated.input_items.new("FLOAT", "a")
    evaluated.output_items.new("FLOAT", "b")
    tree.links.new(unpack.outputs["f"], evaluated.inputs[0])
    tree.links.new(sources["x"], evaluated.inputs["a"])
    return evaluated.outputs["b"]


def menu_switch(tree: Any, sources: Sockets) -> Any:
    """The second of two values."""
    node = _made(tree, "GeometryNodeMenuSwitch", "B", sources["x"], sources["y"], data_type="FLOAT")
    return node.outputs[0]


def index_switch(tree: Any, sources: Sockets) -> Any:
    """The second of two vectors."""
    node = _made(tree, "GeometryNodeIndexSwitch", 1, sources["p"], sources["direction"], data_type="VECTOR")
    return node.outputs[0]


def integers(tree: Any, sources: Sockets) -> Any:
    """A factor of whole numbers: 7 modulo 4."""
    whole = _made(tree, "FunctionNodeIntegerMath", 7, 4, operation="MODULO").outputs[0]
    return _math(tree, "MULTIPLY", sources["x"], whole)


def _is_for_shaders(kind: str) -> bool:
    """Whether a tree of shaders may hold such a node in this Blender."""
    tree = bpy.data.node_groups.new("Tree", "ShaderNodeTree")
    try:
        tree.nodes.new(kind)
    except RuntimeError:
        return False
    finally:
        bpy.data.node_groups.remove(tree)
    return True


def zone_cases() -> list[Zone]:
    """Every case that this Blender has."""
    every = [
        Zone("GeometryNodeRepeatOutput", repeat),
        Zone("GeometryNodeRepeatOutput", repeat_in_group),
        Zone("NodeEvaluateClosure", closure_in_bundle),
        Zone("GeometryNodeMenuSwitch", menu_switch),
        Zone("GeometryNodeIndexSwitch", index_switch),
        Zone("FunctionNodeIntegerMath", integers),
    ]
    return [case for case in every if _is_for_shaders(case.node)]
