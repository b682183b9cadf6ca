"""Whole frames on more and more threads: seconds, how many times faster than on one, processor time.

./rayleaf bench threads [SCENE ...]: both engines render the file on each number of threads, each time twice in a
Blender of its own; the second render counts. `alone`: as many processes as the most threads, each of one thread, render
at the same time. They share nothing but the machine, so no frame can be expected to speed up by more than they do.
"""

import argparse
import os
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rayleaf.report import points
from rayleaf.report.frame_scenes import FrameScenes
from rayleaf.report.frames import FIRST_AND_SECOND
from rayleaf.report.measure import Conditions, render
from rayleaf.report.points import Point

PRINTS_ITSELF = True
ROOT = Path(__file__).resolve().parents[2]
SCENES = ("bezier_sheet", "spline_gallery", "studio", "hair_ball")


@dataclass(frozen=True)
class Seconds:
    """Of one frame."""

    passed: float
    processor: float  # of all threads


def numbers(text: str) -> tuple[int, ...]:
    """Numbers of threads, from 1, with commas between them."""
    found = tuple(sorted(int(word) for word in text.split(",")))
    if found[0] < 1:
        raise ValueError
    return found


def doublings() -> tuple[int, ...]:
    """1, 2, 4 ... and all processors."""
    most = os.cpu_count() or 1
    return (*(1 << i for i in range(most.bit_length()) if 1 << i < most), most)


def add_options(parser: argparse.ArgumentParser) -> None:
    """What can be asked for."""
    parser.add_argument("scene", nargs="*", help=f"names, or .blend files; default: {', '.join(SCENES)}")
    parser.add_argument("--samples", type=int, default=64, help="default: %(default)s")
    parser.add_argument("--percentage", type=int, default=50, help="of the files' resolution; default: %(default)s")
    parser.add_argument("--threads", type=numbers, default=doublings(), metavar="N[,N...]", help="default: 1, 2, 4...")
    parser.add_argument("--rounds", type=int, default=1, help="in turn, the least time counts; default: %(default)s")
    parser.add_argument("--alone", action="store_true", help="measures processes of one thread, too")


def frame(file: Path, point: Point, threads: int, options: argparse.Namespace) -> Seconds:
    """The second render. Raises RuntimeError if it fails."""
    conditions = Conditions(percentage=options.percentage, threads=threads, repeats=FIRST_AND_SECOND, cold=True)
    with tempfile.TemporaryDirectory(prefix="rayleaf_threads_") as folder:
        raw = render(os.environ.get("BLENDER", "blender"), file, [point], conditions, Path(folder))[0]
    if "problem" in raw:
        raise RuntimeError(f"{file.name}: {raw['problem']}")
    return Seconds(raw["seconds"][-1], raw["processor_seconds"][-1])


def alone(file: Path, point: Point, processes: int, options: argparse.Namespace) -> Seconds:
    """The mean of frames that processes of one thread render at the same time."""
    with ThreadPoolExecutor(processes) as pool:
        found = list(pool.map(lambda _: frame(file, point, 1, options), range(processes)))
    passed, processor = (sum(values) / processes for values in zip(*((f.passed, f.processor) for f in found)))
    return Seconds(passed, processor)


def row(name: str, seconds: Seconds, speedup: float | None) -> dict[str, Any]:
    """One line of the table, printed and kept."""
    told = "" if speedup is None else f"{speedup:8.2f}"
    print(f"{name:<44} {seconds.passed:8.2f} s {seconds.processor:8.2f} s {told}", flush=True)
    return {"name": name, "unit": "s", "values": [seconds.passed], "processor": seconds.processor, "speedup": speedup}


def measured(file: Path, options: argparse.Namespace) -> list[dict[str, Any]]:
    """The rows of a scene."""
    contenders = points.contenders(options.samples, ("off",))
    best: dict[tuple[str, int], Seconds] = {}
    for _ in range(options.rounds):
        for threads in options.threads:
            for point in contenders:
                found = frame(file, point, threads, options)
                key = point.label, threads
                best[key] = min(best.get(key, found), found, key=lambda seconds: seconds.passed)
                sys.stderr.write(
                    f"rayleaf: bench threads: {file.stem}, {point.label}, {threads}: {found.passed:.2f} s\n"
                )
    rows = []
    least, most = options.threads[0], options.threads[-1]
    for point in contenders:
        first = best[point.label, least]
        for threads in options.threads:
            found = best[point.label, threads]
            speedup = first.passed / found.passed if least == 1 else None
            rows.append(row(f"{file.stem}, {point.label}, {threads}", found, speedup))
        if options.alone and least == 1:
            together = alone(file, point, most, options)
            speedup = most * first.passed / together.passed
            rows.append(row(f"{file.stem}, {point.label}, {most} alone", together, speedup))
    return rows


def run(options: argparse.Namespace, quick: bool = False) -> list[dict[str, Any]]:
    """Prints the table."""
    if quick:
        options.scene, options.samples, options.percentage = options.scene or ["bezier_sheet"], 4, 20
    scenes = FrameScenes(ROOT, os.environ.get("BLENDER", "blender"), ROOT / "out" / "frames" / "scenes")
    print(f"{'scene, engine, threads':<44} {'frame':>10} {'processor':>10} {'times faster':>12}", flush=True)
    return [row for name in options.scene or SCENES for row in measured(scenes.file(name), options)]
