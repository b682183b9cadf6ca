"""What is kept from one frame of an animation to the next: ray caches. Nothing is kept after an animation, nor of single
pictures."""

from types import ModuleType
from typing import Any

import bpy
from bpy.app.handlers import persistent

from .names import name_of


class KeptRayCaches:
    """The ray caches of the animation under way."""

    def __init__(self) -> None:
        self._store: Any | None = None
        self._frames: dict[str, tuple[int, float]] = {}  # by scene: the one that was rendered last

    def for_frame(self, core: ModuleType, scene: Any, is_animation: bool) -> Any:
        """The store to render a scene's frame with. What the scene's frame before did not use is dropped from it.

        Other scenes that the compositor shows are rendered within the frame of an animation; Blender does not call that
        one.
        """
        if self._store is None and not is_animation:
            return core.RayCacheStore()
        if self._store is None:
            self._store = core.RayCacheStore()
        name, frame = name_of(scene), (scene.frame_current, scene.frame_subframe)
        store = self._store.of_scene(name)
        if self._frames.get(name, frame) != frame:  # the view layers of one frame share theirs
            store.next_frame()
        self._frames[name] = frame
        return store

    def clear(self) -> None:
        """Forget everything."""
        self._store = None
        self._frames = {}


KEPT = KeptRayCaches()


@persistent
def _end(_scene: Any, _depsgraph: Any = None) -> None:
    KEPT.clear()


_HANDLERS = (bpy.app.handlers.render_complete, bpy.app.handlers.render_cancel, bpy.app.handlers.load_pre)


def register() -> None:
    """Learn from Blender when an animation ends."""
    for handlers in _HANDLERS:
        handlers.append(_end)


def unregister() -> None:
    """Stop that, and forget everything."""
    for handlers in _HANDLERS:
        handlers.remove(_end)
    KEPT.clear()
