"""Makes the report; `rayleaf report` starts it outside Blender.

    python3 -m rayleaf.report.run_report [FILE.blend ...] [--quick] [--only PART] [--again] [-o FOLDER]
        --root PROJECT --blender BLENDER

Writes FOLDER/report.html, and the same figures as report.json and frontier.csv. Each part is kept in FOLDER/parts once it
is made, so that a report that was stopped goes on where it was.
"""

import argparse
import csv
import json
import os
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

from . import (
    curve_primitives,
    frame_table,
    gallery,
    machine,
    node_table,
    page,
    plots,
    points,
    silhouettes,
    source_curves,
    source_pictures,
    stability,
)
from .frame_scenes import FrameScenes
from .frames import Frame, Plan, ruler
from .measure import Measurement, measure
from .parts import KeptParts, Part, mark, now, state
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
    frames: Plan  # beside Cycles
    large_frames: bool  # also of scenes that scripts make


FULL = Extent(
    *(128, (1, 4, 16, 64), 256, (0.02, 0.005, 0.00125), 3, 16, (1, 2, 4, 8, 16, 32, 64), 16, "--small"),
    *(Plan(), True),
)
QUICK = Extent(64, (1, 4), 64, (0.005,), 1, 4, (1, 4), 1, "--quick", Plan(counts=(1,), percentage=10), False)


