"""The geometry cache: several resolutions against one, none, and Embree's full grid, at 1 to 100 MB.

Christensen et al. 2003, sections 6.2 and 6.3.2. Fifteen lumpy closed tori over a wavy ground, all bicubic, 10^6
subpatches, as in bench_trace.py. Mixed rays: camera rays, the mirror rays of their hits, and rays over the hemispheres
of some hits, each as wide as it is for a picture of this size. One thread, its processor time, in the second of two
passes; the counters are of the first. Vertices computed again: those of grids that were there before and had to go.

Levels follow from the size of quads alone, as in the paper, or by default from the distance of facets too: then nearly
all rays see these flat surfaces as single quads, which are never missed. All is told for both rules; a single resolution
knows no rule.

Embree's grids take 11 GB for 10^6 subpatches and are left out where less memory is free.
"""

import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import bench_trace
import numpy as np
import rayleaf_rivals
from geometry_rays import Doubles, Rays, cracks_in_shells, hills, mixed_rays, offset
from rayleaf import _core

PRINTS_ITSELF = True
RESOLUTION, SMALL_RESOLUTION, QUICK_RESOLUTION = 250, 80, 25  # patches around a torus; some 16 n² in all
WIDTH, SMALL_WIDTH, QUICK_WIDTH = 1024, 360, 256  # pixels
BUDGETS = (100, 30, 10, 3, 1)  # MB
DEFAULT_BUDGET = 30
SHELL_RAYS, QUICK_SHELL_RAYS = 10_000_000, 100_000
DISPLACED_SHARE = 5  # one of so many of these meets a displaced shell
# Facets as near to the surface as a share of a ray's width: so small that the size of quads decides, or as by default.
BY_SIZE, BY_DEFAULT = 1e-9, 0.1
RULES = {"by default": BY_DEFAULT, "by size": BY_SIZE}
# What a displacement may cost a vertex, where its time is added to what was measured without one.
ASSUMED_NANOSECONDS = 100
# Displaced: of so many patches around a torus, with so much memory, a fortieth of all.
DISPLACED_RESOLUTION, QUICK_DISPLACED_RESOLUTION = 20, 6
DISPLACED_WIDTH, QUICK_DISPLACED_WIDTH = 128, 32
# A scene that fits into the default budget, all of its levels: of so many patches around a torus.
FITTING_RESOLUTION = 8
# Of Embree's grids with 17 x 17 vertices and its tree over them.
EMBREE_BYTES_PER_SUBPATCH = 9200
LEVELS = ("coarse", "medium", "fine")
Row = dict[str, Any]


@dataclass
class Figures:
    """What one cache did."""

    mode: str
    megabytes: float
    speed: float  # Mrays/s
    counters: dict[str, Any]
    rays: int
    diced: int = 0  # vertices of the second pass, which is the one with the speed
    again: float = 0.0  # million vertices

    def displaced_speed(self) -> float:
        """Mrays/s, had each vertex of the pass cost ASSUMED_NANOSECONDS more."""
        rays = self.rays / 1e6
        return rays / (rays / self.speed + ASSUMED_NANOSECONDS * 1e-9 * self.diced)

    def level(self, name: str, what: str) -> int:
        """One counter of a level."""
        return int(self.counters["levels"][name][what])

    def hit_rate(self, name: str) -> str:
        """Of a level, per cent of its lookups."""
        lookups = self.level(name, "lookups")
        return f"{100 * (1 - self.level(name, 'diced') / lookups):.2f}" if lookups else "-"

    def misses(self, name: str) -> float:
        """Of a level, without the cold ones, thousands."""
        return (self.level(name, "diced") - self.level(name, "cold")) / 1e3


def free_bytes() -> int:
    """Memory that may still be had."""
    lines = Path("/proc/meminfo").read_text().splitlines()
    return next(int(line.split()[1]) * 1024 for line in lines if line.startswith("MemAvailable"))


def made(surface: Any, megabytes: float, mode: str, distance: float = BY_SIZE) -> tuple[Any, float]:
    """A tracer, and the seconds that it took."""
    begin = time.perf_counter()
    cache = _core.trace.GeometryCacheSettings(megabytes=megabytes, mode=mode, distance=distance)
    tracer = _core.trace.Tracer([(surface, np.eye(4), 31)], eye=list(bench_trace.EYE), cache=cache)
    return tracer, time.perf_counter() - begin


