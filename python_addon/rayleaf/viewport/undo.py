"""Counts what the user undoes and redoes: after that, pointers may stand for other data blocks."""

from typing import Any

import bpy
from bpy.app.handlers import persistent

from ..app_handlers import handlers_factory

_undone: list[None] = []


def count() -> int:
    """How often anything was undone or redone."""
    return len(_undone)


@persistent
def _note(_scene: Any, _depsgraph: Any = None) -> None:
    _undone.append(None)


register, unregister = handlers_factory(
    ((bpy.app.handlers.undo_post, _note), (bpy.app.handlers.redo_post, _note)), at_end=_undone.clear
)
