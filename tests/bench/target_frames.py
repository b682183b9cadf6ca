"""Runs inside Blender, in the file that is open: small pictures of it to a target error or a noise threshold each, how near
they came, and what a fixed number of samples costs that comes as near.

What a picture is off by is seen in two converged ones of other random numbers, of facets as fine as can be: the product
of its differences to either, in the mean of pixels and channels. Their own noise drops out of that. Of the worst hundredth
of pixels, the distance of colours to the mean of both tells it. Fixed numbers of samples have the usual facets, which no
number of samples makes finer, so they are held against converged pictures of the same facets: only their noise counts.
"""

import json
import math
import sys
import time
from pathlib import Path

import bpy
import numpy as np
from rayleaf import core_module, passes
from rayleaf.export.camera import crop_of, frame_of
from rayleaf.export.scene import SceneExporter
from rayleaf.messages import Messages
from rayleaf.report.errors import displayed
from rayleaf.settings import core_settings

SEEDS = (101, 202)  # of the converged pictures
WORST = 0.99  # of pixels are nearer
MOST_MORE = 4  # times the samples of the first look, in the second


class Pictures:
    """Of the open file, `width` pixels wide."""

    def __init__(self, width: int, converged: int, interpolates: bool) -> None:
        scene = bpy.context.scene
        scene.render.engine, scene.render.resolution_percentage = "RAYLEAF", 100
        height = max(scene.render.resolution_y * width // scene.render.resolution_x, 8)
        scene.render.resolution_x, scene.render.resolution_y = width, height
        depsgraph = bpy.context.evaluated_depsgraph_get()
        self._core, frame = core_module.load(), frame_of(scene)
        self._scene = SceneExporter(self._core, depsgraph, Messages(), lambda: False).export(frame, needs_uv=False)
        shown = [entry for entry in passes.table() if entry.identifier in ("combined", "sample_count")]
        arguments = (self._core, scene, depsgraph.view_layer, frame, crop_of(scene, frame), shown)
        self._settings = core_settings(*arguments)
        self._settings.update(noise_threshold=0.0, target_error=0.0, time_limit=0.0)
        off = self._core.RayInterpolation()
        fine, usual = dict(target_error=1e-9), dict(target_error=0.0)
        self._converged, self._converged_usual = (
            [self._rendered(samples=converged, ray_interpolation=off, seed=seed, **facets)[1] for seed in SEEDS]
            for facets in (fine, usual)
        )
        self._settings["ray_interpolation"] = self._core.RayInterpolation(mode="ON") if interpolates else off

    def _rendered(self, **settings):
        """The session, its picture as a screen shows it, and seconds of all threads."""
        session = self._core.Session(self._scene, self._core.Settings(**{**self._settings, **settings}))
        began = time.process_time()
        assert session.render()
        return session, displayed(session.pass_pixels("combined")), time.process_time() - began

    @staticmethod
    def _off_by(picture, converged) -> float:
        square = float(np.mean((picture - converged[0]) * (picture - converged[1])))
        return max(square, 0.0) ** 0.5

    @staticmethod
    def _at_most(picture, converged) -> float:
        """What the error is below in 97 of 100 cases: the noise of the converged pictures leaves that doubt."""
        squares = np.mean((picture - converged[0]) * (picture - converged[1]), axis=-1)
        return max(float(np.mean(squares) + 2 * np.std(squares) / squares.size**0.5), 0.0) ** 0.5

    @staticmethod
    def _worst(picture, converged) -> float:
        distances = np.linalg.norm(picture - np.mean(converged, axis=0), axis=-1)
        return float(np.quantile(distances, WORST))

    def _fixed(self, measure, wanted: float, count: int) -> tuple[float, float]:
        """Seconds and samples, the same for all pixels, that reach what is wanted of a measure: looked for twice, since
        errors fall faster than those of independent samples. The second look takes at most MOST_MORE times the samples:
        one path of enormous weight may have spoilt a pixel for all numbers that could be tried."""
        power, taken, error = 0.5, 0, 0.0
        for _ in range(2):
            before, error_before, taken = taken, error, count
            _, picture, seconds = self._rendered(samples=taken, seed=7)
            error = measure(picture, self._converged_usual)
            if before not in (0, taken) and 0.0 not in (error, error_before):
                power = min(max(math.log(error_before / error) / math.log(taken / before), 0.5), 1.0)
            more = (error / wanted) ** (1 / power)
            count = max(round(taken * min(more, MOST_MORE)), 1)
        return seconds * more, taken * more

    def row(self, setting: str, value: float, most: int) -> dict[str, float]:
        """What comes of one value of a setting."""
        self._rendered(samples=1, seed=7, **{setting: value})  # facets and textures are there when time counts
        session, picture, seconds = self._rendered(samples=most, seed=7, **{setting: value})
        counts = session.pass_pixels("sample_count")
        mean = float(counts.mean())
        achieved, worst = self._off_by(picture, self._converged), self._worst(picture, self._converged)
        wanted = value if setting == "target_error" else achieved
        fixed_seconds, fixed_samples = self._fixed(self._off_by, wanted, round(mean))
        return dict(
            value=value,
            achieved=achieved,
            at_most=self._at_most(picture, self._converged),
            estimated=session.statistics()["error"].get("noise", math.nan),
            least=int(counts.min()),
            mean=mean,
            most=int(counts.max()),
            seconds=seconds,
            fixed_seconds=fixed_seconds,
            fixed_samples=fixed_samples,
            fixed_seconds_of_worst=self._fixed(self._worst, worst, round(mean))[0],
        )


if __name__ == "__main__":
    job = json.loads(sys.argv[-2])
    pictures = Pictures(job["width"], job["converged"], job["interpolates"])
    with Path(sys.argv[-1]).open("a", encoding="utf-8") as out:
        for wanted in job["values"]:
            print(json.dumps(pictures.row(job["setting"], wanted, job["most"])), file=out, flush=True)
