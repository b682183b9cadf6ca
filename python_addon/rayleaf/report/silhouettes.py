"""How far outlines lie from the exact curve as Blender's Resolution U/V rises, and what that costs Cycles.

A bevelled Bezier ring of known shape, seen from above, is rendered as coverage. The exact outline is that of Rayleaf with
many samples, which renders the ring from its control points."""

import json
import subprocess
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from . import page, plots
from .errors import silhouette_error

SCRIPT = Path(__file__).with_name("render_silhouettes.py")


def measured(blender: str, width: int, resolutions: tuple[int, ...]) -> list[dict[str, Any]]:
    """For each picture {"engine", "resolution", "seconds", "memory_mb", "pixels": mean distance of outlines}."""
    with tempfile.TemporaryDirectory(prefix="rayleaf_report_") as name:
        job = Path(name) / "job.json"
        job.write_text(json.dumps({"folder": name, "width": width, "resolutions": resolutions}), encoding="utf-8")
        command = [blender, "--background", "--factory-startup", "--python-exit-code", "1", "--addons", "rayleaf",
                   "--python", str(SCRIPT), "--", str(job)]  # fmt: skip
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            last = "\n".join((done.stdout + done.stderr).splitlines()[-15:])
            raise RuntimeError(f"silhouettes: Blender ended with {done.returncode}:\n{last}")
        results: list[dict[str, Any]] = json.loads((Path(name) / "result.json").read_text(encoding="utf-8"))
        exact = np.load(results[0]["mask"])
        for each in results:
            each["pixels"] = silhouette_error(np.load(each.pop("mask")), exact)
        return results


def section(blender: str, width: int, resolutions: tuple[int, ...]) -> str:
    """The part of the report."""
    results = measured(blender, width, resolutions)
    rows = [(r["engine"].title(), r["resolution"], r["seconds"], r["memory_mb"], r["pixels"]) for r in results[1:]]
    mesh = [(float(r["resolution"]), float(r["pixels"])) for r in results[1:] if r["engine"] == "CYCLES"]
    own = [float(r["pixels"]) for r in results[1:] if r["engine"] == "RAYLEAF"]
    curves = {"Cycles, Blender's mesh": mesh, "Rayleaf, from the curve": [(x, own[0]) for x, _ in mesh]}
    drawing = plots.lines("Outline of a bevelled ring", "Resolution U", "mean distance of outlines, pixels", curves)
    return page.section(
        "Outlines of curved objects",
        page.paragraph(
            "The floor of both is the noise of their coverage samples; Rayleaf has no resolution to set, its line is flat."
        ),
        page.plot(drawing, "Distance from the exact outline"),
        page.table(("engine", "Resolution U", "seconds", "MB", "pixels"), rows),
    )