def tried_points(extent: Extent) -> list[Point]:
    """All sweeps over one scene."""
    middle = extent.counts[len(extent.counts) // 2]
    return [
        *points.samples(list(extent.counts)),
        *points.interpolation(list(extent.errors), middle),
        *points.cached_facets(
            "Tessellation factor", "rayleaf.tessellation_factor", [0.5, 1.0, 2.0, 4.0], middle, exact=0.5
        ),
        *points.cached_facets("Geometry cache, MB", "rayleaf.geometry_cache_size", [1.0, 30.0], middle, exact=30.0),
        *(point for kind in points.PRIMITIVE_DETAIL for point in points.primitives(kind, middle)),
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


def frames_section(scenes: dict[str, list[dict[str, Any]]], plan: Plan) -> str:
    """Whole frames beside Cycles, as far as they are measured; empty without any."""
    measured = [[Frame(**row) for row in rows] for rows in scenes.values()]
    by_count = [
        [frame for frame in frames if frame.samples == count] for frames in measured for count in plan.counts if frames
    ]
    rows = [row for frames in by_count for row in frame_table.rows(frames)]
    remarks = dict.fromkeys(line for frames in by_count for line in frame_table.remarks(frames))
    if not rows:
        return ""
    return page.section(
        "Whole frames beside Cycles",
        page.paragraph(frame_table.caption(plan)),
        page.table(frame_table.HEAD, rows),
        *(page.paragraph(line, "note") for line in remarks),
    )


def source_table(table: SourceTable) -> str:
    """A source's figures as printed."""
    return page.section(table.title, page.table(table.head, table.rows), page.paragraph(table.remark, "note"), level=3)


def run_benchmark(root: Path, case: str, folder: Path, size: str) -> tuple[str, list[dict[str, Any]]]:
    """A benchmark's printed tables and its single measurements. Raises RuntimeError where its answers are wrong."""
    result = folder / f"bench_{case}.json"
    command = [sys.executable, str(root / "tests" / "bench" / "run_benchmarks.py"), case, size, "--json", str(result)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise RuntimeError("\n".join((done.stdout + done.stderr).splitlines()[-15:]))
    rows: list[dict[str, Any]] = json.loads(result.read_text(encoding="utf-8"))["cases"].get(case, [])
    return done.stdout, rows


def benchmark_part(root: Path, case: str, folder: Path, size: str) -> Part:
    """Ours, then the sources'."""
    printed, rows = run_benchmark(root, case, folder, size)
    ours = f"<div class=wide><pre>{page.text(printed)}</pre></div>"
    theirs = map(source_table, BY_BENCHMARK[case])
    html = page.section(f"Benchmark: {case}", page.section("Ours", ours, level=3), source_curves.figures(rows), *theirs)
    return Part(html, {"benchmarks": {case: rows}})


def stability_part(root: Path, folder: Path, quick: bool) -> Part:
    """What the tests of stability measure."""
    lines, summary = stability.measure(root, folder, quick)
    return Part(stability.section(lines, summary), {"stability": {"summary": summary, "checks": lines}})


def nodes_part(root: Path, folder: Path, blender: str, quick: bool) -> Part:
    """What the oracles of nodes measure."""
    lines, summary = node_table.measure(root, folder, blender, quick)
    return Part(node_table.section(lines, summary), {"nodes": {"summary": summary, "cases": lines}})


def frames_part(options: argparse.Namespace, extent: Extent, scenes: FrameScenes, name: str) -> Part:
    """One scene's lines of the first table; that stands above all parts."""
    by = ruler(options.blender, extent.frames, options.output / "converged", lambda line: None, options.again)
    rows = [asdict(frame) for frames in by.scene(scenes.file(name)) for frame in frames]
    return Part("", {"frames": {Path(name).stem: rows}})


def file_part(options: argparse.Namespace, extent: Extent, file: Path) -> Part:
    """One scene: measured, and its gallery."""
    references = [points.reference(engine, extent.reference_count) for engine in ("RAYLEAF", "CYCLES")]
    measurement = measure(options.blender, file, tried_points(extent), references, extent.width, extent.repeats)
    pictures = gallery.scene_pictures(options.blender, file, extent.width, extent.gallery_samples)
    rows = [each.as_row() for each in measurement.measured]
    return Part(scene_section(file, measurement, pictures), {"scenes": {file.stem: rows}})


def write_csv(path: Path, scenes: dict[str, list[dict[str, Any]]]) -> None:
    """All points of all scenes."""
    rows = [{"scene": name, **row} for name, points_of_scene in scenes.items() for row in points_of_scene]
    head = list(dict.fromkeys(key for row in rows for key in row))
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, head)
        writer.writeheader()
        writer.writerows(rows)


@dataclass(frozen=True)
class Planned:
    """A part to make."""

    title: str
    make: Callable[[], Part]
    depends_on: Path | None = None  # a file, beside what all parts depend on


@dataclass
class Report:
    """The page as far as it is made, and its figures."""

    folder: Path
    introduction: str
    described: dict[str, str]  # the machine
    circumstances: str | None  # what all parts depend on; None: nobody knows, so nothing is kept
    only: list[str] = field(default_factory=list)  # anchors of parts to make, again if they are there; empty: all
    again: bool = False  # nothing that was kept is taken
    plan: Plan = field(default_factory=Plan)  # of whole frames
    parts: dict[str, Part] = field(default_factory=dict)
    failed: dict[str, str] = field(default_factory=dict)  # title -> why

    def add(self, planned: Planned) -> None:
        """One part more. What is done is on disk, whatever happens next."""
        name, kept = page.anchor(planned.title), KeptParts(self.folder)
        circumstances = mark(self.circumstances, planned.title, planned.depends_on)
        wanted = not self.only or name in self.only
        part = None
        if self.circumstances is not None and not (wanted and (self.again or self.only)):
            part = kept.find(name, circumstances)
        if part is None and wanted:
            part = self.made(planned)
            if part is not None and self.circumstances is not None:
                kept.keep(name, circumstances, part)
        if part is not None:
            self.parts[planned.title] = part
        self.write()

    def made(self, planned: Planned) -> Part | None:
        """A part; None if it could not be made: the other parts took their time and are kept."""
        sys.stderr.write(f"rayleaf: report: {planned.title}\n")
        load, began = os.getloadavg()[0], time.monotonic()
        try:
            part = planned.make()
        except (RuntimeError, OSError, ValueError) as error:
            sys.stderr.write(f"rayleaf: report: {planned.title} failed: {error}\n")
            self.failed[planned.title] = str(error)
            return None
        part.seconds, part.made, part.load = time.monotonic() - began, now(), load
        return part

    def duration(self) -> str:
        """How long the parts took, and when."""
        rows: list[tuple[Any, ...]] = [
            (title, part.seconds, part.load, part.made) for title, part in self.parts.items()
        ]
        rows.append(("together", sum(part.seconds for part in self.parts.values()), None, None))
        return page.section("How long this report took", page.table(("part", "seconds", "load before", "made"), rows))

    def figures(self, kind: str) -> dict[str, Any]:
        """Of one kind, of all parts."""
        return {name: rows for part in self.parts.values() for name, rows in part.figures.get(kind, {}).items()}

    def write(self) -> None:
        """The page, and its figures as CSV and JSON."""
        broken = [page.section(title, page.paragraph(f"Failed: {why}", "note")) for title, why in self.failed.items()]
        made = (part.html for part in self.parts.values())
        frames = self.figures("frames")
        first = frames_section(frames, self.plan)
        html = page.page("Rayleaf: error against run time", self.introduction, first, *made, *broken, self.duration())
        (self.folder / "report.html").write_text(html, encoding="utf-8")
        scenes = self.figures("scenes")
        write_csv(self.folder / "frontier.csv", scenes)
        plain = {
            "machine": self.described,
            "seconds": {title: part.seconds for title, part in self.parts.items()},
            "benchmarks": self.figures("benchmarks"),
            "stability": self.figures("stability"),
            "nodes": self.figures("nodes"),
            "frames": frames,
            "scenes": scenes,
        }
        (self.folder / "report.json").write_text(json.dumps(plain, indent=2) + "\n", encoding="utf-8")


def introduction(described: dict[str, str], extent: Extent) -> str:
    """What the figures are and what they depend on."""
    words = (
        f"Of whole frames the table says what they are. All else: pictures {extent.width} pixels wide, times of whole "
        f"frames, export included, the median of up to {extent.repeats}. Errors are against the same engine with "
        f"{extent.reference_count} samples and other random numbers, in display RGB "
        "clipped to [0, 1]: mean and largest Euclidean distance, root mean square, 99th percentile, SSIM. "
        "'Shortcut alone' compares with equal random numbers without the shortcut, so no noise is in it. "
        "MB is the peak of the process above what it used before."
    )
    return page.paragraph(words) + page.table(("", ""), list(described.items()))


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="rayleaf report")
    parser.add_argument("file", nargs="*", type=Path, help="scenes; default: all of blend_scenes")
    parser.add_argument("--quick", action="store_true", help="tiny pictures, one repeat: to see that it works")
    parser.add_argument("--only", action="append", default=[], metavar="PART", help="makes that part alone, again")
    parser.add_argument("--again", action="store_true", help="makes parts again that are there")
    parser.add_argument("-o", "--output", type=Path, default=Path("out/report"))
    parser.add_argument("--root", type=Path, required=True, help=argparse.SUPPRESS)
    parser.add_argument("--blender", required=True, help=argparse.SUPPRESS)
    return parser.parse_args()


def planned_frames(options: argparse.Namespace, extent: Extent) -> list[Planned]:
    """Whole frames beside Cycles: of the files that were named, else of all scenes."""
    scenes = FrameScenes(options.root, options.blender, options.output / "scenes")
    names = [str(file) for file in options.file] or scenes.names(with_large=extent.large_frames)
    return [
        Planned(f"Frames: {Path(name).stem}", partial(frames_part, options, extent, scenes, name), scenes.source(name))
        for name in names
    ]


def planned_parts(options: argparse.Namespace, extent: Extent) -> list[Planned]:
    """The scenes; without files, also what is about Rayleaf and not about a file: the sources' pictures, outlines,
    benchmarks, stability, nodes."""
    blender, scenes, folder = options.blender, options.root / "blend_scenes", options.output
    files = options.file or sorted(scenes.glob("*.blend"))
    found = planned_frames(options, extent)
    found += [Planned(file.stem, partial(file_part, options, extent, file), file) for file in files]
    if options.file:
        return found
    width, repeats = extent.width, extent.repeats
    own: dict[str, Callable[[], str]] = {
        "The sources' pictures": lambda: source_pictures.section(blender, scenes, width, extent.counts[1]),
        "Outlines": lambda: silhouettes.section(blender, width, extent.resolutions),
        "Primitives": lambda: curve_primitives.section(width, extent.primitive_count, repeats),
    }
    found += [Planned(title, partial(lambda section: Part(section()), section)) for title, section in own.items()]
    for case in BY_BENCHMARK:
        make = partial(benchmark_part, options.root, case, folder, extent.bench_size)
        found.append(Planned(f"Benchmark {case}", make))
    found.append(Planned("Stability", partial(stability_part, options.root, folder, options.quick)))
    found.append(Planned("Nodes", partial(nodes_part, options.root, folder, blender, options.quick)))
    return found


def circumstances(root: Path, described: dict[str, str], extent: Extent) -> str | None:
    """What every part's figures depend on: sources, machine, Blender, extent."""
    sources = state(root)
    machine_alone = {key: value for key, value in described.items() if key not in ("load before", "commit")}
    return None if sources is None else mark(sources, machine_alone, asdict(extent))


def main() -> int:
    options = arguments()
    extent = QUICK if options.quick else FULL
    options.output.mkdir(parents=True, exist_ok=True)
    described = machine.describe(options.root, options.blender)
    same = circumstances(options.root, described, extent)
    planned = planned_parts(options, extent)
    names = [page.anchor(each.title) for each in planned]
    only = [page.anchor(name) for name in options.only]
    if unknown := [name for name in only if name not in names]:
        sys.stderr.write(f"rayleaf: report: there is no part {', '.join(unknown)}; there are: {', '.join(names)}\n")
        return 2
    report = Report(
        options.output, introduction(described, extent), described, same, only, options.again, extent.frames
    )
    for each in planned:
        report.add(each)
    sys.stderr.write(f"rayleaf: report: {options.output / 'report.html'}\n")
    return 1 if report.failed else 0


if __name__ == "__main__":
    sys.exit(main())
