"""Renders of a part of each view layer, whose sums are kept, and of view layers that are put together from such parts.

`rayleaf render` sets `task`; without one, frames are rendered whole.
"""

import time
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from . import statistics, stereo
from .export import ExportError
from .export.camera import CropRectangle
from .frame import FrameRender
from .names import name_of
from .parts import Cut, LayerPart, LayerShape, PartError, Parts
from .session import RenderThread
from .settings import counted_samples


class PartTask:
    """Have a part of each view layer rendered; `layers` are those that are."""

    def __init__(self, cut: Cut) -> None:
        self.cut = cut
        self.layers: list[LayerPart] = []


class MergeTask:
    """Have view layers made of finished parts."""

    def __init__(self, parts: Parts) -> None:
        self.parts = parts


task: PartTask | MergeTask | None = None


def renderer() -> type[FrameRender]:
    """What renders a view layer now."""
    return PartRender if isinstance(task, PartTask) else MergedRender if isinstance(task, MergeTask) else FrameRender


def _shape(render: FrameRender, crop: CropRectangle, settings: dict[str, Any]) -> LayerShape:
    scene, frame = render.depsgraph.scene_eval, render.frame
    place = (crop.x, crop.y, crop.width, crop.height)
    picture, passes = (frame.width, frame.height), tuple(settings["passes"])
    layer = name_of(render.depsgraph.view_layer)
    return LayerShape(name_of(scene), layer, picture, place, settings["samples"], passes, render.view)


def _counted(render: FrameRender, settings: dict[str, Any]) -> dict[str, Any]:
    """Settings without a target error, which looks at whole pictures."""
    if settings["target_error"]:
        samples = counted_samples(render.depsgraph.scene_eval, render.depsgraph.view_layer)
        settings |= dict(target_error=0.0, samples=samples)
    return settings


class PartRender(FrameRender):
    """Some rows, some samples; Blender is handed no picture."""

    def _settings(self) -> dict[str, Any]:
        assert isinstance(task, PartTask)
        settings, crop = _counted(self, super()._settings()), self.crop
        (row, rows), (first, count) = task.cut.tile.of(crop.height), task.cut.samples.of(settings["samples"])
        if rows == 0 or count == 0:
            raise ExportError(
                f"{task.cut.name} is empty: the picture has {crop.height} rows and {settings['samples']} samples"
            )
        self._part = LayerPart(_shape(self, crop, settings), (0, row), count, {}, {})
        place = dict(part_x=crop.x, part_y=crop.y + row, part_width=crop.width, part_height=rows)
        if any(settings[name] for name in ("noise_threshold", "time_limit")) or self._scene.rayleaf.target_error > 0.0:
            self._messages.note(
                "Parts take all their samples: Noise Threshold, Target Error and Time Limit count as off"
            )
        whole = dict(noise_threshold=0.0, time_limit=0.0)
        return settings | place | whole | dict(first_sample=first, sample_count=count, keep_sums=True)

    def _tell_mattes(self, fields: dict[str, str]) -> None:
        assert isinstance(task, PartTask)
        if task.layers:
            task.layers[-1].fields.update(fields)

    def _write_result(self, session: RenderThread, finished: bool = False) -> None:
        assert isinstance(task, PartTask)
        if session.completed:
            task.layers.append(replace(self._part, sums=session.sums()))


class MergedRender(FrameRender):
    """Nothing is traced: the picture is made of finished parts."""

    def _run(self) -> None:
        assert isinstance(task, MergeTask)
        self._add_passes()
        for self.view in stereo.views(self._engine, self.depsgraph.scene_eval):
            self._merge_view()

    def _merge_view(self) -> None:
        assert isinstance(task, MergeTask)
        began = time.perf_counter()
        shape = _shape(self, self.crop, _counted(self, self._settings()))
        try:
            film = task.parts.film(self.core, shape)
        except PartError as error:
            raise ExportError(str(error)) from error
        self._hand_over(self._finished(film.pass_pixels))
        self._tell_mattes(task.parts.fields(shape))
        self._publish_merged([str(path) for path in task.parts.paths], time.perf_counter() - began)

    def _publish_merged(self, parts: Sequence[str], seconds: float) -> None:
        statistics.publish(
            {
                "scene": name_of(self.depsgraph.scene_eval),
                "frame": self.depsgraph.scene_eval.frame_current,
                "view_layer": self._layer_name,
                **({"view": self.view} if self.view else {}),
                "completed": True,
                "times": {"total": seconds},
                "parts": list(parts),
                "messages": [],
            }
        )
