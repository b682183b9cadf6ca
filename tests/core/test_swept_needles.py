"""Thin curves: no ray aimed at the axis is lost, at any radius and any distance from the origin."""

import numpy as np
import pytest
from core import shapes
from core import swept_support as swept
from rayleaf import _core

CONTROL = swept.segments(swept.BEND_POINTS, swept.BEND_HANDLES)
LENGTH = 2.5  # of the bend, about
RAYS = 8000


@pytest.mark.parametrize("offset", [0.0, 1e3, 1e6])
@pytest.mark.parametrize("share", [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6])
def test_rays_aimed_at_the_axis_hit_and_leave_again(share, offset):
    random = np.random.default_rng(31)
    radius = share * LENGTH
    shape = swept.bend(bevel_depth=radius, fill_caps=True)
    tracer = _core.trace.Tracer([(shape, shapes.moved(offset), shapes.EVERYTHING)], eye=(offset, offset, offset + 5))
    targets = swept.along(CONTROL, random.uniform(0, 1, RAYS))[0] + offset
    origins, directions = swept.rays_at(targets, 3.0, random)
    hits = tracer.closest_hits(origins, directions)
    lost = np.flatnonzero(hits["instance"] < 0)
    assert len(lost) == 0, f"{len(lost)} lost, from {origins[lost[:2]]!r} to {targets[lost[:2]]!r}"
    assert tracer.occluded(origins, directions).all()
    # Coordinates are rounded to 2^-53 of their size; that must not merge a strand's two walls.
    sums, _ = swept.balance(tracer, origins, directions, max(1e-12, 1e-15 * offset))
    assert np.count_nonzero(sums) == 0
    # Hits lie on the tube: no farther from the aim than a chord along the ray, and a facet's tolerance.
    assert tracer.statistics()["subpatches"] < 2000


@pytest.mark.parametrize("share", [1e-2, 1e-4, 1e-6])
def test_the_hit_of_a_thin_strand_lies_on_the_strand(share):
    random = np.random.default_rng(32)
    radius = share * LENGTH
    tracer = _core.trace.Tracer([(swept.bend(bevel_depth=radius), np.eye(4), shapes.EVERYTHING)], eye=(0, 0, 5))
    parameter = random.uniform(0.01, 0.99, RAYS)
    targets, tangent = swept.along(CONTROL, parameter)
    # From straight across, so that the hit is one radius before the axis.
    across = shapes.unit(np.cross(tangent, random.normal(size=targets.shape)))
    # From near, for another part of the curve may lie on the way from afar.
    hits = tracer.closest_hits(targets + 5 * radius * across, -across)
    center, _ = swept.along(CONTROL, hits["uv"][:, 0].astype(float))
    # The parameter is single precision: 1e-7 of the length along the strand, little across it.
    distance = np.linalg.norm(np.cross(hits["position"] - targets, tangent), axis=1)
    np.testing.assert_allclose(distance, radius, rtol=0.05 if share > 1e-5 else 0.3)
    assert np.linalg.norm(center - targets, axis=1).max() < 3 * radius + 1e-5
    assert np.sum(hits["normal"] * across, axis=1).min() > 0.9


def test_strands_of_very_different_radius_live_in_one_object():
    random = np.random.default_rng(33)
    radii = np.repeat(10.0 ** -np.arange(1, 7), 2)
    points = np.zeros((12, 3))
    points[1::2, 0] = 1.0
    points[:, 1] = np.repeat(np.arange(6) * 0.5, 2)
    splines = swept.splines("POLY", points, counts=[2] * 6, radii=radii)
    shape = _core.trace.SweptSurface(_core.SweptCurve("strands", [splines], bevel_depth=1.0, fill_caps=True))
    tracer = _core.trace.Tracer([(shape, np.eye(4), shapes.EVERYTHING)])
    strand = random.integers(0, 6, RAYS)
    targets = np.stack([random.uniform(0, 1, RAYS), strand * 0.5, np.zeros(RAYS)], axis=1)
    directions = np.tile([0.0, 0, -1], (RAYS, 1))
    hits = tracer.closest_hits(targets - 4 * directions, directions)
    assert (hits["instance"] == 0).all()
    np.testing.assert_allclose(hits["position"][:, 2], 10.0 ** -(strand + 1.0), rtol=0.05)