def measured(tracer: Any, rays: Rays, mode: str, megabytes: float) -> tuple[Figures, Doubles]:
    """Speed of the second pass, its distances, and the cache's counters after the first."""
    tracer.timed_closest(**rays)
    counters = tracer.statistics()["geometry_cache"]
    seconds, t = tracer.timed_closest(**rays)
    diced = tracer.statistics()["geometry_cache"]["vertices_diced"] - counters["vertices_diced"]
    return Figures(mode, megabytes, len(t) / seconds / 1e6, counters, len(t), diced), t


def sweep(surface: Any, rays: Rays, mode: str, distance: float, title: str) -> dict[float, Figures]:
    """All budgets of one mode, the largest first; all give the same hits."""
    found: list[Figures] = []
    expected: Doubles | None = None
    cold = 0
    for budget in BUDGETS:
        figures, t = measured(made(surface, budget, mode, distance)[0], rays, mode, budget)
        expected = t if expected is None else expected
        assert np.array_equal(t, expected), f"{budget} MB gives other hits"
        counters = figures.counters
        assert counters["bytes"] <= budget * 2**20, counters
        # What is cold does not depend on the budget, and is not counted within the smallest ones.
        if counters["cold_counted"]:
            cold = counters["vertices_diced"] - counters["vertices_recomputed"]
        figures.again = (counters["vertices_diced"] - cold) / 1e6
        found.append(figures)
    print(f"\n{title}: {cold / 1e6:.2f} million vertices computed first")
    print(
        f"  {'MB':>5} {'Mrays/s':>8}  {'hit rate, %: ' + ', '.join(LEVELS):>36}  {'misses, 10^3':>26}  again, million"
    )
    for figures in found:
        rates = " ".join(f"{figures.hit_rate(name):>11}" for name in LEVELS)
        known = figures.counters["cold_counted"]
        misses = " ".join(f"{figures.misses(name):>8.1f}" if known else f"{'?':>8}" for name in LEVELS)
        print(
            f"  {figures.megabytes:>5g} {figures.speed:>8.3f}  {rates:>36}  {misses}  {figures.again:>14.3f}",
            flush=True,
        )
    return {figures.megabytes: figures for figures in found}


class Reach:
    """What is to be reached, and what is."""

    def __init__(self) -> None:
        self.rows: list[Row] = []
        self.lines: list[str] = []

    def add(self, name: str, got: float, wanted: float, most: bool = False) -> None:
        """`most`: it is reached by being smaller."""
        reached = got <= wanted if most else got >= wanted
        sign = "<=" if most else ">="
        line = f"  {name:<76}{got:>10.4g}  ({sign} {wanted:g})  {'reached' if reached else 'NOT reached'}"
        print(line, flush=True)
        self.lines.append(line)
        self.rows.append({"name": name, "unit": f"({sign} {wanted:g})", "values": [got]})

    def tell(self) -> None:
        """All of it again, by rule: does one setting reach everything?"""
        for rule in RULES:
            print(f"\nReach {rule}, at {DEFAULT_BUDGET} MB where nothing else is said")
            others = tuple(f"  {each}: " for each in RULES if each != rule)
            print("\n".join(line for line in self.lines if not line.startswith(others)))


def embree(surface: Any, rays: Rays) -> tuple[float, float, float]:
    """Mrays/s, bytes and seconds to build of Embree's full grid."""
    begin = time.perf_counter()
    grid = rayleaf_rivals.EmbreeBaseline(surface, "GRID", eye=list(bench_trace.EYE))
    build = time.perf_counter() - begin
    plain = rays["origins"], rays["directions"]
    grid.timed_closest(*plain)
    seconds, _ = grid.timed_closest(*plain)
    return len(rays["origins"]) / seconds / 1e6, float(grid.bytes), build


