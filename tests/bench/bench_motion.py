"""Motion blur: the time of a blurred frame over that of the sharp one, in Rayleaf and in Cycles.

Three cars drive through parking_lot, hair_ball is combed by the wind, a NURBS sheet waves. Seconds are those of all
threads, so that other work on the machine counts little.
"""

import argparse
import json
import os
import subprocess
import tempfile
from pathlib import Path
from typing import Any

PRINTS_ITSELF = True
ROOT = Path(__file__).resolve().parents[2]
SCENES = {"cars": "parking_lot", "hair": "hair_ball", "sheet": "bezier_sheet"}


def add_options(parser: argparse.ArgumentParser) -> None:
    """What can be asked for."""
    parser.add_argument("motion", nargs="*", help=f"{', '.join(SCENES)}; default: all")
    parser.add_argument("--samples", type=int, default=32)
    parser.add_argument("--percentage", type=int, default=50, help="of the files' resolution")
    parser.add_argument("--rounds", type=int, default=3)


def measured(motion: str, options: argparse.Namespace) -> dict[str, dict[str, list[float]]]:
    """Seconds by engine."""
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "seconds.json"
        asked = [motion, "RAYLEAF,CYCLES", *map(str, (options.samples, options.percentage, options.rounds)), str(out)]
        command = [
            *(os.environ.get("BLENDER", "blender"), "--background", "--factory-startup", "--python-exit-code", "1"),
            *("--addons", "rayleaf,cycles", str(ROOT / "blend_scenes" / f"{SCENES[motion]}.blend")),
            *("--python", str(Path(__file__).with_name("motion_frames.py")), "--", *asked),
        ]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise RuntimeError(
                f"{motion}: Blender ended with {done.returncode}:\n{done.stdout[-1500:]}{done.stderr[-500:]}"
            )
        found: dict[str, dict[str, list[float]]] = json.loads(out.read_text(encoding="utf-8"))
        return found


def run(options: argparse.Namespace, quick: bool = False) -> list[dict[str, Any]]:
    """Prints a line for each motion and engine."""
    if quick:
        options.motion, options.samples, options.percentage, options.rounds = ["sheet"], 1, 5, 1
    print(f"{'':<6} {'':<8} {'sharp, s':>9} {'blurred, s':>10} {'ratio':>6}")
    rows = []
    for motion in options.motion or SCENES:
        for engine, found in measured(motion, options).items():
            sharp, blurred = min(found["sharp"]), min(found["blurred"])
            print(f"{motion:<6} {engine.title():<8} {sharp:>9.2f} {blurred:>10.2f} {blurred / sharp:>6.2f}", flush=True)
            rows.append({"name": f"{motion}, {engine.title()}", "unit": "of the sharp", "values": [blurred / sharp]})
    return rows
