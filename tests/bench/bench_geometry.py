"""The geometry cache against Embree's full grid, a single resolution and none, on 10^6 subpatches and mixed rays.

Christensen et al. 2003, sections 6.2 and 6.3.2. Fifteen lumpy closed tori over a wavy ground, all bicubic, as in
bench_trace.py. Mixed rays: camera rays, the mirror rays of their hits, and rays over the hemispheres of some hits, each
as wide as it is for a picture of this size. One thread, its processor time, after a pass that fills the cache. Embree's
grids take 7 GB for 10^6 subpatches and are left out where the memory free is less. RAYLEAF_BENCH_QUICK=1 does all of it
on 10^3 subpatches.
"""

import os
import time
from pathlib import Path
from typing import Any

import bench_trace
import numpy as np
from numpy.typing import NDArray
from rayleaf import _core

Doubles = NDArray[np.float64]
Floats = NDArray[np.float32]
Rays = dict[str, Any]

QUICK = os.environ.get("RAYLEAF_BENCH_QUICK") == "1"
RESOLUTION = 8 if QUICK else 250  # patches around a torus; 19 n² in all
BUDGETS = [1, 3, 10, 30, 100]
DEFAULT_BUDGET = 30
HEMISPHERE_RAYS = 16
HEMISPHERE_EVERY = 16  # hits
SHELL_RAYS = 100_000 if QUICK else 10_000_000
# Of Embree's grids with 17 x 17 vertices and its tree over them.
EMBREE_BYTES_PER_SUBPATCH = 8000


def free_bytes() -> int:
    """Memory that may still be had."""
    lines = Path("/proc/meminfo").read_text().splitlines()
    return next(int(line.split()[1]) * 1024 for line in lines if line.startswith("MemAvailable"))


def joined(sets: list[Rays]) -> Rays:
    """All rays of several sets, one set after the other."""
    return {key: np.concatenate([each[key] for each in sets]) for key in sets[0]}


def rays_of(origins: Doubles, directions: Doubles, width: Any, spread: Any, starts: Any = None) -> Rays:
    """Rays with their widths; one number may stand for all."""
    count = len(origins)
    none = np.full((count, 3), 2**32 - 1, np.uint32)
    return {
        "origins": origins,
        "directions": directions,
        "width": np.broadcast_to(np.float32(width), count).copy(),
        "spread": np.broadcast_to(np.float32(spread), count).copy(),
        "starts": none if starts is None else starts,
    }


def mixed_rays(tracer: Any) -> Rays:
    """Camera rays, mirror rays, hemisphere rays."""
    origins, directions = bench_trace.camera_rays()
    pixel = 1.1 / bench_trace.WIDTH
    camera = rays_of(origins, directions, 0.0, pixel)
    hits = tracer.closest_hits(**camera)
    hit = hits["instance"] >= 0
    hits = {key: value[hit] for key, value in hits.items()}
    seen, width = directions[hit], (pixel * hits["t"]).astype(np.float32)
    normal = hits["normal"].astype(np.float64)
    normal *= -np.sign(np.sum(normal * seen, axis=1))[:, None]
    mirrored = bench_trace.unit(seen - 2 * np.sum(seen * normal, axis=1)[:, None] * normal)
    # The normal turns by about the curvature times the width: lumps of a fifth of a unit.
    mirror = rays_of(bench_trace.leaving(hits, mirrored), mirrored, width, pixel + 10 * width, hits["anchors"])
    random = np.random.default_rng(3)
    chosen = np.repeat(np.arange(0, len(seen), HEMISPHERE_EVERY), HEMISPHERE_RAYS)
    few = {key: value[chosen] for key, value in hits.items()}
    scattered = bench_trace.unit(normal[chosen] + bench_trace.unit(random.normal(size=(len(chosen), 3))))
    cosine = np.maximum(np.sum(scattered * normal[chosen], axis=1), 0.05)
    share = np.minimum(np.sqrt(np.pi / (HEMISPHERE_RAYS * cosine)), 1.0)
    wide = rays_of(bench_trace.leaving(few, scattered), scattered, width[chosen], share, few["anchors"])
    return joined([camera, mirror, wide])


def made(surface: Any, megabytes: float, mode: str) -> tuple[Any, float]:
    """A tracer, and the seconds that it took."""
    begin = time.perf_counter()
    cache = _core.trace.GeometryCacheSettings(megabytes=megabytes, mode=mode)
    tracer = _core.trace.Tracer([(surface, np.eye(4), 31)], eye=list(bench_trace.EYE), cache=cache)
    return tracer, time.perf_counter() - begin


def measured(tracer: Any, rays: Rays) -> tuple[float, Doubles, dict[str, Any]]:
    """Mrays/s of the second pass, its distances, and the cache's counters after the first."""
    tracer.timed_closest(**rays)
    counters = tracer.statistics()["geometry_cache"]
    seconds, t = tracer.timed_closest(**rays)
    return len(t) / seconds / 1e6, t, counters


