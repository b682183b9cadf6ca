"""What is kept from one frame of an animation to the next: ray caches, and the parts of scenes that do not change.

After an animation, and of single pictures, nothing is kept, but for parts of scenes where Blender's Persistent Data says
so."""

from types import ModuleType
from typing import Any

import bpy
from bpy.app.handlers import persistent

from .app_handlers import handlers_factory
from .names import name_of


class Kept:
    """The ray caches of the animation under way, and the parts of its scenes."""

    def __init__(self) -> None:
        self._store: Any | None = None
        self._frames: dict[str, tuple[int, float]] = {}  # by scene: the one that was rendered last
        self._parts: Any | None = None
        self._keeps_parts = False  # after the animation too

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

    def parts(self, core: ModuleType, scene: Any, is_animation: bool) -> Any:
        """The SceneParts to render a scene's frame with."""
        if not is_animation and self._store is None and not scene.render.use_persistent_data:
            self._parts = None
            return core.SceneParts()
        if self._parts is None:
            self._parts = core.SceneParts()
        self._keeps_parts = scene.render.use_persistent_data
        return self._parts

    def end_animation(self) -> None:
        """Forget what is kept for the next frame."""
        self._store = None
        self._frames = {}
        if not self._keeps_parts:
            self._parts = None

    def clear(self) -> None:
        """Forget everything."""
        self._keeps_parts = False
        self.end_animation()


KEPT = Kept()


@persistent
def _end(_scene: Any, _depsgraph: Any = None) -> None:
    KEPT.end_animation()


@persistent
def _forget(_scene: Any, _depsgraph: Any = None) -> None:
    KEPT.clear()


register, unregister = handlers_factory(
    (
        (bpy.app.handlers.render_complete, _end),
        (bpy.app.handlers.render_cancel, _end),
        (bpy.app.handlers.load_pre, _forget),
    ),
    at_end=KEPT.clear,
)
