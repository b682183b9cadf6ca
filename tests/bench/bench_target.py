"""Target Error or Noise Threshold: what was asked for, what was achieved, and how long a fixed number of samples takes for it.

Of pictures of blend_scenes. The error hardly depends on the size, but how well it is known does: the fewer pixels, the more
room is left for doubt, and the more samples are taken. `of fixed` is for the same root mean square error, in seconds of all
threads and in samples; `of worst` for the same error of the worst hundredth of pixels. `at most`: what the error is below for all
that the converged pictures can tell. Where that is far above `achieved`, they need more samples (`--converged`).
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
TARGETS = (0.02, 0.005, 0.001)
THRESHOLDS = (0.1, 0.03, 0.01)


def targets(text: str) -> tuple[float, ...]:
    """Numbers with commas between them."""
    return tuple(float(word) for word in text.split(","))


def add_options(parser: argparse.ArgumentParser) -> None:
    """What can be asked for."""
    parser.add_argument("scene", nargs="*", help="names of scenes; default: all")
    parser.add_argument("--targets", type=targets, default=None, metavar="T[,T...]")
    parser.add_argument("--noise-threshold", action="store_true", help="of samples, in place of a target error")
    parser.add_argument("--width", type=int, default=384, help="of pictures, pixels")
    parser.add_argument("--converged", type=int, default=512, help="samples of the pictures that errors are against")
    parser.add_argument("--most", type=int, default=1 << 18, help="samples of a pixel")
    parser.add_argument(
        "--minutes", type=float, default=30.0, help="for each scene; what is not done by then is left out"
    )
    parser.add_argument("--small", action="store_true", help="64 pixels wide, two targets, 5 minutes a scene at most")
    parser.add_argument("--interpolation", action="store_true", help="rays are interpolated wherever they can be")


def measured(scene: str, options: Any) -> list[dict[str, float]]:
    """A row for each target, as far as time allows."""
    job = {name: getattr(options, name) for name in ("width", "converged", "most")}
    job["interpolates"] = options.interpolation
    job["setting"] = "noise_threshold" if options.noise_threshold else "target_error"
    job["values"] = options.targets or (THRESHOLDS if options.noise_threshold else TARGETS)
    script = Path(__file__).with_name("target_frames.py")
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "rows"
        command = [
            *(os.environ.get("BLENDER") or "/usr/bin/blender", "--background", "--factory-startup"),
            *("--python-exit-code", "1", "--addons", "rayleaf", str(ROOT / "blend_scenes" / f"{scene}.blend")),
            *("--python", str(script), "--", json.dumps(job), str(out)),
        ]
        try:
            done = subprocess.run(command, capture_output=True, text=True, timeout=60 * options.minutes, check=False)
            if done.returncode != 0:
                raise RuntimeError(f"{scene}: Blender ended with {done.returncode}:\n{done.stdout[-2000:]}")
        except subprocess.TimeoutExpired:
            pass
        return [json.loads(line) for line in out.read_text().splitlines()] if out.exists() else []


def run(options: argparse.Namespace, quick: bool = False, small: bool = False) -> list[dict[str, Any]]:
    """Prints a line for each picture."""
    if small or options.small:
        options.targets, options.width, options.converged, options.minutes = TARGETS[:2], 64, 1024, 5.0
    if quick:
        options.scene, options.targets, options.width, options.most = ["bezier_sheet"], (0.05,), 16, 256
        options.converged = 256
    print(
        f"{'':<20} {'asked':>7} {'achieved':>8} {'at most':>8} {'of it':>6} {'estimated':>9} {'samples':>18} {'s':>7}"
        f" {'of fixed':>8} {'samples':>8} {'of worst':>8}"
    )
    rows = []
    for scene in options.scene or sorted(file.stem for file in (ROOT / "blend_scenes").glob("*.blend")):
        for row in measured(scene, options):
            samples = f"{row['least']}..{row['mean']:.0f}..{row['most']}"
            share, of_fixed = row["achieved"] / row["value"], row["seconds"] / row["fixed_seconds"]
            print(
                f"{scene:<20} {row['value']:>7} {row['achieved']:>8.5f} {row['at_most']:>8.5f} {share:>6.2f} {row['estimated']:>9.5f}"
                f" {samples:>18} {row['seconds']:>7.1f} {of_fixed:>8.2f} {row['mean'] / row['fixed_samples']:>8.2f}"
                f" {row['seconds'] / row['fixed_seconds_of_worst']:>8.2f}",
                flush=True,
            )
            if not options.noise_threshold:
                rows.append({"name": f"{scene}, {row['value']}", "unit": "of the target", "values": [share]})
            rows.append({"name": f"{scene}, {row['value']}", "unit": "of fixed samples' time", "values": [of_fixed]})
    return rows
