"""Ray caches against tracing: speed-up of first, repeated and orbit frames, error, operations, memory.

One thread, its processor time, answering rays alone (ray_frames.py). The scenes are in ray_scenes.py. First frame: an
empty cache. Repeated: the twelfth frame of the same rays, for a cache that is kept buys cells over several frames; the
second frame and the mean of the twelve stand beside it, over tracing. Orbit: the mean of ten frames while the camera
moves by one degree each, with what the twelve have left.
Errors are against the tracer that filled the cache: the mean distance of RGB values in [0, 1] that rays see in the end.
Operations are counted (ray_flops.py): speed-up of the first and of a repeated frame.

`fast, coarse` has the coarsest thresholds whose error is within reach, as first and as repeated frame.

What is compared: `tracing`, Rayleaf's own, the one that fills the caches; `triangles`, the same surfaces as Embree's
triangles, 16 x 16 a patch, with exact normals, one ray at a time; `packets`, the same in packets of 16; `Newton` on exact
patches; `image plane`, camera rays interpolated in the picture, rebuilt each frame; and the caches. Rayleaf's own tracer
computes in double precision and finds facets of the surface's own fineness; the others are in single precision.
"""

import math
from typing import Any

from ray_frames import Picture
from ray_pictures import print_pictures
from ray_measure import RIVALS, TREES, Bench, Effort, Figures, numbers, paper_settings, print_scene, rows_of
from ray_scenes import Scene, chaotic_glass, gentle_glass, mirror_sheet, random_volumes, tomatoes
from ray_tables import SCATTERED_RAYS, scattered_speed_up, table_1, table_2

PRINTS_ITSELF = True
# What the fast tree should reach: error, then speed-up over tracing the same surfaces; first, repeated, orbit frame.
REACH: dict[str, tuple[float, tuple[float, float, float]]] = {
    "mirror sheet": (0.007, (3, 8, 5)),
    "mirror sheet, 9 samples": (0.007, (4.5, 9, 6.5)),
    "random volumes, glass": (0.004, (1.3, 3, 2)),
    "gentle glass, 9 samples": (0.003, (1.5, 4.5, 2)),
}
SCATTERED_REACH = 4.0
SCATTERED_BYTES = 10**9
# Settings of the fast tree, the coarsest first; the first one whose error is small enough is taken.
QUALITIES = [
    {
        "distance_threshold": distance,
        "direction_threshold": math.radians(degrees),
        "angle_threshold": math.radians(angle),
        "depth_limit": 36,
        "mixed_depth_limit": 36,
    }
    for distance, degrees, angle in (
        (0.4, 16, 45), (0.2, 8, 30), (0.1, 4, 30), (0.05, 2, 30), (0.02, 1, 30), (0.01, 0.5, 30))  # fmt: skip
]


def scenes(side: int) -> list[tuple[Scene, Picture]]:
    """What is measured, for pictures of so many pixels."""
    return [
        (mirror_sheet(), Picture(side, side)),
        (mirror_sheet(), Picture(side // 2, side // 2, 3)),
        (mirror_sheet(), Picture(2 * side, 3 * side // 2)),
        (random_volumes(), Picture(side, side)),
        (random_volumes(), Picture(side // 2, side // 2, 3)),
        (gentle_glass(), Picture(side, side)),
        (gentle_glass(), Picture(side // 2, side // 2, 3)),
        (chaotic_glass(), Picture(side, side)),
        (random_volumes("VOLUME"), Picture(side, side)),
        (tomatoes(), Picture(side, 3 * side // 4)),
    ]


def print_reach(measured: dict[str, tuple[Bench, dict[str, Figures]]], count: int, settings: dict[str, Any]) -> None:
    """What was wanted, and what is; settings are of the scattered rays' trees."""
    print("\nReach: speed-up of first, repeated, orbit frame over triangles, and over tracing; wanted in brackets")
    for name, (wanted_error, wanted) in REACH.items():
        if name not in measured:
            continue
        bench, trees = measured[name]
        for way, own in {**trees, "image plane": bench.figures["image plane"]}.items():
            for other in ("triangles", "tracing"):
                ratios = own.faster_than(bench.figures[other])
                reached = own.error <= wanted_error and all(a >= b for a, b in zip(ratios, wanted))
                print(
                    f"  {name:<26}{way:<13}over {other:<10}{numbers(ratios)}  ({numbers(list(wanted), 3, 1)})   "
                    f"error {own.error:.5f} ({wanted_error})   {'reached' if reached else 'not reached'}"
                )
    for scene in (mirror_sheet(), gentle_glass()):
        for tree in TREES:
            # Random rays share few cells: a cache that cannot hold them would be filled again and again.
            got = scattered_speed_up(scene, tree, {**settings, "cache_bytes": SCATTERED_BYTES}, count)
            print(
                f"  {'scattered, ' + scene.name:<26}{tree:<13}{got['ns']:.0f} ns an interpolated ray ({got['share']:.0f} % "
                f"are), {got['triangles']:.2f} times as fast as triangles, {got['tracing']:.2f} as tracing ({SCATTERED_REACH}), "
                f"error {got['error']:.5f}",
                flush=True,
            )


def coarsest(bench: Bench, wanted: float) -> dict[str, Any]:
    """The settings of the fast tree for an error."""
    for settings in QUALITIES:
        if bench.first_error("fast", settings) <= wanted:
            break
    return settings


def measure(
    scene: Scene, picture: Picture, effort: Effort, settings: dict[str, Any]
) -> tuple[str, Bench, dict[str, Figures]]:
    """The trees with the paper's settings, and the fast one with those that its reach allows. Prints the table."""
    name = scene.name + (f", {picture.side**2} samples" if picture.side > 1 else "")
    bench = Bench(scene, picture, effort, (*RIVALS, "image plane"))
    trees = {tree: bench.measure(tree, settings) for tree in TREES}
    if name in REACH:
        trees["fast, coarse"] = bench.measure("fast", coarsest(bench, REACH[name][0]))
    print_scene(bench, trees)
    return name, bench, trees


def run(quick: bool = False, small: bool = False) -> list[dict[str, Any]]:
    """Prints the tables; returns every measurement. `quick`: every part once, on a stamp; the figures mean nothing.
    `small`: a third of the side, so that samples are shared by fewer rays, and few values of a sweep."""
    rows, measured = [], {}
    side, every = (200, 3) if small else (600, 2)  # every second value of a sweep
    settings = paper_settings(depth=12) if quick else paper_settings()
    cases = [(mirror_sheet(), Picture(24, 24)), (gentle_glass(), Picture(8, 8, 3))] if quick else scenes(side)
    for scene, picture in cases:
        large = picture.columns * picture.rows > 4 * 600 * 600
        effort = Effort(1, 2, 1, 1) if quick or large else Effort()
        name, bench, trees = measure(scene, picture, effort, settings)
        measured.setdefault(name, (bench, trees))  # of a scene's pictures, the reach is for the first
        rows += rows_of(bench, trees)
    print_reach(measured, 300 if quick else SCATTERED_RAYS, settings)
    print_pictures(8 if quick else side * 2 // 3)
    effort = Effort(1, 2, 1, 1) if quick or small else Effort(1, 2)
    table_1(24 if quick else 2 * side, effort, tuple(TREES), settings["depth_limit"])
    rows += table_2(16 if quick else side // 2 if small else side, effort, tuple(TREES), 20 if quick else every)
    return rows
