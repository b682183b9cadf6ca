"""The world to a shader program."""

from types import ModuleType
from typing import Any

from .. import versions
from ..messages import Messages, Subject
from ..names import name_of
from . import instances
from .nodes.compiler import Compiler
from .nodes.resources import Resources
from .nodes.emitter import Emitter
from .nodes.trees import shader_tree


def compile_world(core: ModuleType, world: Any, resources: Resources, messages: Messages) -> Any:
    """The program of a world: its nodes, else its colour."""
    subject = Subject("World", name_of(world))
    emitter = Emitter(core, subject.name)
    with shader_tree(world) as tree:
        if tree is not None:
            Compiler(emitter, subject, resources, messages, is_world=True).compile_tree(tree)
        else:
            emitter.operation("background", [emitter.scalar(1.0), emitter.constant(*world.color), emitter.scalar(1.0)])
    return emitter.program


def compile_medium(core: ModuleType, world: Any, resources: Resources, messages: Messages) -> Any | None:
    """The program of what fills all of space; None where nothing does."""
    subject = Subject("World", name_of(world))
    emitter = Emitter(core, subject.name)
    compiler = Compiler(emitter, subject, resources, messages, is_world=True)
    with shader_tree(world) as tree:
        return emitter.program if tree is not None and compiler.compile_volume(tree) else None


_VISIBILITY = {
    "camera": instances.VISIBLE_CAMERA,
    "diffuse": instances.VISIBLE_DIFFUSE,
    "glossy": instances.VISIBLE_GLOSSY,
    "transmission": instances.VISIBLE_TRANSMISSION,
    "scatter": instances.VISIBLE_VOLUME,
}


def visibility(world: Any) -> int:
    """The core's bits of the rays that see its light."""
    shown = versions.world_visibility(world, _VISIBILITY)
    return sum(bit for kind, bit in _VISIBILITY.items() if shown[kind])


def uses_nodes(world: Any) -> bool:
    """Whether its light may have small bright parts, so that directions are worth sampling by a table."""
    return bool(world.use_nodes and world.node_tree is not None)
