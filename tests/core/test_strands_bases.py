"""Hair curves of mixed types turned into Bezier curves: the same curves."""

import numpy as np
import pytest
from core.strand_shapes import bezier_points, strand, tracer
from rayleaf.export import curve_bases as bases


POINTS = np.random.default_rng(4).random((7, 4))


def along(bezier, t):
    """Points of a chain of cubic Bezier pieces at t, counted in pieces."""
    piece = min(int(t), (len(bezier) - 1) // 3 - 1)
    return bezier_points(bezier[3 * piece : 3 * piece + 4], np.array([t - piece]))[0]


@pytest.mark.parametrize("cyclic", [False, True])
def test_a_polygon_runs_evenly_between_its_points(cyclic):
    bezier = bases.linear_as_bezier(POINTS, cyclic)
    assert len(bezier) == 3 * (len(POINTS) - (not cyclic)) + 1
    assert np.allclose(along(bezier, 2.25), POINTS[2] * 0.75 + POINTS[3] * 0.25)
    assert np.allclose(bezier[-1], POINTS[0] if cyclic else POINTS[-1])


@pytest.mark.parametrize("cyclic", [False, True])
def test_catmull_rom_as_bezier_is_what_the_core_makes_of_it(cyclic):
    bezier = bases.catmull_rom_as_bezier(POINTS, cyclic)
    random = np.random.default_rng(1)
    target, direction = random.random((500, 3)), random.normal(size=(500, 3))
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    flag = np.array([cyclic], np.uint8)
    own = tracer(strand(POINTS[:, :3], 0.1, cyclic=flag)).closest_hits(target - 5 * direction, direction)["t"]
    other = tracer(strand(bezier[:, :3], 0.1, basis="BEZIER")).closest_hits(target - 5 * direction, direction)["t"]
    found = np.isfinite(own)
    assert found.sum() > 50 and np.array_equal(found, np.isfinite(other))
    assert np.allclose(own[found], other[found], atol=1e-9)


def test_bezier_handles_stay_and_the_radius_runs_evenly():
    left, right = POINTS[:, :3] - 0.1, POINTS[:, :3] + 0.2
    bezier = bases.bezier_with_handles(POINTS, left, right, False)
    assert np.allclose(bezier[1, :3], right[0]) and np.allclose(bezier[2, :3], left[1])
    assert np.allclose(along(bezier, 0.5)[3], POINTS[:2, 3].mean())


def test_a_nurbs_curve_is_followed_within_its_samples(core):
    bezier = bases.nurbs_as_bezier(core, POINTS, 4, True, False, False)
    exact = core.NurbsCurve(np.hstack([POINTS[:, :3], np.ones((7, 1))]), 4, endpoint=True).to_bezier()
    samples = exact.positions(np.linspace(0, 1, 801))
    t = np.linspace(0.0, (len(bezier) - 1) // 3, 200, endpoint=False)
    off = [np.linalg.norm(samples - along(bezier, each)[:3], axis=1).min() for each in t]
    assert max(off) < 5e-3
