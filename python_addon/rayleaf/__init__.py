"""Rayleaf: a render engine for smooth geometry.

The package can be imported outside Blender: `rayleaf._core` is the renderer, and nothing here reads `bpy` before Blender
calls `register`. The core itself is loaded by the first render; that it works is tested in a copy of
the process (self_test.py).
"""

from types import ModuleType
from typing import Any

__version__ = "0.1.0"

bl_info = {
    "name": "Rayleaf",
    "author": "The Rayleaf authors",
    "version": (0, 1, 0),
    "blender": (3, 4, 0),
    "location": "Properties > Render > Render Engine",
    "description": "Renders curves and surfaces from their control points",
    "category": "Render",
}

# What the last render did: the core's counters, and what the export sent, replaced or left out (see frame.py).
last_statistics: dict[str, Any] = {}


_registered: list[ModuleType] = []  # in the order in which Blender got to know them
_is_wanted = False  # whether the add-on is ticked; while a render runs, what is registered may lag behind


def register() -> None:
    """Called by Blender when the add-on is enabled."""
    global _is_wanted
    from . import (
        animation,
        enabling,
        engine,
        kept_messages,
        preferences,
        properties,
        sampling_presets,
        ui,
        ui_camera,
        ui_debug,
        ui_messages,
        ui_motion,
        ui_passes,
        ui_rays,
        ui_view_layer,
    )
    from .report import panel
    from .viewport import render_pass, undo

    _is_wanted = True
    if _registered or enabling.is_another_enabled():
        return
    enabling.check()
    shown = (
        ui_messages,
        sampling_presets,
        ui,
        ui_rays,
        ui_view_layer,
        ui_passes,
        ui_camera,
        ui_motion,
        panel,
        ui_debug,
    )
    for module in (preferences, properties, render_pass, undo, engine, animation, kept_messages, *shown):
        module.register()
        _registered.append(module)


def unregister() -> None:
    """Called by Blender when the add-on is disabled."""
    global _is_wanted
    from . import enabling

    _is_wanted = False
    enabling.when_no_render_runs(_take_back)


def _take_back() -> None:
    while _registered and not _is_wanted:
        _registered.pop().unregister()
