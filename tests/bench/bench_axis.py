"""No ray aimed at the axis of a thin curve is lost, and rays enter a glass rod as often as they leave it: 10^6 each.

Curves are a bent segment of length about 1, its radius from 1e-1 to 1e-6 of that, at distances from the origin up to 1e6,
as swept patch and as round strand. Rods are straight, bent, knotted, and a knot so thick that it touches itself.
"""

import time
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rayleaf import _core

Doubles = NDArray[np.float64]
Tracer = _core.trace.Tracer

PRINTS_ITSELF = True
CONTROL = np.array([[0, 0, 0], [0.4, 0.3, 0.1], [0.6, -0.3, 0.2], [1, 0, 0]])
RADII = (1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6)
OFFSETS = (0.0, 1e2, 1e4, 1e6)
# What a ray is moved on behind a facet, of the size of its coordinates: facets closer together count once.
STEP = 1e-12
MOST_FACETS = 200


def weighted(points: Doubles) -> Doubles:
    """Points with weight 1."""
    return np.hstack([points, np.ones((len(points), 1))])


def bent(radius: float, form: str) -> Any:
    """The segment as a swept patch with caps, or as a round strand."""
    if form == "round strand":
        radii, offsets = np.full(4, radius, np.float32), np.array([0, 4], np.int32)
        return _core.Strands("S", CONTROL, radii, offsets, basis="BEZIER")
    handles = np.stack([CONTROL[[0, 2]], CONTROL[[1, 3]]], axis=1)
    splines = _core.CurveSplines("BEZIER", np.array([2], np.int32), weighted(CONTROL[[0, 3]]), handles=handles)
    return _core.trace.SweptSurface(_core.SweptCurve("S", [splines], bevel_depth=radius, fill_caps=True))


def aimed(count: int, seed: int) -> tuple[Doubles, Doubles]:
    """Points of the axis, and directions."""
    random = np.random.default_rng(seed)
    directions = random.normal(size=(count, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    t = random.uniform(0.001, 0.999, count)[:, None]
    axis = (1 - t) ** 3 * CONTROL[0] + 3 * t * (1 - t) ** 2 * CONTROL[1] + 3 * t * t * (1 - t) * CONTROL[2]
    return axis + t**3 * CONTROL[3], directions


def table_of_axis_hits(count: int) -> list[dict[str, Any]]:
    """Prints how many rays are lost, which must be none."""
    axis, directions = aimed(count, 5)
    rows = []
    print(f"  of {count:,} rays aimed at the axis are lost, by radius over length and distance from the origin")
    print(f"  {'':16}" + "".join(f"{f'{radius:.0e}':>10}" for radius in RADII))
    for form in ("swept patch", "round strand"):
        for offset in OFFSETS:
            lost = []
            for radius in RADII:
                matrix = np.eye(4)
                matrix[:3, 3] = offset
                tracer = Tracer([(bent(radius, form), matrix, 31)], eye=(offset, offset, offset + 3))
                _, t = tracer.timed_closest(axis + offset - 3 * directions, directions)
                lost.append(int(np.count_nonzero(~np.isfinite(t))))
            name = f"{form}, {offset:g}"
            print(f"  {name:16}" + "".join(f"{each:>10}" for each in lost), flush=True)
            rows.append({"name": f"lost axis hits: {form} at {offset:g}", "unit": "rays", "values": lost})
            assert not any(lost), f"{name}: {lost}"
    return rows


def knot(radius: float) -> Any:
    """A closed NURBS curve that winds about a torus."""
    angle = np.linspace(0, 2 * np.pi, 24, endpoint=False)
    ring = 2 + np.cos(3 * angle)
    points = np.stack([ring * np.cos(2 * angle), ring * np.sin(2 * angle), np.sin(3 * angle)], axis=1)
    splines = _core.CurveSplines("NURBS", np.array([24], np.int32), weighted(points), order=4, cyclic=True)
    return _core.trace.SweptSurface(_core.SweptCurve("knot", [splines], bevel_depth=radius))


def straight() -> Any:
    """A rod with two flat ends."""
    points = np.array([[0, 0, 0], [1, 0.2, 0.1]])
    splines = _core.CurveSplines("POLY", np.array([2], np.int32), weighted(points))
    return _core.trace.SweptSurface(_core.SweptCurve("rod", [splines], bevel_depth=0.05, fill_caps=True))


RODS: dict[str, Callable[[], Any]] = {
    "straight": straight,
    "bent": lambda: bent(0.05, "swept patch"),
    "bent strand": lambda: bent(0.05, "round strand"),
    "knotted": lambda: knot(0.5),
    "touching itself": lambda: knot(0.9),
}


def balance(tracer: Any, origins: Doubles, directions: Doubles) -> tuple[Any, int]:
    """(entries minus exits of each ray, all hits); rays are followed through everything."""
    sums, start, alive, hits = np.zeros(len(origins), int), np.zeros(len(origins)), np.arange(len(origins)), 0
    for _ in range(MOST_FACETS):
        found = tracer.closest_hits(origins[alive], directions[alive], t_min=start[alive])
        got = found["instance"] >= 0
        side = np.sum(found["facet_normal"][got].astype(float) * directions[alive[got]], axis=1)
        alive = alive[got]
        sums[alive] -= np.sign(side).astype(int)
        start[alive] = found["t"][got] + STEP * max(1.0, np.abs(origins).max())
        hits += len(alive)
        if len(alive) == 0:
            return sums, hits
    raise AssertionError(f"{len(alive)} rays still hit after {MOST_FACETS} facets")


def table_of_rods(count: int) -> list[dict[str, Any]]:
    """Prints entries and exits, which must be equal for every ray."""
    rows = []
    print(f"\n  {count:,} rays through glass rods: hits, and rays that enter more or less often than they leave")
    for name, make in RODS.items():
        began = time.perf_counter()
        tracer = Tracer([(make(), np.eye(4), 31)], eye=(0, 0, 5))
        low, high = np.array(tracer.bounds())
        random = np.random.default_rng(17)
        directions = random.normal(size=(count, 3))
        directions /= np.linalg.norm(directions, axis=1, keepdims=True)
        origins = random.uniform(low, high, (count, 3)) - 2 * np.linalg.norm(high - low) * directions
        sums, hits = balance(tracer, origins, directions)
        wrong = int(np.count_nonzero(sums))
        print(f"  {name:16} {hits:>12,} hits {wrong:>6} wrong {time.perf_counter() - began:>8.1f} s", flush=True)
        rows.append({"name": f"unequal entries and exits: {name}", "unit": "rays", "values": [wrong]})
        assert wrong == 0, f"{name}: {origins[sums != 0][:2]!r} towards {directions[sums != 0][:2]!r}"
    return rows


def run(quick: bool = False) -> list[dict[str, Any]]:
    """Both tables."""
    count = 2_000 if quick else 1_000_000
    return table_of_axis_hits(count) + table_of_rods(count)
