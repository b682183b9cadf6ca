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


@persistent
def _show(_scene: Any, _depsgraph: Any = None) -> None:
    """Panels of what a render did are drawn again."""
    for manager in bpy.data.window_managers:
        for window in manager.windows:
            for area in window.screen.areas:
                if area.type == "PROPERTIES":
                    area.tag_redraw()


_HANDLERS = (
    (bpy.app.handlers.render_init, _clear),
    (bpy.app.handlers.load_pre, _clear),
    (bpy.app.handlers.render_complete, _show),
    (bpy.app.handlers.render_cancel, _show),
)


def register() -> None:
    """Learn from Blender when a render begins and ends."""
    for handlers, handler in _HANDLERS:
        handlers.append(handler)


def unregister() -> None:
    """Stop that, and forget everything."""
    for handlers, handler in _HANDLERS:
        handlers.remove(handler)
    _KEPT.clear()
