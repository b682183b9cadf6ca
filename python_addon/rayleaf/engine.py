"""Blender's RenderEngine: each method hands on."""

import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import bpy

from . import core_module, enabling, failures, passes, statistics
from .names import name_of

_VIEWPORTS: dict[int, Any] = {}  # by the id of Blender's engine object
_renders = 0  # final ones that are under way, for which views wait
_LOCK = threading.Lock()  # for both: renders have threads of their own


@contextmanager
def _views_waiting() -> Iterator[None]:
    """Meanwhile all views wait, those too that are opened."""
    global _renders
    with _LOCK:
        _renders += 1
        for viewport in list(_VIEWPORTS.values()):
            viewport.pause()
    try:
        yield
    finally:
        with _LOCK:
            _renders -= 1
            for viewport in [] if _renders else list(_VIEWPORTS.values()):
                viewport.resume()


def _open_view(engine: Any) -> None:
    from .viewport.viewport import Viewport

    viewport = Viewport(engine, core_module.load())
    with _LOCK:
        _VIEWPORTS[id(engine)] = viewport
        if _renders:
            viewport.pause()


class RayleafRenderEngine(bpy.types.RenderEngine):
    """Rayleaf in Blender's list of render engines."""

    bl_idname = "RAYLEAF"
    bl_label = "Rayleaf"
    bl_use_eevee_viewport = True
    bl_use_preview = True
    bl_use_shading_nodes_custom = False

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)

    def __del__(self) -> None:
        viewport = _VIEWPORTS.pop(id(self), None)  # of Blender's part nothing may be asked any more
        if viewport is not None:
            viewport.close()

    def view_update(self, context: Any, depsgraph: Any) -> None:
        """What a view in Rendered shading shows has changed."""
        self._in_view(lambda viewport: viewport.update(context, depsgraph))

    def view_draw(self, context: Any, depsgraph: Any) -> None:
        """Draw a view in Rendered shading."""
        self._in_view(lambda viewport: viewport.draw(context, depsgraph))

    def _in_view(self, work: Callable[[Any], None]) -> None:
        """Errors stand in the view's corner, and end nothing."""
        try:
            if enabling.problem is not None:
                raise core_module.CoreError(enabling.problem)
            if id(self) not in _VIEWPORTS:
                _open_view(self)
            work(_VIEWPORTS[id(self)])
        except Exception as error:
            failures.report_in_view(self, error)

    def render(self, depsgraph: Any) -> None:
        """Render one view layer of one frame. The core is loaded here first. Whatever goes wrong ends this render alone."""
        try:
            if not self.is_preview:
                statistics.note_asked(name_of(depsgraph.scene), name_of(depsgraph.view_layer))
            if enabling.problem is not None:
                raise core_module.CoreError(enabling.problem)
            core = core_module.load()
            if self.is_preview:
                from . import preview

                preview.render(self, depsgraph, core)
                return
            from .animation import KEPT
            from .part_render import renderer

            ray_caches = KEPT.for_frame(core, depsgraph.scene_eval, self.is_animation)
            parts = KEPT.parts(core, depsgraph.scene_eval, self.is_animation)
            with _views_waiting():
                renderer()(self, depsgraph, core, ray_caches, parts).run()
        except Exception as error:
            failures.report(self, error)

    def update_render_passes(self, scene: Any, renderlayer: Any) -> None:
        """Tell Blender which passes come, for the compositor's sockets."""
        for entry in passes.enabled(renderlayer, scene):
            self.register_pass(scene, renderlayer, entry.name, len(entry.channels), entry.channels, entry.socket_type)


def register() -> None:
    """Add the engine to Blender's list."""
    bpy.utils.register_class(RayleafRenderEngine)


def unregister() -> None:
    """Take it away; views stop rendering first."""
    while _VIEWPORTS:
        _VIEWPORTS.popitem()[1].close()
    preview = sys.modules.get(f"{__package__}.preview")  # loaded by the first
    if preview is not None:
        preview.forget()
    bpy.utils.unregister_class(RayleafRenderEngine)
