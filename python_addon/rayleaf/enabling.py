"""What is checked when the add-on is enabled, and how people hear of what is wrong."""

import logging
from collections.abc import Callable
from typing import Any

import bpy

from . import self_test
from .messages import wrapped

# Why Rayleaf cannot render in this Blender; None if it can.
problem: str | None = None

_POLL_SECONDS = 0.3
_RENDERING = "Rayleaf is rendering: it is disabled once the render has ended."
_OTHER = (
    "Another Rayleaf is enabled in this Blender. Disable it (Edit > Preferences > Add-ons), then enable this one again: "
    "two at once would answer in each other's place."
)


def check() -> None:
    """Find out whether the core works here, and tell if it does not."""
    global problem
    problem = self_test.checked()
    if problem is not None:
        tell(problem)


def is_another_enabled() -> bool:
    """True if some other Rayleaf has its place in Blender already; tells."""
    if not hasattr(bpy.types.Scene, "rayleaf"):
        return False
    tell(_OTHER)
    return True


def when_no_render_runs(act: Callable[[], None]) -> None:
    """Now, or once the render that runs has ended: Blender would go on with an engine that is gone."""
    if not bpy.app.is_job_running("RENDER"):
        act()
        return
    tell(_RENDERING)

    def look_again() -> float | None:
        if bpy.app.is_job_running("RENDER"):
            return _POLL_SECONDS
        act()
        return None

    bpy.app.timers.register(look_again, first_interval=_POLL_SECONDS)


def tell(text: str) -> None:
    """To the terminal, and in a window of Blender's as soon as it can show one."""
    logging.getLogger("rayleaf").error("Rayleaf: %s", text)
    if not bpy.app.background:
        bpy.app.timers.register(lambda: _show(text), first_interval=0.5)


def _show(text: str) -> None:
    def draw(menu: Any, _context: Any) -> None:
        for line in wrapped(text):
            menu.layout.label(text=line)

    bpy.context.window_manager.popup_menu(draw, title="Rayleaf", icon="ERROR")
