"""Whole frames beside Cycles: the same file at the same samples, size and threads, rendered by both engines in turn.

Each frame is rendered twice in a Blender of its own: first, when nothing is loaded or kept, and again. Or the camera
turns by a degree a frame, and the second is the last one. What is measured is what an artist waits for: all of F12.
"""

import os
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from . import points
from .converged import ConvergedPictures
from .errors import compare
from .measure import Conditions, render
from .points import Point

FIRST_AND_SECOND = 2  # renders in one Blender
# So many samples more than the most that is measured. A reference with n times the samples adds 1/n to the squared
# error of either engine: the quotient of their errors does not see it.
_CONVERGED_FACTOR = 4


@dataclass(frozen=True)
class Plan:
    """What is measured of each scene."""

    counts: tuple[int, ...] = (16, 256)  # samples
    percentage: int = 50  # of the file's resolution
    threads: int = os.cpu_count() or 1
    rounds: int = 1  # the engines take turns so often; the least time counts
    modes: tuple[str, ...] = points.INTERPOLATION_MODES  # of Rayleaf
    orbit: int = 0  # frames of an animation, of which the first and the last are measured; 0: the same picture twice
    processor_time: bool = False  # of all threads, in place of the time that passes: for a machine that is busy
    converged: int = 0  # samples of the pictures that errors are against; 0: by the most samples measured

    @property
    def converged_count(self) -> int:
        return self.converged or _CONVERGED_FACTOR * max(self.counts)


@dataclass
class Frame:
    """One scene at one number of samples in one engine."""

    scene: str
    samples: int
    contender: str
    engine: str
    first: list[float] = field(default_factory=list)  # seconds, each round
    second: list[float] = field(default_factory=list)  # of an orbit: its last frame
    memory_mb: float = 0.0  # most that the process held above what it held before
    rmse: float | None = None  # in display RGB, against the engine's own converged picture
    from_cycles: float | None = None  # the same measure, of the two engines' converged pictures
    size: tuple[int, int] = (0, 0)  # width, height, pixels
    told: dict[str, Any] = field(default_factory=dict)  # settings as they were when it was rendered
    problem: str = ""  # why there is nothing else

    @property
    def name(self) -> str:
        return f"{self.scene}, {points.counted(self.samples)}, {self.contender}"

    def add(self, raw: dict[str, Any], seconds: list[float], picture: Any) -> None:
        """What one round gave."""
        first, *_, second = seconds
        self.first.append(first)
        self.second.append(second)
        self.memory_mb = max(self.memory_mb, raw["memory_mb"])
        self.told, self.size = raw["told"], (picture.shape[1], picture.shape[0])


def check_alike(frames: list[Frame]) -> None:
    """Raises RuntimeError where frames that stand side by side were not set alike."""
    first = frames[0]
    for each in frames[1:]:
        for name in points.ALIKE:
            if each.told[name] != first.told[name]:
                raise RuntimeError(
                    f"{each.name}: {name} {each.told[name]}, but {first.told[name]} in {first.contender}"
                )
        if each.size != first.size:
            raise RuntimeError(f"{each.name}: {each.size} pixels, but {first.size} in {first.contender}")


def different_limits(frames: list[Frame]) -> list[str]:
    """The limits of the file that the two engines do not share, as `name Cycles' / Rayleaf's`."""
    told = {each.engine: each.told for each in frames if not each.problem}
    if len(told) < 2:
        return []
    cycles, own = told["CYCLES"], told["RAYLEAF"]
    return [f"{name} {cycles[name]:g} / {own[name]:g}" for name in points.LIMITS if cycles[name] != own[name]]


@dataclass
class Ruler:
    """Measures scenes."""

    blender: str
    plan: Plan
    kept: ConvergedPictures
    tell: Callable[[str], None] = lambda line: None  # what is going on

    def scene(self, file: Path) -> Iterator[list[Frame]]:
        """For each number of samples the frames that stand side by side."""
        for count in self.plan.counts:
            yield self._side_by_side(file, count)

    def _side_by_side(self, file: Path, count: int) -> list[Frame]:
        tried = points.contenders(count, self.plan.modes)
        frames = [Frame(file.stem, count, point.label, point.engine) for point in tried]
        for _ in range(self.plan.rounds):
            for frame, point in zip(frames, tried, strict=True):
                self._round(file, frame, point)
        judged = [frame for frame in frames if not frame.problem]
        check_alike(judged or frames[:1])
        if judged and judged[0].engine == "CYCLES":
            for frame in judged[1:]:
                frame.from_cycles = self._error(file, "CYCLES", self._converged(file, frame.engine))
        return frames

    def _round(self, file: Path, frame: Frame, point: Point) -> None:
        """Adds a round to a frame, or why there is none. The error comes from its last picture."""
        if frame.problem:
            return
        plan = self.plan
        conditions = replace(conditions_of(plan), repeats=FIRST_AND_SECOND)
        try:
            with tempfile.TemporaryDirectory(prefix="rayleaf_report_") as name:
                raw = render(self.blender, file, [point], conditions, Path(name))[0]
                if "problem" in raw:
                    raise RuntimeError(raw["problem"])
                picture = np.load(raw["picture"])
            frame.add(raw, raw["processor_seconds" if plan.processor_time else "seconds"], picture)
            self.tell(f"{frame.name}: {frame.first[-1]:.2f} s, {frame.second[-1]:.2f} s")
            if len(frame.second) == plan.rounds:
                frame.rmse = self._error(file, frame.engine, picture)
        except (RuntimeError, ValueError) as error:
            frame.problem = str(error)
            self.tell(f"{frame.name}: {error}")

    def _converged(self, file: Path, engine: str) -> Any:
        return self.kept.picture(file, engine, self.plan.converged_count)

    def _error(self, file: Path, engine: str, picture: Any) -> float:
        return compare(picture, self._converged(file, engine)).rmse


def conditions_of(plan: Plan) -> Conditions:
    """Of one picture."""
    return Conditions(percentage=plan.percentage, threads=plan.threads, orbit=plan.orbit, cold=True)


def ruler(blender: str, plan: Plan, folder: Path, tell: Callable[[str], None], again: bool = False) -> Ruler:
    """One whose converged pictures are in `folder`."""
    return Ruler(blender, plan, ConvergedPictures(blender, folder, conditions_of(plan), again), tell)
