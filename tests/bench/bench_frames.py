"""Whole frames beside Cycles: seconds, error, seconds at equal error, memory.

./rayleaf bench frames [SCENE ...]: every scene of blend_scenes and three larger ones, or those named; files too. The
table's caption says what is measured, rayleaf/report/frames.py how.
"""

import argparse
import os
import sys
from dataclasses import asdict
from pathlib import Path
from typing import Any

from rayleaf.report import frame_table, points
from rayleaf.report.frame_scenes import FrameScenes
from rayleaf.report.frames import Frame, Plan, Ruler, ruler

PRINTS_ITSELF = True
ROOT = Path(__file__).resolve().parents[2]
QUICK_SCENES = ("bezier_sheet", "glass_vase", "studio")
QUICK = Plan(counts=(4,), percentage=20)


def numbers(text: str) -> tuple[int, ...]:
    """Numbers from 1, with commas between them."""
    found = tuple(int(word) for word in text.split(","))
    if min(found) < 1:
        raise ValueError
    return found


def orbit(text: str) -> int:
    """Frames, at least two."""
    found = int(text)
    if found < 2:
        raise ValueError
    return found


def number(text: str) -> int:
    """One number from 1."""
    (found,) = numbers(text)
    return found


def modes(text: str) -> tuple[str, ...]:
    """Modes of ray interpolation, with commas between them."""
    found = tuple(text.split(","))
    if not set(found) <= set(points.INTERPOLATION_MODES):
        raise ValueError
    return found


def add_options(parser: argparse.ArgumentParser) -> None:
    """What can be asked for; what is not given is as `Plan` says."""
    parser.add_argument("scene", nargs="*", help="names, or .blend files; default: all")
    parser.add_argument("--samples", type=numbers, metavar="N[,N...]", help="default: 16,256")
    parser.add_argument("--percentage", type=number, help="of the files' resolution; default: 50")
    parser.add_argument("--threads", type=number, help="default: all")
    parser.add_argument("--rounds", type=number, help="in turn, the least time counts; default: 1")
    parser.add_argument("--orbit", type=orbit, metavar="FRAMES", help="the camera turns; of the first and last frame")
    parser.add_argument("--processor-time", action="store_true", help="seconds of all threads: for a busy machine")
    parser.add_argument("--interpolation", type=modes, metavar="MODE[,MODE...]", help="default: off,auto,on")
    parser.add_argument("--converged", type=number, metavar="SAMPLES", help="of references; default: 4 times the most")
    parser.add_argument("-o", "--output", type=Path, default=ROOT / "out" / "frames", help="where they are kept")
    parser.add_argument("--again", action="store_true", help="makes converged pictures anew")


def plan(options: argparse.Namespace, quick: bool) -> Plan:
    """What was asked for."""
    asked = vars(options)
    names = {"samples": "counts", "interpolation": "modes"}
    given = {names.get(key, key): value for key, value in asked.items() if value is not None}
    kept = {key: value for key, value in given.items() if key in Plan.__dataclass_fields__}
    return Plan(**({**asdict(QUICK), **kept} if quick else kept))


def chosen(names: list[str], scenes: FrameScenes, quick: bool) -> list[str]:
    """The scenes to measure. Raises SystemExit with the names that there are if one is not there."""
    known = scenes.names()
    wrong = [name for name in names if name not in known and not Path(name).is_file()]
    if wrong:
        raise SystemExit(f"rayleaf bench frames: there is no scene {', '.join(wrong)}; there are: {', '.join(known)}")
    return names or (list(QUICK_SCENES) if quick else known)


def measured(found: list[str], scenes: FrameScenes, by: Ruler) -> list[list[Frame]]:
    """Measures and prints; the table grows as it is measured."""
    width = max(len(Path(name).stem) for name in found)
    print("\n".join(frame_table.text_lines([frame_table.HEAD], width)), flush=True)
    done: list[list[Frame]] = []
    for name in found:
        for frames in by.scene(scenes.file(name)):
            print("\n".join(frame_table.text_lines(frame_table.rows(frames), width)), flush=True)
            done.append(frames)
    return done


def tell(line: str) -> None:
    """Progress."""
    sys.stderr.write(f"rayleaf: bench frames: {line}\n")


def row_of(frame: Frame) -> dict[str, Any]:
    """A frame as a benchmark's row, with all that is known of it."""
    return {"name": f"{frame.name}, second render", "unit": "s", "values": frame.second, **asdict(frame)}


def run(options: argparse.Namespace, quick: bool = False) -> list[dict[str, Any]]:
    """Prints the table, and what it means."""
    folder, blender = options.output, os.environ.get("BLENDER", "blender")
    scenes = FrameScenes(ROOT, blender, folder / "scenes")
    found, asked = chosen(options.scene, scenes, quick), plan(options, quick)
    done = measured(found, scenes, ruler(blender, asked, folder / "converged", tell, options.again))
    print(f"\n{frame_table.caption(asked)}")
    for line in dict.fromkeys(line for frames in done for line in frame_table.remarks(frames)):
        print(line)
    return [row_of(frame) for frames in done for frame in frames]
