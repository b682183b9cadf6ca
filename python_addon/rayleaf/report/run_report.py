"""Makes the report; `rayleaf report` starts it outside Blender.

    python3 -m rayleaf.report.run_report [FILE.blend ...] [--quick] [-o FOLDER] --root PROJECT --blender BLENDER

Writes FOLDER/report.html, and the same figures as report.json and frontier.csv.
"""

import argparse
import csv
import json
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

from . import (
    curve_primitives,
    gallery,
    machine,
    page,
    plots,
    points,
    silhouettes,
    source_curves,
    source_pictures,
    stability,
)
from .measure import Measurement, measure
from .points import Point
from .source_figures import BY_BENCHMARK, SourceTable


@dataclass(frozen=True)
class Extent:
    """How much is measured."""

    width: int  # of pictures, pixels
    counts: tuple[int, ...]  # samples
    reference_count: int
    errors: tuple[float, ...]  # of ray interpolation
    repeats: int
    gallery_samples: int
    resolutions: tuple[int, ...]  # Resolution U/V of Blender's mesh, for silhouettes
    primitive_count: int  # samples, of the comparison of primitives
    bench_size: str  # how `rayleaf bench` is told


FULL = Extent(128, (1, 4, 16, 64), 256, (0.02, 0.005, 0.00125), 3, 16, (1, 2, 4, 8, 16, 32, 64), 16, "--small")
QUICK = Extent(64, (1, 4), 64, (0.005,), 1, 4, (1, 4), 1, "--quick")


