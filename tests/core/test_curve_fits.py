"""Curves as other primitives: the finer they are, the nearer to the round curve, up to the same picture."""

import numpy as np
import pytest
from core.strand_shapes import S_CURVE, strand, tracer

RADIUS = 0.05


def bevelled(core, scale):
    """A curve of one S-shaped Bezier segment with a round bevel."""
    points, handles = np.zeros((2, 4)), np.zeros((2, 2, 3))
    points[:, :3], points[:, 3] = S_CURVE[[0, 3]] * scale, 1.0
    handles[0, 1], handles[1, 0] = S_CURVE[1] * scale, S_CURVE[2] * scale
    handles[0, 0], handles[1, 1] = points[0, :3], points[1, :3]
    splines = core.CurveSplines("BEZIER", np.array([2], np.int32), points, handles=handles)
    return core.SweptCurve("curve", [splines], bevel_depth=RADIUS * scale)


def rays(scale):
    """Rays from all sides through the middle of the curve, away from its ends."""
    random = np.random.default_rng(3)
    directions = random.normal(size=(4000, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    targets = random.uniform([0.2, -0.1, 0.0], [0.8, 0.1, 0.2], (4000, 3))
    return (targets - 5 * directions) * scale, directions


def distances(shape, scale=1.0):
    """Of the hits of `rays`, over the scale."""
    origins, directions = rays(scale)
    return tracer(shape).closest_hits(origins, directions)["t"] / scale


def difference(t, reference):
    """(share of rays that hit only one of them, median difference of the others)."""
    hit, wanted = np.isfinite(t), np.isfinite(reference)
    return np.mean(hit != wanted), np.median(np.abs(t[hit & wanted] - reference[hit & wanted]))


@pytest.mark.parametrize("scale", [1.0, 10.0, 1e-3])
def test_strands_along_a_bevelled_curve_are_its_swept_surface(core, scale):
    curve = bevelled(core, scale)
    origins, directions = rays(scale)
    swept = core.trace.Tracer([(core.trace.SweptSurface(curve), np.eye(4), 31)], pixel_angle=1e-5)  # fine facets
    exact = swept.closest_hits(origins, directions)["t"] / scale
    assert np.isfinite(exact).mean() > 0.2
    missed, off = difference(distances(core.strands_along(curve), scale), exact)
    assert missed < 2e-3 and off < 1e-4 * RADIUS


@pytest.mark.parametrize("primitive", ["TRIANGLES", "QUADS", "SPHERES"])
def test_a_primitive_comes_as_near_as_its_detail_is_fine(core, primitive):
    def shape(detail):
        if primitive == "SPHERES":
            return strand(S_CURVE, RADIUS, basis="BEZIER", form="SPHERES", spheres_per_segment=4 * detail)
        return core.strand_tubes(strand(S_CURVE, RADIUS, basis="BEZIER"), detail, detail, primitive)

    reference = distances(strand(S_CURVE, RADIUS, basis="BEZIER"))
    coarse, fine = (difference(distances(shape(detail)), reference) for detail in (16, 128))
    # Chords and the gaps between balls fall with the square of the step: eight times finer is 64 times nearer.
    assert fine[1] < coarse[1] / 30 and fine[1] < 1e-3 * RADIUS
    assert fine[0] <= coarse[0] and fine[0] < 2e-3


def test_triangles_and_quads_of_one_tube_are_hit_alike(core):
    round_strand = strand(S_CURVE, RADIUS, basis="BEZIER")
    triangles, quads = (distances(core.strand_tubes(round_strand, 16, 16, facets)) for facets in ("TRIANGLES", "QUADS"))
    assert np.array_equal(triangles, quads)


def test_embrees_round_curve_is_ours_where_it_works():
    reference = distances(strand(S_CURVE, RADIUS, basis="BEZIER"))
    missed, off = difference(distances(strand(S_CURVE, RADIUS, basis="BEZIER", form="EMBREE_ROUND")), reference)
    assert missed < 2e-3 and off < 1e-5 * RADIUS


def test_a_ribbon_covers_what_the_round_strand_covers():
    reference = distances(strand(S_CURVE, RADIUS, basis="BEZIER"))
    hit = np.isfinite(distances(strand(S_CURVE, RADIUS, basis="BEZIER", form="RIBBON")))
    assert np.mean(hit != np.isfinite(reference)) < 5e-3


def test_only_a_full_round_profile_becomes_strands(core):
    splines = core.CurveSplines("POLY", np.array([2], np.int32), np.array([[0, 0, 0, 1], [1, 0, 0, 1.0]]))
    assert core.strands_along(core.SweptCurve("curve", [splines], bevel_depth=0.1)) is not None
    assert core.strands_along(core.SweptCurve("curve", [splines], bevel_depth=0.1, extrude=0.1)) is None
    assert core.strands_along(core.SweptCurve("curve", [splines], bevel_depth=0.1, fill="BACK")) is None


@pytest.mark.parametrize("rings, sides, word", [(0, 8, "rings"), (4, 2, "sides"), (4, 5000, "sides")])
def test_a_tube_that_cannot_be_is_refused(core, rings, sides, word):
    with pytest.raises(core.InputError, match=word):
        core.strand_tubes(strand(S_CURVE, RADIUS, basis="BEZIER"), rings, sides)
