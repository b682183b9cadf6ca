"""The scenes of Christensen et al. (2003), section 6, made here at their sizes: the geometry cache in whole renders.

Each is built by Blender into a temporary folder and rendered at 30 MB, with many resolutions and with one. The .blend in
blend_scenes are smaller. Objects of equal shape are one here, as in every render: what is diced is less than the
paper's where there are many of them. What the paper measured stands beside: its models are not to be had, so what can be compared is
how much is asked for, and how much of it is computed again.
"""

import os
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rayleaf.report.frame_scenes import built
from rayleaf.report.measure import Conditions, render
from rayleaf.report.points import Point

PRINTS_ITSELF = True
SCENES = Path(__file__).resolve().parents[2] / "blend_scenes"
MEGABYTES = 30.0
WIDTH, QUICK_WIDTH = 480, 64
MODES = {"multi": "MULTI", "single": "SINGLE"}
FULL_VERTICES = 17 * 17  # of a fine grid


@dataclass(frozen=True)
class Scene:
    """One of the paper's, and how ours is made."""

    script: str
    words: tuple[str, ...]  # after the folder, for the size of the paper's
    samples: int
    paper: str
    megabytes: float = MEGABYTES  # of the geometry cache


FULL = (
    Scene("parking_lot", ("5", "diffuse"), 4, "940,000 subpatches; misses 360 M vertices single, 6.2 M multi"),
    Scene("parking_lot", ("5", "occlusion"), 4, "940,000 subpatches; misses 8.7 G vertices single, 10 M multi"),
    Scene(
        "psychedelic_dragons",
        ("94", "matte", "few_spikes"),
        2,
        "183,000 subpatches; misses 100 M vertices single, 54 k multi",
    ),
    Scene("city_street", ("19",), 2, "970,000 subpatches; misses 610 M vertices single, 8.6 M multi"),
)
QUICK = (Scene("parking_lot", ("1", "diffuse"), 1, "not this size", megabytes=2.0),)


def blender() -> str:
    """The Blender to use."""
    return os.environ.get("BLENDER", "blender")


def points(scene: Scene) -> list[Point]:
    """One render for each mode of the cache."""
    common = {
        "rayleaf.samples": scene.samples,
        "rayleaf.facet_memory": 0.0,
        "rayleaf.geometry_cache_size": scene.megabytes,
    }
    return [
        Point("Cache", name, assign={**common, "rayleaf.geometry_cache_mode": mode}) for name, mode in MODES.items()
    ]


def print_levels(mode: str, seconds: float, core: dict[str, Any]) -> None:
    """What was asked of each level."""
    cache = core["geometry_cache"]
    print(f"  {mode}: {seconds:.1f} s, {cache['bytes'] / 1e6:.1f} MB of grids,", end=" ")
    print(
        f"{core['memory']['subpatches'] / 1e6:.1f} MB of records, {core['memory']['acceleration'] / 1e6:.1f} MB of trees"
    )
    for name, level in (cache["levels"] | {"parts": cache["parts"]}).items():
        counts = f"{level['lookups']:>14,} lookups {level['cold']:>12,} cold {level['misses']:>12,} misses"
        print(f"    {name:<8}{counts}  {level['hit_rate']:8.2%}")
    print(f"    computed again: {cache['vertices_recomputed']:,} vertices of {cache['vertices_diced']:,}")


def measured(scene: Scene, width: int, folder: Path) -> list[dict[str, Any]]:
    """Prints a scene's table; its rows."""
    file = built(blender(), SCENES / f"make_{scene.script}.py", folder, scene.words)
    results = render(blender(), file, points(scene), Conditions(width), folder)
    title = " ".join((scene.script, *scene.words))
    subpatches = results[0]["statistics"]["core"]["geometry"]["subpatches"]
    full = subpatches * FULL_VERTICES
    print(f"\n{title}: {subpatches:,} subpatches, fully diced {full:,} vertices. The paper's: {scene.paper}")
    rows = [{"name": f"{title}: subpatches", "unit": "", "values": [subpatches]}]
    for mode, result in zip(MODES, results, strict=True):
        core, seconds = result["statistics"]["core"], result["seconds"]
        print_levels(mode, seconds[0], core)
        again = core["geometry_cache"]["vertices_recomputed"]
        rows.append({"name": f"{title}: {mode}, time", "unit": "s", "values": seconds})
        rows.append({"name": f"{title}: {mode}, computed again", "unit": "vertices", "values": [again]})
    return rows


def run(quick: bool = False) -> list[dict[str, Any]]:
    """Builds, renders and prints each scene."""
    rows = []
    for scene in QUICK if quick else FULL:
        with tempfile.TemporaryDirectory() as folder:
            rows += measured(scene, QUICK_WIDTH if quick else WIDTH, Path(folder))
    return rows
