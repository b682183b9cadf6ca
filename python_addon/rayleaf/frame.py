"""The render of one view layer of one frame: export, render in a thread, hand the picture to Blender."""

import time
from collections.abc import Callable
from dataclasses import asdict
from functools import partial
from types import ModuleType
from typing import Any

import bpy

from . import cache_report, kept_messages, passes, ray_report, statistics, stereo, versions
from .denoising import Denoising
from .export import CancelCheck, ExportCancelled, ExportError
from .export.camera import CropRectangle, Frame, crop_of, frame_of
from .export.instances import has_shadow_catchers
from .export.kept import KeptExport
from .export.motion import shutter_open
from .export.scene import SceneExporter
from .export.shapes import ExportReport
from .messages import Message, Messages, Subject
from .names import is_plain, name_of
from .session import RenderThread
from .settings import core_settings

_POLL_SECONDS = 0.03  # how soon Esc is noticed
_FIRST_RESULT_SECONDS = 0.3  # until the first unfinished picture is shown
_RESULT_SECONDS = 1.0  # between unfinished pictures, at least
_RESULT_SHARE = 0.1  # of the time may go into showing them


def _layer_argument(depsgraph: Any) -> str:
    """How Blender's result is told for which view layer it is. Only names in UTF-8 can be said; the one layer that there is
    needs no name."""
    if is_plain(depsgraph.view_layer):
        return name_of(depsgraph.view_layer)
    if sum(layer.use for layer in depsgraph.scene.view_layers) > 1:
        raise ExportError(
            f"View layer '{name_of(depsgraph.view_layer)}': its name is not UTF-8, so that its picture cannot be told"
            " from those of other layers; rename it"
        )
    return ""


def _tell(engine: Any, message: Message) -> None:
    kept_messages.keep(message)
    engine.report({message.kind}, message.text)


