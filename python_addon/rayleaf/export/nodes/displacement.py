"""The Displacement output of a material: how far it moves the points of surfaces."""

from typing import Any

from .compiler import Compiler, NodeView
from .emitter import UNCONNECTED, Register
from .graph import Path, output_of

_WORLD, _OBJECT = 0, 1  # spaces of the operation `transform`


def compile_displacement(compiler: Compiler, tree: Any) -> tuple[Register, Register] | None:
    """Write what a tree's output displaces by; the registers of the vector in object space and of the one in world
    space, -1 for none. None where nothing is displaced."""
    output = output_of(tree)
    found = None if output is None else _source(compiler, output.inputs.get("Displacement"))
    if found is None:
        return None
    socket, path = found
    node = socket.node
    view = NodeView(compiler, node, path)
    if node.bl_idname == "ShaderNodeDisplacement":
        return _scalar(view)
    if node.bl_idname == "ShaderNodeVectorDisplacement":
        return _vector(view)
    return UNCONNECTED, compiler.output(socket, path)  # any other vector is one of the world, as in Cycles


def bend_normal(compiler: Compiler, tree: Any) -> None:
    """Have the surface's normal bent by what a tree's output would displace by."""
    registers = compile_displacement(compiler, tree)
    if registers is None:
        return
    emitter = compiler.emitter
    in_object, offset = registers
    if in_object != UNCONNECTED:
        offset = emitter.operation("transform", [in_object], [_OBJECT, _WORLD], text="VECTOR")
    height = emitter.operation("vector_math", [offset, emitter.operation("normal")], text="DOT_PRODUCT")
    one = emitter.scalar(1.0)
    normal = emitter.operation("bump", [height, one, one])
    emitter.operation("smooth_normal", [one, normal])
    compiler.bend_normal(normal)


def _source(compiler: Compiler, socket: Any) -> tuple[Any, Path] | None:
    """The output that feeds an input, past everything that merely passes it on."""
    path: Path = ()
    for _ in range(1000):  # nodes may form a loop
        link = None if socket is None else compiler.links.into(socket)
        if link is None:
            return None
        forward = compiler.links.forward(link.from_socket, path)
        if forward is None:
            return link.from_socket, path
        socket, path = forward
    return None


def _amount(view: NodeView, value: Register) -> Register:
    """(value - midlevel) * scale, by components."""
    level, scale = view.input("Midlevel"), view.input("Scale")
    moved = view.emitter.operation("vector_math", [value, level], text="SUBTRACT")
    return view.emitter.operation("vector_math", [moved, scale], text="MULTIPLY")


def _scalar(view: NodeView) -> tuple[Register, Register]:
    """Displacement node: along the normal."""
    in_world, normal = view.node.space == "WORLD", view.linked("Normal")
    if normal == UNCONNECTED:
        normal = view.emitter.operation("normal" if in_world else "object_normal")
    elif not in_world:
        normal = view.emitter.operation("transform", [normal], [_WORLD, _OBJECT], text="NORMAL")
    offset = view.emitter.operation("vector_math", [normal, _amount(view, view.input("Height"))], text="MULTIPLY")
    return (UNCONNECTED, offset) if in_world else (offset, UNCONNECTED)


def _vector(view: NodeView) -> tuple[Register, Register]:
    """Vector Displacement node. In tangent space X runs along U, Y along the normal and Z along V, as in Cycles."""
    offset = _amount(view, view.input("Vector"))
    if view.node.space == "TANGENT":
        offset = view.emitter.operation("from_tangent_space", [offset])
    return (UNCONNECTED, offset) if view.node.space == "WORLD" else (offset, UNCONNECTED)
