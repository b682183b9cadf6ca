"""The warnings and errors of the last render, kept for their panel until the next one begins."""

from typing import Any

import bpy
from bpy.app.handlers import persistent

from .messages import Message

_KEPT: dict[str, Message] = {}


def keep(message: Message) -> None:
    """Keep what takes something from the picture; each text once, however many frames and layers repeat it."""
    if message.kind != "INFO":
        _KEPT.setdefault(message.text, message)


def kept() -> list[Message]:
    """In the order in which they came."""
    return list(_KEPT.values())


@persistent
def _clear(_scene: Any, _depsgraph: Any = None) -> None:
    _KEPT.clear()


_HANDLERS = (bpy.app.handlers.render_init, bpy.app.handlers.load_pre)


def register() -> None:
    """Learn from Blender when a render begins."""
    for handlers in _HANDLERS:
        handlers.append(_clear)


def unregister() -> None:
    """Stop that, and forget everything."""
    for handlers in _HANDLERS:
        handlers.remove(_clear)
    _KEPT.clear()
