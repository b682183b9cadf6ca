"""The tables of the source (tables 1 and 2 of Atalay and Mount), and rays without a camera's order."""

from typing import Any

import numpy as np
from ray_frames import Picture, Rays, Rival, Trees, surrounding, unit
from ray_measure import RIVALS, TREES, Bench, Effort, Figures, numbers, paper_settings
from ray_scenes import Scene, mirror_sheet, random_volumes, tomatoes
from rayleaf import _core

DISTANCES = (0.01, 0.025, 0.05, 0.075, 0.1, 0.125, 0.15, 0.175, 0.2, 0.225, 0.25)
ANGLES = (5, 10, 15, 20, 25, 30)
DEPTHS = (22, 23, 24, 25, 26, 27, 28, 29, 30)
CACHES = (0.128, 0.256, 0.512, 1.024, 2.048)  # MB
SCATTERED_RAYS = 200_000
Sweep = tuple[str, list[tuple[str, dict[str, Any]]]]


def sweeps(volumes: bool) -> list[Sweep]:
    """The paper's: distance 0.05 and 0.25, 30 degrees and depth 28 where they do not vary."""
    distance = 0.25 if volumes else 0.05
    return [
        ("distance", [(f"{d}", paper_settings(distance=d)) for d in DISTANCES]),
        ("depth", [(f"{d}", paper_settings(distance=distance, depth=d)) for d in DEPTHS]),
        ("angle", [(f"{a}", paper_settings(distance=distance, degrees=a)) for a in ANGLES]),
    ]


def thinned(values: list[Any], every: int) -> list[Any]:
    """Of a sweep's values, those that many apart, from the first on, and the last."""
    return values[::every] + ([] if (len(values) - 1) % every == 0 else values[-1:])


def print_head(first: str) -> None:
    """Above a sweep."""
    print(
        f"  {first:<10}{'tree':<11}{'FLOP: triang.':<15}{'Newton':<13}   {'CPU: triangles':<20}   {'Newton':<20}   "
        f"{'tracing':<20}{'error':>8}{'interp.':>9}{'traced':>8}{'MB':>8}{'prunes':>7}"
    )


def print_line(value: str, tree: str, own: Figures, bench: Bench) -> None:
    """One setting; each speed-up: first, second, mean of the orbit's frames."""
    ratios = [numbers(own.faster_than(bench.figures[name])) for name in ("triangles", "Newton", "tracing")]
    print(
        f"  {value:<10}{tree:<11}{numbers(list(own.flops['triangles'])):<15}{numbers(list(own.flops['Newton'])):<13}   "
        f"{ratios[0]}   {ratios[1]}   {ratios[2]}{own.error:>8.5f}"
        f"{own.share('interp', 'two classes, interp'):>8.1f}%{own.share('traced'):>7.1f}%{own.megabytes:>8.3f}{own.prunes:>7}",
        flush=True,
    )


def table_1(side: int, effort: Effort, trees: tuple[str, ...], depth: int = 28) -> None:
    """The paper's table 1: the tomatoes, 1200 x 900."""
    print("\nTable 1: tomatoes, rays followed through wrap and bowl, with shadows")
    bench = Bench(tomatoes(), Picture(side, 3 * side // 4), effort)
    print_head("")
    for distance, degrees in ((0.25, 30), (0.05, 10)):
        for tree in trees:
            figures = bench.measure(tree, paper_settings(distance, degrees, depth), 1)
            print_line(f"{distance} {degrees}", tree, figures, bench)


def sweep_rows(scene: Scene, sweep: str, value: str, tree: str, own: Figures, bench: Bench) -> list[dict[str, Any]]:
    """What the source's figures 5 to 8 show of one setting."""
    start = f"table 2|{scene.name}|{sweep}|{value}|{tree}"
    speed_up = own.faster_than(bench.figures["Newton"])[0]
    return [
        {"name": f"{start}|CPU over Newton", "unit": "times, first frame", "values": [speed_up]},
        {"name": f"{start}|FLOP over Newton", "unit": "times, first frame", "values": [own.flops["Newton"][0]]},
        {"name": f"{start}|error", "unit": "mean RGB distance", "values": [own.error]},
        {"name": f"{start}|MB", "unit": "MB", "values": [own.megabytes]},
    ]


def table_2(side: int, effort: Effort, trees: tuple[str, ...], every: int = 1) -> list[dict[str, Any]]:
    """The paper's table 2 and its figure 8: sweeps over one parameter each; `every`: of the values, that many apart, and
    the last. Pictures as the paper's: 600 x 600, glass bodies 300 x 300 with 9 samples. It has the means of three scenes
    of bodies, and of several views of the sheet; here are one scene, and an orbit's views apart."""
    rows: list[dict[str, Any]] = []
    pictures = (
        (mirror_sheet(), Picture(side, side)),
        (random_volumes(), Picture(side // 2, side // 2, 3)),
        (random_volumes("VOLUME"), Picture(side, side)),
    )
    for scene, picture in pictures:
        bench = Bench(scene, picture, effort, RIVALS)
        print(f"\nTable 2: {scene.name}, {picture.text}")
        is_sheet = scene is pictures[0][0]
        swept = sweeps(volumes=not is_sheet)
        if is_sheet:
            swept.append(("cache, MB", [(f"{m}", paper_settings(megabytes=m)) for m in CACHES]))
        for name, settings in swept:
            print_head(name)
            for value, each in thinned(settings, every):
                for tree in trees:
                    own = bench.measure(tree, each, 1)
                    print_line(value, tree, own, bench)
                    rows += sweep_rows(scene, name, value, tree, own, bench)
    return rows


def scattered(scene: Scene, count: int) -> Rays:
    """Rays from everywhere outside towards everywhere inside, as secondary and shadow rays come, in no order."""
    random = np.random.default_rng(11)
    radius = 0.55 * scene.distance
    origins = scene.target + radius * unit(random.normal(size=(count, 3)))
    origins[:, 2] = np.abs(origins[:, 2] - scene.target[2]) + scene.target[2]
    inside = scene.target + 0.35 * radius * unit(random.normal(size=(count, 3))) * random.uniform(size=(count, 1))
    directions = unit(inside - origins)
    zeros = np.zeros(count, np.float32)
    return Rays(origins, directions, zeros, zeros)


def scattered_speed_up(scene: Scene, tree: str, settings: dict[str, Any], count: int) -> dict[str, float]:
    """Of rays that a filled tree interpolates, in no order: over triangles and over tracing, and their error."""
    trees = Trees(scene, TREES[tree], settings)
    rays = scattered(scene, count)
    used = trees.ask(rays)["answered_by"] == _core.ri_tree.ANSWERS.index("interpolated")
    chosen = Rays(rays.origins[used], rays.directions[used], rays.distances[used], rays.angles[used])
    own = Trees(scene, TREES["reference"], {}, traced=True)
    seconds, seen = {}, {}
    for name, method in {"tree": trees, "triangles": Rival(scene, "TRIANGLES"), "tracing": own}.items():
        seen[name] = surrounding(method.ask(chosen)["exit_direction"].astype(float))
        # At least a tick of the clock: a tree may interpolate none.
        seconds[name] = max(float(np.median([method.ask(chosen)["seconds"] for _ in range(3)])), 1e-9)
    return {
        "share": 100 * float(used.mean()),
        "ns": 1e9 * seconds["tree"] / max(int(used.sum()), 1),
        "triangles": seconds["triangles"] / seconds["tree"],
        "tracing": seconds["tracing"] / seconds["tree"],
        "error": float(np.linalg.norm(seen["tree"] - seen["tracing"], axis=1).mean()),
    }
