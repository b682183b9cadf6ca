"""Makes the report; `rayleaf report` starts it outside Blender.

    python3 -m rayleaf.report.run_report [FILE.blend ...] [--quick] [-o FOLDER] --root PROJECT --blender BLENDER

Writes FOLDER/report.html, and the same figures as report.json and frontier.csv.
"""

import argparse
import csv
import json
import subprocess
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
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


# For all scenes, about 40 minutes on two quiet cores.
FULL = Extent(160, (1, 4, 16, 64), 512, (0.02, 0.005, 0.00125), 3, 16, (1, 2, 4, 8, 16, 32, 64))
QUICK = Extent(64, (1, 4), 64, (0.005,), 1, 4, (1, 4))


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


def benchmark_section(case: str, printed: str, rows: list[dict[str, Any]], tables: tuple[SourceTable, ...]) -> str:
    """Ours, then the sources'."""
    ours = f"<div class=wide><pre>{page.text(printed)}</pre></div>"
    drawn = source_curves.figures(rows)
    return page.section(f"Benchmark: {case}", page.section("Ours", ours, level=3), drawn, *map(source_table, tables))


def guarded(title: str, make: Callable[[], str]) -> str:
    """A part of the report, or why it could not be made: the other parts took their time and are kept."""
    sys.stderr.write(f"rayleaf: report: {title}\n")
    try:
        return make()
    except (RuntimeError, OSError, ValueError) as error:
        sys.stderr.write(f"rayleaf: report: {title} failed: {error}\n")
        return page.section(title, page.paragraph(f"Failed: {error}", "note"))


def project_sections(options: argparse.Namespace, extent: Extent, plain: dict[str, Any]) -> Iterator[str]:
    """What is about Rayleaf and not about a file: the sources' pictures, outlines, benchmarks, stability. Adds its
    figures to `plain`."""
    scenes, blender = options.root / "blend_scenes", options.blender
    yield guarded(
        "The sources' pictures", lambda: source_pictures.section(blender, scenes, extent.width, extent.counts[1])
    )
    yield guarded("Outlines", lambda: silhouettes.section(blender, extent.width, extent.resolutions))
    samples, repeats = extent.counts[-1] // 4, extent.repeats
    yield guarded("Primitives", lambda: curve_primitives.section(extent.width, samples, repeats))
    for case, tables in BY_BENCHMARK.items():
        sys.stderr.write(f"rayleaf: report: benchmark {case}\n")
        printed, rows = run_benchmark(options.root, case, options.output, "--quick" if options.quick else "--small")
        plain["benchmarks"][case] = rows
        yield benchmark_section(case, printed, rows, tables)
    sys.stderr.write("rayleaf: report: stability\n")
    lines, summary = stability.measure(options.root, options.output, options.quick)
    plain["stability"] = lines
    yield stability.section(lines, summary)


def file_section(options: argparse.Namespace, extent: Extent, file: Path, found: dict[str, Measurement]) -> str:
    """One scene: measured, and its gallery. Adds the measurement to `found`."""
    references = [points.reference(engine, extent.reference_count) for engine in ("RAYLEAF", "CYCLES")]
    measurement = measure(options.blender, file, tried_points(extent), references, extent.width, extent.repeats)
    found[file.stem] = measurement
    pictures = gallery.scene_pictures(options.blender, file, extent.width, extent.gallery_samples)
    return scene_section(file, measurement, pictures)


def write_csv(path: Path, found: dict[str, Measurement]) -> None:
    """All points of all scenes."""
    rows = [{"scene": name, **m.as_row()} for name, measurement in found.items() for m in measurement.measured]
    head = list(dict.fromkeys(key for row in rows for key in row))
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, head)
        writer.writeheader()
        writer.writerows(rows)


def write_report(folder: Path, parts: list[str], found: dict[str, Measurement], plain: dict[str, Any]) -> None:
    """The page, and its figures as CSV and JSON."""
    (folder / "report.html").write_text(page.page("Rayleaf: error against run time", *parts), encoding="utf-8")
    write_csv(folder / "frontier.csv", found)
    scenes = {name: [m.as_row() for m in each.measured] for name, each in found.items()}
    text = json.dumps({**plain, "scenes": scenes}, indent=2) + "\n"
    (folder / "report.json").write_text(text, encoding="utf-8")


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


def main() -> int:
    options = arguments()
    extent = QUICK if options.quick else FULL
    folder: Path = options.output
    folder.mkdir(parents=True, exist_ok=True)
    described = machine.describe(options.root, options.blender)
    files = options.file or sorted((options.root / "blend_scenes").glob("*.blend"))
    found: dict[str, Measurement] = {}
    plain: dict[str, Any] = {"machine": described, "benchmarks": {}}
    parts = [introduction(described, extent)]

    def add(part: str) -> None:
        """What is done is on disk, whatever happens next."""
        parts.append(part)
        write_report(folder, parts, found, plain)

    for file in files:
        add(guarded(file.stem, lambda file=file: file_section(options, extent, file, found)))  # type: ignore[misc]
    if not options.file:
        for part in project_sections(options, extent, plain):
            add(part)
    sys.stderr.write(f"rayleaf: report: {folder / 'report.html'}\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
