"""Rayleaf: a render engine for smooth geometry.

The package can be imported outside Blender: `rayleaf._core` is the renderer, and nothing here reads `bpy` before Blender
calls `register`. The core itself is loaded by the first render.
"""

from typing import Any

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


def register() -> None:
    """Called by Blender when the add-on is enabled."""
    from . import animation, engine, kept_messages, properties, ui, ui_rays
    from .report import panel

    properties.register()
    engine.register()
    animation.register()
    kept_messages.register()
    ui.register()
    ui_rays.register()
    panel.register()


def unregister() -> None:
    """Called by Blender when the add-on is disabled."""
    from . import animation, engine, kept_messages, properties, ui, ui_rays
    from .report import panel

    panel.unregister()
    ui_rays.unregister()
    ui.unregister()
    kept_messages.unregister()
    animation.unregister()
    engine.unregister()
    properties.unregister()
