"""One 3-D view in Rendered shading."""

import weakref
from collections.abc import Callable
from types import ModuleType
from typing import Any

import gpu
from gpu_extras.presets import draw_texture_2d

from .. import failures, kept_messages, passes
from ..export import ExportError
from ..export.instances import has_shadow_catchers
from ..messages import Messages
from . import render_pass, view
from .sync import SceneSync
from .worker import Picture, Request, Worker, same_camera


def _wants_uv(context: Any) -> bool:
    return render_pass.entry_of(context.space_data).identifier == "uv"


class Viewport:
    """What Blender's engine object of a view hands its calls to."""

    def __init__(self, engine: Any, core: ModuleType) -> None:
        self._core = core
        self._engine: Callable[[], Any] = weakref.ref(engine)
        self.sync = SceneSync(core, lambda: Messages(kept_messages.keep))
        self._scene: Any | None = None  # the core's
        self._request: Request | None = None
        self._texture: Any | None = None
        self._drawn: Picture | None = None
        self._worker = Worker(core, self._redraw)
        self._problem = ""
        self._has_catchers = False  # the scene, of shadows
        self._has_uv = False  # what was exported

    def close(self) -> None:
        """Stop rendering."""
        self._worker.close()

    def pause(self) -> None:
        """Wait."""
        self._worker.pause()

    def resume(self) -> None:
        """Go on."""
        self._worker.resume(self._request)

    def update(self, context: Any, depsgraph: Any) -> None:
        """The scene has changed: export it. Where that fails nothing is shown but why: the picture is no longer true."""
        try:
            camera, frame, self._has_uv = view.camera_of(context, depsgraph), view.frame_of(context), _wants_uv(context)
            self._scene = self.sync.update(depsgraph, frame, camera, self._has_uv, context.space_data)
            self._problem, self._has_catchers = "", has_shadow_catchers(depsgraph)
        except (ExportError, self._core.InputError) as error:
            self._scene, self._problem = None, str(error)
        except Exception as error:
            self._scene, self._problem = None, failures.told(error)
            raise
        self._ask(context, depsgraph)

    def draw(self, context: Any, depsgraph: Any) -> None:
        """Draw what there is; ask for another picture where the view has changed."""
        if _wants_uv(context) and not self._has_uv:  # another pass is no change of the scene
            self.update(context, depsgraph)
        self._ask(context, depsgraph)
        self._tell()
        if self._scene is None:
            return
        picture = self._worker.picture()
        if picture is None:
            return
        if picture is not self._drawn:
            self._texture, self._drawn = _texture_of(picture), picture
        engine = self._engine()
        gpu.state.blend_set("ALPHA_PREMULT")
        engine.bind_display_space_shader(depsgraph.scene)
        draw_texture_2d(self._texture, *picture.place_in(context.region.width, context.region.height))
        engine.unbind_display_space_shader()
        gpu.state.blend_set("NONE")

    def _ask(self, context: Any, depsgraph: Any) -> None:
        if self._scene is None:
            return
        scene, frame = depsgraph.scene, view.frame_of(context)
        camera, shown = view.camera_of(context, depsgraph), render_pass.entry_of(context.space_data)
        crop = view.crop_of(context, frame, camera)
        settings = view.settings_of(self._core, scene, depsgraph.view_layer, frame, crop, shown)
        if self._has_catchers:
            settings["passes"] += passes.for_catchers([shown])
        denoising = view.denoising_of(scene, shown)
        if denoising is not None:
            settings["passes"] += denoising.guides
        request = Request(self._scene, settings, camera, scene.rayleaf.preview_samples, denoising)
        before = self._request
        is_edit = not request.is_same_scene(before)
        if before is not None and not is_edit:
            same_view = same_camera(before.camera, camera)
            wanted = (settings, request.samples, denoising)
            if same_view and (before.settings, before.samples, before.denoising) == wanted:
                return
        self._request = request
        self._worker.show(request, is_edit)

    def _tell(self) -> None:
        engine = self._engine()
        if self._problem:
            engine.update_stats("Rayleaf", self._problem)
            return
        wanted = self._request.samples if self._request else 0
        taken = self._drawn.samples if self._drawn else 0
        caches = self._drawn.interpolated if self._drawn else None
        told = "" if caches is None else f" | {caches:.0%} of rays interpolated"
        problem = self._drawn.problem if self._drawn else ""
        engine.update_stats(problem, f"Rayleaf | Sample {taken}/{wanted}{told}")

    def _redraw(self) -> None:
        engine = self._engine()
        if engine is None:
            return
        try:
            engine.tag_redraw()
        except ReferenceError:  # Blender has closed the view meanwhile
            pass


def _texture_of(picture: Picture) -> Any:
    height, width = picture.pixels.shape[:2]
    buffer = gpu.types.Buffer("FLOAT", height * width * 4, picture.texels)
    return gpu.types.GPUTexture((width, height), format="RGBA16F", data=buffer)
