"""The warnings and errors of the last render, kept for their panel until the next one begins."""

from typing import Any

import bpy
from bpy.app.handlers import persistent

from .app_handlers import handlers_factory
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


register, unregister = handlers_factory(
    (
        (bpy.app.handlers.render_init, _clear),
        (bpy.app.handlers.load_pre, _clear),
        (bpy.app.handlers.render_complete, _show),
        (bpy.app.handlers.render_cancel, _show),
    ),
    at_end=_KEPT.clear,
)
