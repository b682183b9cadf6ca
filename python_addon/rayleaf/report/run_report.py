"""Makes the report; `rayleaf report` starts it outside Blender.

    python3 -m rayleaf.report.run_report [FILE.blend ...] [--quick] [-o FOLDER] --root PROJECT --blender BLENDER

Writes FOLDER/report.html, and the same figures as report.json and frontier.csv.
"""

import argparse
import csv
import json
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from . import gallery, machine, page, plots, points, silhouettes
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


FULL = Extent(240, (1, 4, 16, 64), 1024, (0.02, 0.005, 0.00125), 3, 64, (1, 2, 4, 8, 16, 32, 64))
QUICK = Extent(64, (1, 4), 64, (0.005,), 1, 4, (1, 4))


def tried_points(extent: Extent) -> list[Point]:
    """All sweeps over one scene."""
    middle = extent.counts[len(extent.counts) // 2]
    return [
        *points.samples(list(extent.counts)),
        *points.interpolation(list(extent.errors), middle),
        *points.values("Tessellation factor", "rayleaf.tessellation_factor", [0.5, 1.0, 2.0, 4.0], middle, exact=0.5),
        *points.values("Geometry cache, MB", "rayleaf.geometry_cache", [1.0, 30.0], middle, exact=30.0),
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


def run_benchmark(root: Path, case: str, folder: Path, quick: bool) -> tuple[str, list[dict[str, Any]]]:
    """A benchmark's printed tables and its single measurements."""
    result = folder / f"bench_{case}.json"
    command = [sys.executable, str(root / "tests" / "bench" / "run_benchmarks.py"), case, "--json", str(result)]
    done = subprocess.run(command + (["--quick"] if quick else []), capture_output=True, text=True, check=False)
    if done.returncode != 0:
        return done.stdout + done.stderr, []
    rows: list[dict[str, Any]] = json.loads(result.read_text(encoding="utf-8"))["cases"].get(case, [])
    return done.stdout, rows


def benchmark_section(case: str, printed: str, tables: tuple[SourceTable, ...]) -> str:
    """Ours, then the sources'."""
    ours = f"<div class=wide><pre>{page.text(printed)}</pre></div>"
    return page.section(f"Benchmark: {case}", page.section("Ours", ours, level=3), *map(source_table, tables))


def write_csv(path: Path, found: dict[str, Measurement]) -> None:
    """All points of all scenes."""
    rows = [{"scene": name, **m.as_row()} for name, measurement in found.items() for m in measurement.measured]
    head = list(dict.fromkeys(key for row in rows for key in row))
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, head)
        writer.writeheader()
        writer.writerows(rows)


def introduction(described: dict[str, str], extent: Extent) -> str:
    """What the figures are and what they depend on."""
    words = (
        f"Pictures {extent.width} pixels wide. Times are of whole frames, export included: the median of {extent.repeats}. "
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
    parts = [introduction(described, extent)]
    references = [points.reference(engine, extent.reference_count) for engine in ("RAYLEAF", "CYCLES")]
    for file in files:
        sys.stderr.write(f"rayleaf: report: {file.name}\n")
        measurement = measure(options.blender, file, tried_points(extent), references, extent.width, extent.repeats)
        found[file.stem] = measurement
        pictures = gallery.scene_pictures(options.blender, file, extent.width, extent.gallery_samples)
        parts.append(scene_section(file, measurement, pictures))
    parts.append(silhouettes.section(options.blender, extent.width, extent.resolutions))
    benchmarks: dict[str, list[dict[str, Any]]] = {}
    for case, tables in BY_BENCHMARK.items() if not options.file else ():
        sys.stderr.write(f"rayleaf: report: benchmark {case}\n")
        printed, benchmarks[case] = run_benchmark(options.root, case, folder, options.quick)
        parts.append(benchmark_section(case, printed, tables))
    (folder / "report.html").write_text(page.page("Rayleaf: error against run time", *parts), encoding="utf-8")
    write_csv(folder / "frontier.csv", found)
    plain = {
        "machine": described,
        "scenes": {name: [m.as_row() for m in each.measured] for name, each in found.items()},
        "benchmarks": benchmarks,
    }
    (folder / "report.json").write_text(json.dumps(plain, indent=2) + "\n", encoding="utf-8")
    sys.stderr.write(f"rayleaf: report: {folder / 'report.html'}\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