class FrameRender:
    """Renders one view layer through Blender's engine object."""

    def __init__(
        self, engine: Any, depsgraph: Any, core: ModuleType, ray_caches: Any = None, parts: Any = None
    ) -> None:
        """`ray_caches`: a RayCacheStore, `parts`: SceneParts that outlive the frame, or None."""
        self._engine, self.depsgraph, self.core = engine, depsgraph, core
        self._ray_caches, self._parts = ray_caches, parts
        # No method of this: a reference cycle would hold the scene until Python collects it.
        self._messages = Messages(partial(_tell, engine))
        self._scene = depsgraph.scene_eval
        self._layer_name = name_of(depsgraph.view_layer)
        self._layer = ""  # what Blender's result is told of the name; empty: any layer
        self.view = ""  # of a stereoscopic picture; empty: it is none
        self.frame: Frame = frame_of(self._scene)
        self.crop: CropRectangle = crop_of(self._scene, self.frame)
        self._passes = passes.enabled(depsgraph.view_layer, self._scene)
        self._status_text = ""

    def run(self) -> None:
        """Render to the end or until cancelled. What goes wrong is reported and ends this render alone."""
        try:
            self._run()
        except ExportCancelled:
            pass
        except (ExportError, self.core.InputError) as error:
            self._messages.error(str(error))
            self._engine.error_set(str(error))

    def _run(self) -> None:
        self._add_passes()
        kept = KeptExport()
        for self.view in stereo.views(self._engine, self._scene):
            if not self._engine.test_break():
                kept = self._render_view(kept)

    def _render_view(self, kept: KeptExport) -> KeptExport:
        """Of a stereoscopic picture one after the other: `kept` is what the export before left."""
        began = time.perf_counter()
        self._status("exporting", 0.0)
        eye = stereo.eye_in(self._engine, self.depsgraph, self.view)
        exporter = SceneExporter(self.core, self.depsgraph, self._messages, self._engine.test_break, self._parts, kept)
        shown, check = {entry.identifier for entry in self._passes}, CancelCheck(self._engine.test_break)
        arguments = (self.core, self._engine, self.depsgraph, self.frame, passes.VECTOR in shown, check, eye)
        with shutter_open(*arguments) as motions:
            description = exporter.export(self.frame, needs_uv="uv" in shown, motions=motions, eye=eye)
        exported = time.perf_counter()
        session = RenderThread(self.core, description, self.core.Settings(**self._settings()), self._ray_caches)
        try:
            session.start()
            self._follow(session)
            session.raise_error()
            self._write_result(session, finished=True)
            self._tell_mattes(self._mattes_of(description))
            rendered = time.perf_counter()
            times = {"export": exported - began, "render": rendered - exported, "total": rendered - began}
            self._publish(session, exporter.report, times)
        finally:
            session.close()
        return exporter.left if self.view else KeptExport()

    def _settings(self) -> dict[str, Any]:
        layer = self.depsgraph.view_layer
        settings = core_settings(self.core, self._scene, layer, self.frame, self.crop, self._passes)
        if has_shadow_catchers(self.depsgraph):
            settings["passes"] += passes.for_catchers(self._passes)
        if self._scene.rayleaf.use_denoising:
            settings["passes"] += Denoising.of(self._scene).guides
        return settings

    def _add_passes(self) -> None:
        """Blender makes room for its own passes only."""
        self._layer = _layer_argument(self.depsgraph)
        for entry in self._passes:
            if entry.needs_room:
                self._engine.add_pass(entry.name, len(entry.channels), entry.channels, layer=self._layer)

    def _follow(self, session: RenderThread) -> None:
        """Until the core has ended: look for Esc, tell how far it is, show what there is."""
        next_result = time.perf_counter() + _FIRST_RESULT_SECONDS
        cancelled = False
        while not session.wait(_POLL_SECONDS):
            if not cancelled and self._engine.test_break():
                session.cancel()
                cancelled = True
            stage, share = session.progress()
            self._status(stage, share)
            if not bpy.app.background and not cancelled and share > 0.0 and time.perf_counter() >= next_result:
                began = time.perf_counter()
                self._write_result(session)
                ended = time.perf_counter()
                next_result = ended + max(_RESULT_SECONDS, (ended - began) / _RESULT_SHARE)

    def _status(self, stage: str, share: float) -> None:
        what = f"{self._layer_name}, {self.view}" if self.view else self._layer_name
        text = f"Rayleaf | {what} | {stage.capitalize()} {share:.0%}"
        if text == self._status_text:  # without a window every call prints a line
            return
        self._status_text = text
        self._engine.update_progress(share)
        self._engine.update_stats("", text)
        memory = statistics.process_memory()
        if memory is not None:
            self._engine.update_memory_stats(memory_used=memory[0], memory_peak=memory[1])

    def _write_result(self, session: RenderThread, finished: bool = False) -> None:
        """Hand over the passes as they are; of a finished picture, without its noise if that is asked for."""
        self._hand_over(self._finished(session.pixels) if finished else passes.pixels(self._passes, session.pixels))

    def _finished(self, of: Callable[[str], Any]) -> dict[str, Any]:
        """By Blender's pass name; `of` gives them by the core's."""
        pictures = passes.pixels(self._passes, of)
        if self._scene.rayleaf.use_denoising:
            self._status("denoising", 1.0)
            try:
                pictures["Combined"] = Denoising.of(self._scene).applied(self.core, of)
            except self.core.InputError as error:
                subject = Subject("Scene", name_of(self._scene))
                self._messages.warn(f"{subject}: {error}; the picture keeps its noise", subject)
        return pictures

    def _hand_over(self, pixels: dict[str, Any]) -> None:
        """By Blender's pass name. All is ready before Blender's result is opened."""
        size = self.crop.width, self.crop.height
        result = self._engine.begin_result(0, 0, *size, layer=self._layer, view=self.view)
        try:
            versions.write_passes(result.layers[0], pixels)
        finally:
            self._engine.end_result(result)

    def _mattes_of(self, description: Any) -> dict[str, str]:
        """What Cryptomatte's passes need beside their pixels: fields of files' headers."""
        fields: dict[str, str] = {}
        for kind in passes.matte_kinds(self._passes):
            layer = f"{self._layer_name}.{passes.matte_name(kind)}"
            fields |= description.matte_attributes(kind.upper(), layer)
        return fields

    def _tell_mattes(self, fields: dict[str, str]) -> None:
        """Which names the ids of mattes stand for; compositors and files get it with the picture."""
        result = self._engine.get_result() if fields else None
        for field, text in fields.items():
            result.stamp_data_add_field(field, text)

    def _publish(self, session: RenderThread, report: ExportReport, times: dict[str, float]) -> None:
        record = {
            "scene": name_of(self._scene),
            "frame": self._scene.frame_current,
            "view_layer": self._layer_name,
            **({"view": self.view} if self.view else {}),
            "completed": session.completed,
            "times": times,
            "export": asdict(report),
            "core": session.statistics(),
        }
        for line in cache_report.lines(record["core"]):
            self._engine.update_stats("", f"Rayleaf | {self._layer_name} | {line}")
        decided = ray_report.decision(record)
        if decided:
            self._messages.note(decided)
        record["messages"] = self._messages.texts
        statistics.publish(record)
