"""Renders a file's points in a Blender of its own and judges the pictures. Knows no bpy: the add-on's button and
`rayleaf report` both start here."""

import json
import subprocess
import tempfile
from dataclasses import asdict, dataclass
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np

from .errors import PictureError, compare
from .frontier import Cost, dominated
from .points import Point

_UNKNOWN_SPREAD = 0.1  # of a time that was measured once
RENDER_POINTS = Path(__file__).with_name("render_points.py")


@dataclass(frozen=True)
class Conditions:
    """What all points of a job have in common."""

    width: int | None = None  # of pictures, pixels; None: `percentage` of what the file says
    percentage: int = 100  # of the file's resolution, without `width`
    repeats: int = 1  # renders of each point
    threads: int | None = None  # None: as the file says
    # Frames of an animation in which the camera turns about the world's z axis by a degree a frame; 0: none. It takes
    # the place of repeats; without repeats its last frame is rendered alone.
    orbit: int = 0
    all_passes: bool = False
    cold: bool = (
        False  # no picture before the first, so that it pays for what an engine does once; every repeat is made
    )


@dataclass
class Measured:
    """A point, rendered and judged."""

    point: Point
    seconds: list[float]
    memory_mb: float
    error: PictureError  # against the engine's converged picture: noise and shortcuts together
    shortcut: PictureError | None  # against the same random numbers without the shortcut
    statistics: dict[str, Any]
    picture: Any  # (height, width, 4)
    beaten_by: str = ""  # name of a point that is faster and closer; empty: on the frontier

    @property
    def time(self) -> float:
        """Median of the repeats, seconds."""
        return median(self.seconds)

    @property
    def cost(self) -> Cost:
        """What the frontier looks at. Of one run alone nobody knows the spread: a tenth up and down is assumed."""
        spread = _UNKNOWN_SPREAD if len(self.seconds) == 1 else 0.0
        return Cost((1 - spread) * min(self.seconds), (1 + spread) * max(self.seconds), self.error.rmse)

    def as_row(self) -> dict[str, Any]:
        """Plain numbers for CSV and JSON."""
        return {
            "series": self.point.series,
            "setting": self.point.label,
            "engine": self.point.engine,
            "seconds": self.time,
            "seconds_least": min(self.seconds),
            "seconds_most": max(self.seconds),
            "repeats": len(self.seconds),
            "memory_mb": self.memory_mb,
            **self.error.as_dict(),
            **{f"shortcut_{key}": value for key, value in (self.shortcut.as_dict() if self.shortcut else {}).items()},
            "dominated_by": self.beaten_by,
        }


@dataclass
class Measurement:
    """All points of a file that could be rendered."""

    references: dict[str, Any]  # by engine
    measured: list[Measured]
    problems: list[str]  # one line for each point that this version cannot render


def blender_command(blender: str, file: Path, job: Path, result: Path, addon: str = "rayleaf") -> list[str]:
    """How a Blender renders a job. The add-on is found as the calling environment shows it."""
    return [
        *(blender, "--background", "--factory-startup", "--python-exit-code", "1", "--addons", addon, str(file)),
        *("--python", str(RENDER_POINTS), "--", str(job), str(result)),
    ]


def write_job(folder: Path, points: list[Point], conditions: Conditions, addon: str = "rayleaf") -> tuple[Path, Path]:
    """The files that `blender_command` names: the job, written, and where its result will be."""
    job = {
        **asdict(conditions),
        "folder": str(folder),
        "addon": addon,
        "points": [point.as_job() for point in points],
    }
    job_path, result_path = folder / "job.json", folder / "result.json"
    job_path.write_text(json.dumps(job), encoding="utf-8")
    return job_path, result_path


def render(blender: str, file: Path, points: list[Point], conditions: Conditions, folder: Path) -> list[Any]:
    """The raw results of `render_points`. Raises RuntimeError with Blender's last lines if it fails."""
    job, result = write_job(folder, points, conditions)
    done = subprocess.run(blender_command(blender, file, job, result), capture_output=True, text=True, check=False)
    if done.returncode != 0 or not result.exists():
        last = "\n".join((done.stdout + done.stderr).splitlines()[-15:])
        raise RuntimeError(f"{file.name}: Blender ended with {done.returncode}:\n{last}")
    return list(json.loads(result.read_text(encoding="utf-8")))


def judge(results: list[Any], points: list[Point], references: list[Point]) -> Measurement:
    """Errors and frontier of rendered points; `results` holds points and references in this order."""
    pictures = {raw["name"]: np.load(raw["picture"]) for raw in results if "picture" in raw}
    problems = [f"{raw['name']}: {raw['problem']}" for raw in results if "problem" in raw]
    by_engine = {each.engine: pictures[each.name] for each in references if each.name in pictures}
    measured = []
    for point, raw in zip(points, results, strict=False):
        if point.name not in pictures or point.engine not in by_engine:
            continue
        exact = pictures.get(f"{point.series}: {point.same_noise_as}") if point.same_noise_as else None
        measured.append(
            Measured(
                point=point,
                seconds=raw["seconds"],
                memory_mb=raw["memory_mb"],
                error=compare(pictures[point.name], by_engine[point.engine]),
                shortcut=None if exact is None else compare(pictures[point.name], exact),
                statistics=raw["statistics"],
                picture=pictures[point.name],
            )
        )
    mark_dominated(measured)
    return Measurement(by_engine, measured, problems)


def mark_dominated(measured: list[Measured]) -> None:
    """Say of each point what beats it, among those of its engine."""
    for engine in {each.point.engine for each in measured}:
        own = [each for each in measured if each.point.engine == engine]
        for each, better in zip(own, dominated([each.cost for each in own]), strict=True):
            each.beaten_by = "" if better is None else own[better].point.name


def measure(
    blender: str, file: Path, points: list[Point], references: list[Point], width: int, repeats: int
) -> Measurement:
    """Render the points and, once each, the references; judge them."""
    with tempfile.TemporaryDirectory(prefix="rayleaf_report_") as name:
        folder = Path(name)
        results = render(blender, file, points, Conditions(width, repeats=repeats), folder)
        with tempfile.TemporaryDirectory(prefix="rayleaf_report_") as second:
            results += render(blender, file, references, Conditions(width), Path(second))
            return judge(results, points, references)
