"""The sources' pictures beside ours: traced, interpolated, and the mask that says which pixel was answered how.

Atalay and Mount's figures 9 to 12 show a mirroring Bezier surface, volumes of glass and as an x-ray, and tomatoes under
plastic wrap. The scenes here are built after them; they are not theirs."""

import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from . import page
from .errors import compare
from .gallery import read_layers, visible
from .measure import Conditions, render
from .points import Point

# Scene -> the figure of the source it stands beside.
SCENES = {
    "bezier_sheet": "RI figure 9: a mirroring Bezier surface",
    "random_volumes": "RI figure 10: random volumes of glass",
    "random_volumes_xray": "RI figure 11: random volumes, lengths",
    "tomatoes": "RI figure 12: tomatoes under plastic wrap",
}
MASK = "Rayleaf Mask Colors"
_ERROR = 0.005  # of ray interpolation
_AMPLIFIED = 10  # differences are shown times this


def points(samples: int) -> list[Point]:
    """Traced, then interpolated, with equal random numbers."""
    path, common = "rayleaf.ray_interpolation", {"rayleaf.samples": samples}
    on = {**common, f"{path}.use_advanced": False, f"{path}.mode": "ON", f"{path}.error": _ERROR}
    return [
        Point("Picture", "traced", assign={**common, f"{path}.mode": "OFF"}),
        Point("Picture", "interpolated", assign=on),
    ]


def figures(traced: Any, interpolated: Any, mask: Any | None) -> str:
    """Both pictures, the mask, and their difference."""
    difference = np.abs(np.asarray(traced)[..., :3] - np.asarray(interpolated)[..., :3]) * _AMPLIFIED
    shown = [page.picture(traced, "traced"), page.picture(interpolated, "interpolated")]
    if mask is not None:
        shown.append(page.picture(mask, "mask: white traced, blue interpolated, orange followed, grey passed by"))
    shown.append(page.picture(difference, f"difference, times {_AMPLIFIED}"))
    return page.pictures(*shown)


def scene(blender: str, file: Path, width: int, samples: int) -> str:
    """One scene's part."""
    tried = points(samples)
    with tempfile.TemporaryDirectory(prefix="rayleaf_report_") as name:
        results = render(blender, file, tried, Conditions(width, all_passes=True), Path(name))
        problems = [raw["problem"] for raw in results if "problem" in raw]
        if problems:
            return page.paragraph(f"{file.name}: {problems[0]}", "note")
        traced, interpolated = (np.load(raw["picture"]) for raw in results)
        layers = read_layers(Path(results[1]["layers"]))
    error = compare(interpolated, traced)
    mask = visible(MASK, layers[MASK]) if MASK in layers else None
    words = (
        f"Mean RGB distance {error.mean_rgb:.2g}, largest {error.maximum:.2g}; {results[0]['seconds'][0]:.3g} s traced, "
        f"{results[1]['seconds'][0]:.3g} s interpolated from an empty cache, with all passes."
    )
    return figures(traced, interpolated, mask) + page.paragraph(words, "note")


def section(blender: str, folder: Path, width: int, samples: int) -> str:
    """The part of the report; scenes that are not there are left out."""
    parts = [
        page.section(title, scene(blender, folder / f"{name}.blend", width, samples), level=3)
        for name, title in SCENES.items()
        if (folder / f"{name}.blend").exists()
    ]
    words = f"Scenes after the source's, ray interpolation on with an error of {_ERROR:g}, {samples} samples."
    return page.section("The sources' pictures", page.paragraph(words), *parts)