def tried_points(extent: Extent) -> list[Point]:
    """All sweeps over one scene."""
    middle = extent.counts[len(extent.counts) // 2]
    return [
        *points.samples(list(extent.counts)),
        *points.interpolation(list(extent.errors), middle),
        *points.values("Tessellation factor", "rayleaf.tessellation_factor", [0.5, 1.0, 2.0, 4.0], middle, exact=0.5),
        *points.values("Geometry cache, MB", "rayleaf.geometry_cache_size", [1.0, 30.0], middle, exact=30.0),
        *points.cycles(list(extent.counts)),
    ]


def measured_table(measurement: Measurement) -> str:
    """One row a point."""
    head = ("setting", "engine", "seconds", "from", "to", "MB", "mean RGB", "RMSE", "99 %", "largest", "SSIM",
            "shortcut alone, mean RGB", "beaten by")  # fmt: skip
    rows = [
        (m.point.name, m.point.engine.title(), m.time, min(m.seconds), max(m.seconds), m.memory_mb, m.error.mean_rgb,
         m.error.rmse, m.error.p99, m.error.maximum, m.error.ssim,
         m.shortcut.mean_rgb if m.shortcut else None, m.beaten_by or None)
        for m in measurement.measured
    ]  # fmt: skip
    return page.table(head, rows, (bool(m.beaten_by) for m in measurement.measured))


def scene_section(file: Path, measurement: Measurement, pictures: str) -> str:
    """What one file gave."""
    own = [each for each in measurement.measured if each.point.engine == "RAYLEAF"]
    parts = [
        page.plot(plots.frontier(measurement.measured), "Hollow: something of the same engine is faster and closer."),
        measured_table(measurement),
        *(page.paragraph(f"Not in this version: {problem}", "note") for problem in measurement.problems),
        page.pictures(
            *(
                page.picture(pixels, f"{engine.title()}, converged")
                for engine, pixels in measurement.references.items()
            ),
            *([page.picture(own[0].picture, own[0].point.name)] if own else []),
        ),
        page.section("Passes", pictures, level=3),
    ]
    return page.section(file.stem, *parts)


def source_table(table: SourceTable) -> str:
    """A source's figures as printed."""
    return page.section(table.title, page.table(table.head, table.rows), page.paragraph(table.remark, "note"), level=3)


def run_benchmark(root: Path, case: str, folder: Path, size: str) -> tuple[str, list[dict[str, Any]]]:
    """A benchmark's printed tables and its single measurements."""
    result = folder / f"bench_{case}.json"
    command = [sys.executable, str(root / "tests" / "bench" / "run_benchmarks.py"), case, size, "--json", str(result)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        return done.stdout + done.stderr, []
    rows: list[dict[str, Any]] = json.loads(result.read_text(encoding="utf-8"))["cases"].get(case, [])
    return done.stdout, rows


def benchmark_section(root: Path, case: str, folder: Path, size: str, plain: dict[str, Any]) -> str:
    """Ours, then the sources'. Adds the single measurements to `plain`."""
    printed, rows = run_benchmark(root, case, folder, size)
    plain["benchmarks"][case] = rows
    ours = f"<div class=wide><pre>{page.text(printed)}</pre></div>"
    theirs = map(source_table, BY_BENCHMARK[case])
    return page.section(f"Benchmark: {case}", page.section("Ours", ours, level=3), source_curves.figures(rows), *theirs)


def stability_section(root: Path, folder: Path, quick: bool, plain: dict[str, Any]) -> str:
    """What the tests of stability measure. Adds it to `plain`."""
    lines, summary = stability.measure(root, folder, quick)
    plain["stability"] = lines
    return stability.section(lines, summary)


def file_section(options: argparse.Namespace, extent: Extent, file: Path, found: dict[str, Measurement]) -> str:
    """One scene: measured, and its gallery. Adds the measurement to `found`."""
    references = [points.reference(engine, extent.reference_count) for engine in ("RAYLEAF", "CYCLES")]
    measurement = measure(options.blender, file, tried_points(extent), references, extent.width, extent.repeats)
    found[file.stem] = measurement
    pictures = gallery.scene_pictures(options.blender, file, extent.width, extent.gallery_samples)
    return scene_section(file, measurement, pictures)


def guarded(title: str, make: Callable[[], str]) -> str:
    """A part of the report, or why it could not be made: the other parts took their time and are kept."""
    sys.stderr.write(f"rayleaf: report: {title}\n")
    try:
        return make()
    except (RuntimeError, OSError, ValueError) as error:
        sys.stderr.write(f"rayleaf: report: {title} failed: {error}\n")
        return page.section(title, page.paragraph(f"Failed: {error}", "note"))


def write_csv(path: Path, found: dict[str, Measurement]) -> None:
    """All points of all scenes."""
    rows = [{"scene": name, **m.as_row()} for name, measurement in found.items() for m in measurement.measured]
    head = list(dict.fromkeys(key for row in rows for key in row))
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, head)
        writer.writeheader()
        writer.writerows(rows)


@dataclass
class Report:
    """The page as far as it is made, and its figures."""

    folder: Path
    introduction: str
    plain: dict[str, Any]  # what report.json holds beside the scenes
    found: dict[str, Measurement] = field(default_factory=dict)
    parts: list[str] = field(default_factory=list)
    seconds: dict[str, float] = field(default_factory=dict)  # that each part took

    def add(self, title: str, make: Callable[[], str]) -> None:
        """One part more. What is done is on disk, whatever happens next."""
        began = time.monotonic()
        self.parts.append(guarded(title, make))
        self.seconds[title] = time.monotonic() - began
        self.write()

    def duration(self) -> str:
        """How long the parts took."""
        rows = [*self.seconds.items(), ("together", sum(self.seconds.values()))]
        return page.section("How long this report took", page.table(("part", "seconds"), rows))

    def write(self) -> None:
        """The page, and its figures as CSV and JSON."""
        html = page.page("Rayleaf: error against run time", self.introduction, *self.parts, self.duration())
        (self.folder / "report.html").write_text(html, encoding="utf-8")
        write_csv(self.folder / "frontier.csv", self.found)
        scenes = {name: [m.as_row() for m in each.measured] for name, each in self.found.items()}
        text = json.dumps({**self.plain, "seconds": self.seconds, "scenes": scenes}, indent=2) + "\n"
        (self.folder / "report.json").write_text(text, encoding="utf-8")


def introduction(described: dict[str, str], extent: Extent) -> str:
    """What the figures are and what they depend on."""
    words = (
        f"Pictures {extent.width} pixels wide. Times are of whole frames, export included: the median of up to {extent.repeats}. "
        f"Errors are against the same engine with {extent.reference_count} samples and other random numbers, in display RGB "
        "clipped to [0, 1]: mean and largest Euclidean distance, root mean square, 99th percentile, SSIM. "
        "'Shortcut alone' compares with equal random numbers without the shortcut, so no noise is in it. "
        "MB is the peak of the process above what it used before."
    )
    return page.paragraph(words) + page.table(("", ""), list(described.items()))


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="rayleaf report")
    parser.add_argument("file", nargs="*", type=Path, help="scenes; default: all of blend_scenes")
    parser.add_argument("--quick", action="store_true", help="tiny pictures, one repeat: to see that it works")
    parser.add_argument("-o", "--output", type=Path, default=Path("out/report"))
    parser.add_argument("--root", type=Path, required=True, help=argparse.SUPPRESS)
    parser.add_argument("--blender", required=True, help=argparse.SUPPRESS)
    return parser.parse_args()


def add_project(report: Report, options: argparse.Namespace, extent: Extent) -> None:
    """What is about Rayleaf and not about a file: the sources' pictures, outlines, benchmarks, stability."""
    blender, scenes, folder = options.blender, options.root / "blend_scenes", options.output
    report.add(
        "The sources' pictures",
        partial(source_pictures.section, blender, scenes, extent.width, extent.counts[1]),
    )
    report.add("Outlines", partial(silhouettes.section, blender, extent.width, extent.resolutions))
    report.add("Primitives", partial(curve_primitives.section, extent.width, extent.primitive_count, extent.repeats))
    for case in BY_BENCHMARK:
        make = partial(benchmark_section, options.root, case, folder, extent.bench_size, report.plain)
        report.add(f"Benchmark {case}", make)
    report.add("Stability", partial(stability_section, options.root, folder, options.quick, report.plain))


def main() -> int:
    options = arguments()
    extent = QUICK if options.quick else FULL
    options.output.mkdir(parents=True, exist_ok=True)
    described = machine.describe(options.root, options.blender)
    plain: dict[str, Any] = {"machine": described, "benchmarks": {}}
    report = Report(options.output, introduction(described, extent), plain)
    for file in options.file or sorted((options.root / "blend_scenes").glob("*.blend")):
        report.add(file.stem, partial(file_section, options, extent, file, report.found))
    if not options.file:
        add_project(report, options, extent)
    sys.stderr.write(f"rayleaf: report: {options.output / 'report.html'}\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