def compare_fitting(reach: Reach, width: int) -> None:
    """A scene that fits: is it slower for having the cache?"""
    surface = bench_trace.scene(FITTING_RESOLUTION)
    rays = mixed_rays(made(surface, 1000, "MULTI", BY_DEFAULT)[0], width)
    speeds: dict[str, float] = {}
    for mode in ("NONE", "MULTI", "NONE", "MULTI"):
        speed = measured(made(surface, DEFAULT_BUDGET, mode, BY_DEFAULT)[0], rays, mode, DEFAULT_BUDGET)[0].speed
        speeds[mode] = max(speeds.get(mode, 0.0), speed)
    grid = embree(surface, rays)
    print(f"\nA scene that fits, {len(rays['origins'])} rays: {speeds['MULTI']:.3f} Mrays/s,", end=" ")
    print(f"without a cache {speeds['NONE']:.3f}, Embree's grid {grid[0]:.3f}")
    reach.add("a scene that fits: speed over no cache", speeds["MULTI"] / speeds["NONE"], 1.0)
    reach.add("a scene that fits: speed over Embree's grid", speeds["MULTI"] / grid[0], 1.0)


def compare_displaced(reach: Reach, name: str, surface: Any, width: int) -> None:
    """A surface whose vertices are costly, with memory for a fortieth of it."""
    begin = time.process_time()
    built = made(surface, 1000, "SINGLE")[0]
    seconds = time.process_time() - begin
    subpatches = built.statistics()["subpatches"]
    megabytes = 12e-6 * 289 * subpatches / 40
    # The build dices everything once, and some more to see that it is fine enough.
    nanoseconds = 1e9 * seconds / (289 * subpatches)
    print(f"\nDisplaced {name}, {subpatches} subpatches, {megabytes:.1f} MB, about {nanoseconds:.0f} ns a vertex")
    single = measured(made(surface, megabytes, "SINGLE")[0], mixed_rays(built, width), "SINGLE", megabytes)[0]
    told = {"single": single}
    for rule, distance in RULES.items():
        rays = mixed_rays(made(surface, 1000, "MULTI", distance)[0], width)
        multi, none = (
            measured(made(surface, size, mode, distance)[0], rays, mode, size)[0]
            for mode, size in (("MULTI", megabytes), ("NONE", 0.0))
        )
        told |= {f"multi, {rule}": multi, f"none, {rule}": none}
        each = f"{rule}: displaced {name}, {nanoseconds:.0f} ns a vertex: speed over"
        reach.add(f"{each} one resolution", multi.speed / single.speed, 10)
        reach.add(f"{each} no cache", multi.speed / none.speed, 1.0)
    for title, figures in told.items():
        print(f"  {title:<18}{figures.speed:>8.4f} Mrays/s {figures.diced / 1e6:>10.2f} million vertices a pass")


def compare_assumed(reach: Reach, rule: str, multi: Figures, single: Figures, none: Figures) -> None:
    """The cheapest displacement costs more than ASSUMED_NANOSECONDS: what those would make of the speeds measured."""
    print(
        f"  had each vertex cost {ASSUMED_NANOSECONDS} ns more, worked out from vertices and seconds of the same pass:"
    )
    for figures in (multi, single, none):
        counted = f"{figures.diced / 1e6:>10.2f} million vertices"
        print(f"    {figures.mode.lower():<8}{figures.displaced_speed():>8.4f} Mrays/s {counted}")
    ratio = multi.displaced_speed() / single.displaced_speed()
    reach.add(f"{rule}: {ASSUMED_NANOSECONDS} ns a vertex, worked out: speed over one resolution", ratio, 10)


def compare_rule(reach: Reach, rule: str, surface: Any, width: int, single: dict[float, Figures]) -> Figures:
    """Budgets by one rule of levels, and what is to be reached beside a single resolution and no cache."""
    distance = RULES[rule]
    rays = mixed_rays(made(surface, DEFAULT_BUDGET, "MULTI", distance)[0], width)
    multi = sweep(surface, rays, "MULTI", distance, f"multi, {rule}")
    none = measured(made(surface, 0, "NONE", distance)[0], rays, "NONE", 0)[0]
    print(f"  nothing kept: {none.speed:.3f} Mrays/s, {none.diced / 1e6:.1f} million vertices a pass")
    again = {size: max(figures.again, 1e-6) for size, figures in multi.items()}
    kept = multi[DEFAULT_BUDGET]
    ratio = single[DEFAULT_BUDGET].again / again[DEFAULT_BUDGET]
    reach.add(f"{rule}: vertices computed again, single over multi", ratio, 300)
    reach.add(f"{rule}: vertices computed again, 100 MB single over 1 MB multi", single[100].again / again[1], 10)
    reach.add(f"{rule}: speed over a single resolution", kept.speed / single[DEFAULT_BUDGET].speed, 1.0)
    reach.add(f"{rule}: speed over no cache", kept.speed / none.speed, 1.0)
    compare_assumed(reach, rule, kept, single[DEFAULT_BUDGET], none)
    return kept


