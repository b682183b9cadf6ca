"""Grids of bevelled curves take 16 bits a coordinate where that is fine enough, and are folded around long tubes."""

import numpy as np
import pytest
from core import shapes
from core import swept_support as swept
from rayleaf import _core

# Bytes of a grid in steps and of one in 32 bits, both with their bookkeeping.
STEPS, WHOLE = 2624, 5184


def bytes_of_a_grid(tracer, rays) -> float:
    """Memory of the fine level per grid. A thread without a slot dices into its own memory, so rays are repeated
    until every grid is kept. They are one chunk, for one thread: each thread may keep a slot that it did not fill."""
    for _ in range(10):
        before = tracer.statistics()["geometry_cache"]["levels"]["fine"]
        tracer.closest_hits(*rays, together=len(rays[0]))
        level = tracer.statistics()["geometry_cache"]["levels"]["fine"]
        if level["diced"] == before["diced"]:
            return level["bytes"] / level["cold"]
    raise AssertionError("grids are diced again and again")


def traced(depth: float, pixel_angle: float):
    """A bent rod seen from the side, the rays, and the distance of its hits from those of the finest one, in radii."""
    random = np.random.default_rng(31)
    axis = swept.along(swept.segments(swept.BEND_POINTS, swept.BEND_HANDLES), random.uniform(0.02, 0.98, 20_000))[0]
    rays = swept.rays_at(axis + random.uniform(-depth, depth, axis.shape), 3.0, random)
    found = []
    for angle in (pixel_angle, 1e-6):
        surface = swept.bend(bevel_depth=depth, fill_caps=True)
        tracer = _core.trace.Tracer([(surface, np.eye(4), shapes.EVERYTHING)], pixel_angle=angle, eye=(0, 0, 5))
        found.append((tracer, tracer.closest_hits(*rays, together=len(rays[0]))["t"]))
    (tracer, t), (_, exact) = found
    both = np.isfinite(t) & np.isfinite(exact)
    # Chords of a thin strand lie up to a quarter of its radius beside it.
    assert np.mean(np.isfinite(t) != np.isfinite(exact)) < 0.1
    return tracer, rays, np.median(np.abs(t[both] - exact[both])) / depth


@pytest.mark.parametrize("depth", [0.02, 0.05])
def test_a_tube_of_visible_width_takes_half_the_memory(depth):
    tracer, rays, distance = traced(depth, 1e-3)
    assert bytes_of_a_grid(tracer, rays) == pytest.approx(STEPS, rel=0.05)  # the last unit may be half full
    # Facets lie within a quarter of the radius at the most, and mostly much nearer.
    assert distance < 0.02


@pytest.mark.parametrize(("depth", "pixel_angle"), [(1e-5, 1e-3), (0.1, 1e-5)])
def test_thin_strands_and_fine_views_keep_32_bits(depth, pixel_angle):
    tracer, rays, _ = traced(depth, pixel_angle)
    assert bytes_of_a_grid(tracer, rays) == pytest.approx(WHOLE, rel=0.05)


def test_places_on_folded_grids_are_those_of_the_surface():
    surface = swept.bend(bevel_depth=0.05)
    tracer = _core.trace.Tracer([(surface, np.eye(4), shapes.EVERYTHING)], eye=(0, 0, 5))
    random = np.random.default_rng(32)
    axis = swept.along(swept.segments(swept.BEND_POINTS, swept.BEND_HANDLES), random.uniform(0.02, 0.98, 5000))[0]
    origins, directions = swept.rays_at(axis, 3.0, random)
    hits = tracer.closest_hits(origins, directions)
    found = hits["instance"] >= 0
    assert found.mean() > 0.95
    # The exact surface at the hit's parameters lies where the facet was hit: a wrong block would be a tube's width off.
    off = np.linalg.norm((hits["position"] - hits["facet_position"])[found], axis=1)
    assert off.max() < 0.1 * 0.05