def cracks_in_shells() -> int:
    """How many of many rays of all widths find crossings that no closed shell has."""
    random = np.random.default_rng(5)
    torus = bench_trace.torus(np.zeros(3), 0.7, 16, 24, random)
    closed = bench_trace.CUBIC_CLOSED
    surface = _core.trace.PatchSurface("shell", [(torus, closed, closed, True, 0)])
    tracer = _core.trace.Tracer([(surface, np.eye(4), 31)])
    found, block = 0, 100_000
    for _ in range(SHELL_RAYS // block):
        origins = 5 * bench_trace.unit(random.normal(size=(block, 3)))
        directions = bench_trace.unit(random.uniform(-0.9, 0.9, (block, 3)) - origins)
        width, spread = ((10 ** random.uniform(-6, 0, block)).astype(np.float32) for _ in range(2))
        found += int(_core.trace.cracks(tracer, origins, directions, width, spread, inside=False).sum())
    return found


def run() -> list[dict[str, Any]]:
    """Rows of speed, memory, vertices computed again, and what is to be reached."""
    surface = bench_trace.scene(RESOLUTION)
    reference, build = made(surface, DEFAULT_BUDGET, "MULTI")
    rays = mixed_rays(reference)
    rows: list[dict[str, Any]] = []

    def row(name: str, unit: str, value: float) -> None:
        rows.append({"name": name, "unit": unit, "values": [value]})

    statistics = reference.statistics()
    row("subpatches", "", statistics["subpatches"])
    row("rays", "", len(rays["origins"]))
    row("build, geometry cache", "s", build)
    again: dict[tuple[str, int], float] = {}
    speed: dict[tuple[str, int], float] = {}
    expected: Doubles | None = None
    for mode in ("MULTI", "SINGLE"):
        cold = 0
        for budget in reversed(BUDGETS):
            tracer, _ = made(surface, budget, mode)
            speed[mode, budget], t, counters = measured(tracer, rays)
            if mode == "MULTI":
                expected = t if expected is None else expected
                assert np.array_equal(t, expected), f"{budget} MB gives other hits"
            levels = counters["levels"]
            assert counters["bytes"] <= max(budget * 2**20, 2**18), counters
            # What is cold does not depend on the budget, and is not counted within the smallest ones.
            cold = counters["vertices_diced"] - counters["vertices_recomputed"] if counters["cold_counted"] else cold
            again[mode, budget] = counters["vertices_diced"] - cold
            name = f"{mode.lower()}, {budget} MB"
            row(f"{name}: speed", "Mrays/s", speed[mode, budget])
            row(f"{name}: vertices computed again", "million", again[mode, budget] / 1e6)
            for level, numbers in levels.items():
                if numbers["lookups"]:
                    row(f"{name}: hits, {level}", "%", 100 * (1 - numbers["diced"] / numbers["lookups"]))
        row(f"{mode.lower()}: vertices computed first", "million", cold / 1e6)
    nothing, _ = made(surface, 0, "NONE")
    row("no cache: speed", "Mrays/s", measured(nothing, rays)[0])

    held = reference.statistics()
    memory = held["geometry_cache"]["bytes"] + held["record_bytes"] + held["bvh_bytes"]
    row("geometry cache, records and tree", "MB", memory / 1e6)
    multi, single = again["MULTI", DEFAULT_BUDGET], again["SINGLE", DEFAULT_BUDGET]
    row("reached: single over multi, vertices again at 30 MB", "times (300)", single / max(multi, 1))
    row("reached: 100 MB single over 1 MB multi", "times (10)", again["SINGLE", 100] / max(again["MULTI", 1], 1))
    if free_bytes() > 1.5 * EMBREE_BYTES_PER_SUBPATCH * statistics["subpatches"]:
        begin = time.perf_counter()
        grid = _core.trace.EmbreeBaseline(surface, "GRID", eye=list(bench_trace.EYE))
        grid_build = time.perf_counter() - begin
        plain = rays["origins"], rays["directions"]
        grid.timed_closest(*plain)
        seconds, _ = grid.timed_closest(*plain)
        row("Embree's grid: speed", "Mrays/s", len(rays["origins"]) / seconds / 1e6)
        row("Embree's grid: memory", "MB", grid.bytes / 1e6)
        row("Embree's grid: build", "s", grid_build)
        ratio = speed["MULTI", DEFAULT_BUDGET] * seconds * 1e6 / len(rays["origins"])
        row("reached: speed over Embree's grid", "times (1.15)", ratio)
        row("reached: share of its memory", "% (5)", 100 * memory / grid.bytes)
        row("reached: share of its build time", "% (3.3)", 100 * build / grid_build)
    row(f"cracks, {SHELL_RAYS} rays through a shell of mixed levels", "rays (0)", cracks_in_shells())
    return rows
