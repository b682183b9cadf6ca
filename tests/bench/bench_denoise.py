"""Denoised pictures beside Cycles' denoised ones: how like each engine's own converged picture they are (SSIM).

It needs a Blender whose Cycles has Open Image Denoise (blender.org's), chosen by BLENDER; Rayleaf finds the library as in
every render. What an engine cannot denoise there is named, and has no row.
"""

import argparse
import os
import sys
import tempfile
from pathlib import Path
from typing import Any

from rayleaf.report.errors import compare
from rayleaf.report.measure import Conditions, render
from rayleaf.report.points import CYCLES_PLAIN, Point, reference

PRINTS_ITSELF = True
SCENES = Path(__file__).resolve().parents[2] / "blend_scenes"
USUAL = ("glass_vase", "knot", "spline_gallery", "still_life", "studio")
SAMPLES = 32


def add_options(parser: argparse.ArgumentParser) -> None:
    """What can be asked for."""
    parser.add_argument("scene", nargs="*", help=f"names of scenes; default: {', '.join(USUAL)}")
    parser.add_argument("--width", type=int, default=480, help="of pictures, pixels")
    parser.add_argument("--converged", type=int, default=2048, help="samples of the pictures that others are like")
    parser.add_argument("--keep", type=Path, help="a folder for the pictures, as NPY files")


def denoised(engine: str) -> Point:
    """Few samples, and what a denoiser makes of them."""
    if engine == "CYCLES":
        assign = {**CYCLES_PLAIN, "cycles.samples": SAMPLES, "cycles.use_denoising": True}
        return Point("Denoised", "Cycles", engine, assign)
    assign = {"rayleaf.samples": SAMPLES, "rayleaf.use_denoising": True, "rayleaf.ray_interpolation.mode": "OFF"}
    return Point("Denoised", "Rayleaf", engine, assign)


def likeness(file: Path, engine: str, options: argparse.Namespace, folder: Path) -> tuple[float, float]:
    """SSIM and root mean square error of the denoised picture. Raises RuntimeError where it cannot be rendered."""
    import numpy as np

    points = [reference(engine, options.converged), denoised(engine)]
    results = render(os.environ.get("BLENDER", "blender"), file, points, Conditions(options.width, repeats=1), folder)
    problems = [result["problem"] for result in results if "problem" in result]
    if problems:
        raise RuntimeError(problems[0])
    converged, picture = (np.load(result["picture"]) for result in results)
    if options.keep:
        options.keep.mkdir(parents=True, exist_ok=True)
        for name, pixels in (("converged", converged), ("denoised", picture)):
            np.save(options.keep / f"{file.stem}_{engine.lower()}_{name}.npy", pixels)
    error = compare(picture, converged)
    if error.ssim is None:
        raise RuntimeError("scikit-image is missing")
    return error.ssim, error.rmse


def run(options: argparse.Namespace, quick: bool = False) -> list[dict[str, Any]]:
    """Prints a line for each scene and engine."""
    if quick:
        options.scene, options.width, options.converged = ["bezier_sheet"], 32, 32
    print(f"{'':<20} {'':<8} {'SSIM':>7} {'error':>8}   of {SAMPLES} samples, denoised")
    rows = []
    for scene in options.scene or USUAL:
        for engine in ("RAYLEAF", "CYCLES"):
            try:
                with tempfile.TemporaryDirectory() as folder:
                    ssim, error = likeness(SCENES / f"{scene}.blend", engine, options, Path(folder))
            except RuntimeError as reason:
                print(f"{scene}: {engine.title()}: {reason}", file=sys.stderr)
                continue
            print(f"{scene:<20} {engine.title():<8} {ssim:>7.4f} {error:>8.5f}", flush=True)
            rows.append({"name": f"{scene}, {engine.title()}", "unit": "SSIM", "values": [ssim]})
    return rows