def compare_embree(reach: Reach, surface: Any, rays: Rays, kept: dict[str, Figures]) -> None:
    """Embree's full grid against the default budget, by both rules."""
    tracer, build = made(surface, DEFAULT_BUDGET, "MULTI", BY_DEFAULT)
    held = tracer.statistics()
    cache = max(figures.counters["bytes"] for figures in kept.values())
    memory = cache + held["record_bytes"] + held["bvh_bytes"]
    print(f"\n{DEFAULT_BUDGET} MB: built in {build:.1f} s; cache {cache / 1e6:.0f},", end=" ")
    print(f"records {held['record_bytes'] / 1e6:.0f}, Embree's tree {held['bvh_bytes'] / 1e6:.0f} MB")
    if free_bytes() < 1.5 * EMBREE_BYTES_PER_SUBPATCH * held["subpatches"]:
        print("Embree's full grid: not measured, it needs more memory than is free")
        return
    del tracer
    speed, size, seconds = embree(surface, rays)
    print(f"Embree's full grid: {speed:.3f} Mrays/s, {size / 1e6:.0f} MB, built in {seconds:.1f} s")
    for rule, figures in kept.items():
        reach.add(f"{rule}: speed over Embree's full grid", figures.speed / speed, 1.15)
    reach.add("share of its memory, %", 100 * memory / size, 5, most=True)
    reach.add("its build time over the cache's", seconds / build, 30)


def run(quick: bool = False, small: bool = False) -> list[Row]:
    """Prints the tables; `quick`: 10^4 subpatches, to see that it works; `small`: 10^5, an eighth of the rays."""
    surface = bench_trace.scene(QUICK_RESOLUTION if quick else SMALL_RESOLUTION if small else RESOLUTION)
    reference, build = made(surface, 1000, "SINGLE")
    width = QUICK_WIDTH if quick else SMALL_WIDTH if small else WIDTH
    # Rays that leave a surface start on the facets of the mode.
    rays = mixed_rays(reference, width)
    subpatches = reference.statistics()["subpatches"]
    full = 12 * 289 * subpatches / 1e6
    count = len(rays["origins"])
    print(f"{subpatches} subpatches, {full:.0f} MB if all were diced, about {count} rays; built in {build:.2f} s")
    del reference
    reach = Reach()
    single = sweep(surface, rays, "SINGLE", BY_SIZE, "single")
    kept = {rule: compare_rule(reach, rule, surface, width, single) for rule in RULES}
    compare_embree(reach, surface, rays, kept)
    compare_fitting(reach, width)
    plain = bench_trace.scene(QUICK_DISPLACED_RESOLUTION if quick else DISPLACED_RESOLUTION)
    for name, displaced in (("evenly", offset(plain, 0.01)), ("by noise", hills(plain, 20.0, 0.01))):
        compare_displaced(reach, name, displaced, QUICK_DISPLACED_WIDTH if quick else DISPLACED_WIDTH)
    shells = QUICK_SHELL_RAYS * DISPLACED_SHARE if quick or small else SHELL_RAYS
    for displaced, share in ((False, shells - shells // DISPLACED_SHARE), (True, shells // DISPLACED_SHARE)):
        name = f"parity errors of {share} rays through a{' displaced' if displaced else ''} shell of mixed levels"
        reach.add(name, cracks_in_shells(share, displaced), 0, most=True)
    reach.tell()
    speeds = [
        {"name": f"{title}, {size:g} MB: speed", "unit": "Mrays/s", "values": [figures.speed]}
        for title, sizes in (("single", single), *((rule, {DEFAULT_BUDGET: kept[rule]}) for rule in RULES))
        for size, figures in sizes.items()
    ]
    return reach.rows + speeds
