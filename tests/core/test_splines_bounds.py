"""Boxes contain their patches, and no facet is further from its patch than the bound says."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st


def random_patch(core, degree_u, degree_v, seed, weight_exponent=0.0, center=0.0):
    rng = np.random.default_rng(seed)
    points = rng.uniform(-1, 1, (degree_v + 1, degree_u + 1, 4))
    points[..., :3] += center
    points[..., 3] = 10.0 ** rng.uniform(-weight_exponent, weight_exponent, points.shape[:2])
    return core.BezierPatch(points)


def grid(u, v):
    return tuple(array.ravel() for array in np.meshgrid(u, v))


patches = st.tuples(
    st.integers(1, 6), st.integers(1, 6), st.integers(0, 2**32 - 1), st.sampled_from([0.0, 0.15, 0.5, 2.0])
)


@given(patches, st.sampled_from([0.0, 1.0, 1000.0, 1e6]))
def test_a_box_contains_the_surface_also_after_rounding_to_float(core, net, center):
    patch = random_patch(core, *net, center=center)
    points = patch.evaluate(*grid(np.linspace(0, 1, 33), np.linspace(0, 1, 33)))[:, 0]
    low, high = patch.bounds()
    assert (points >= low).all() and (points <= high).all()
    float_low, float_high = patch.float_bounds()
    assert (points.astype(np.float32) >= float_low).all() and (points.astype(np.float32) <= float_high).all()
    assert (float_low.astype(np.float64) <= low).all() and (float_high.astype(np.float64) >= high).all()


def test_the_box_of_a_flat_patch_contains_every_rounding_of_its_plane(core):
    # All control points at x = 1/3: sums of products round to either side of it.
    points = np.random.default_rng(0).uniform(0.1, 1, (6, 6, 4))
    points[..., 0] = 1 / 3
    patch = core.BezierPatch(points)
    x = patch.evaluate(*grid(np.linspace(0, 1, 99), np.linspace(0, 1, 99)))[:, 0, 0]
    assert x.min() != x.max(), "this patch does not round, so it tests nothing"
    assert patch.bounds()[0, 0] <= x.min() and x.max() <= patch.bounds()[1, 0]


def test_the_box_touches_the_control_points(core):
    points = np.random.default_rng(1).uniform(-1, 1, (4, 4, 4))
    points[..., 3] = 1
    box = core.BezierPatch(points).bounds()
    assert np.allclose(box, [points[..., :3].min(axis=(0, 1)), points[..., :3].max(axis=(0, 1))], rtol=1e-13, atol=0)


def test_the_box_of_a_curve_contains_it(core):
    rng = np.random.default_rng(2)
    for degree in range(1, 9):
        points = rng.uniform(-1, 1, (degree + 1, 4))
        points[:, 3] = 10.0 ** rng.uniform(-2, 2, degree + 1)
        curve = core.BezierCurve(points)
        low, high = curve.bounds()
        values = curve.evaluate(np.linspace(0, 1, 500))[:, 0]
        assert (values >= low).all() and (values <= high).all()


SAMPLES = 8  # of each cell in each direction


def facet_distance(patch, cells_u, cells_v, facets):
    """The largest distance, at equal parameters, of points of a patch and of the facets of its grid."""
    fine_u, fine_v = np.linspace(0, 1, cells_u * SAMPLES + 1), np.linspace(0, 1, cells_v * SAMPLES + 1)
    u, v = grid(fine_u, fine_v)
    surface = patch.evaluate(u, v)[:, 0]
    corners = patch.evaluate(*grid(np.linspace(0, 1, cells_u + 1), np.linspace(0, 1, cells_v + 1)))[:, 0]
    corners = corners.reshape(cells_v + 1, cells_u + 1, 3)
    i = np.minimum((u * cells_u).astype(int), cells_u - 1)
    j = np.minimum((v * cells_v).astype(int), cells_v - 1)
    s, t = (u * cells_u - i)[:, None], (v * cells_v - j)[:, None]
    p00, p10, p01, p11 = corners[j, i], corners[j, i + 1], corners[j + 1, i], corners[j + 1, i + 1]
    bilinear = (1 - t) * ((1 - s) * p00 + s * p10) + t * ((1 - s) * p01 + s * p11)
    lower = np.where(s >= t, p00 + s * (p10 - p00) + t * (p11 - p10), p00 + t * (p01 - p00) + s * (p11 - p01))
    upper = np.where(
        s + t <= 1, p00 + s * (p10 - p00) + t * (p01 - p00), p11 + (1 - s) * (p01 - p11) + (1 - t) * (p10 - p11)
    )
    return np.linalg.norm(surface - {"bilinear": bilinear, "diagonal": lower, "other": upper}[facets], axis=1).max()


@given(patches, st.integers(1, 6), st.integers(1, 6), st.sampled_from(["bilinear", "diagonal", "other"]))
def test_facets_are_never_further_from_the_surface_than_the_bound(core, net, cells_u, cells_v, facets):
    patch = random_patch(core, *net)
    bound = patch.facet_distance_bound(cells_u, cells_v)
    assert facet_distance(patch, cells_u, cells_v, facets) <= bound + 1e-14  # roundings of coordinates below 1


@settings(max_examples=30)
@given(st.integers(0, 2**32 - 1), st.floats(2, 6))
def test_the_bound_holds_for_weights_up_to_a_million(core, seed, weight_exponent):
    patch = random_patch(core, 3, 3, seed, weight_exponent)
    for cells in (1, 4, 17):
        bound = patch.facet_distance_bound(cells, cells)
        assert facet_distance(patch, cells, cells, "diagonal") <= bound + 1e-14


def test_the_bound_is_attained_by_a_parabola(core):
    # z = u²/2: the chord over a cell of width h is h²/8 from it.
    points = np.array([[[0, 0, 0, 1], [0.5, 0, 0, 1], [1, 0, 0.5, 1]], [[0, 1, 0, 1], [0.5, 1, 0, 1], [1, 1, 0.5, 1]]])
    patch = core.BezierPatch(points.astype(float))
    for cells in (1, 2, 7):
        assert math.isclose(patch.facet_distance_bound(cells, 1), 1 / 8 / cells**2, rel_tol=1e-12)
        assert math.isclose(facet_distance(patch, cells, 1, "bilinear"), 1 / 8 / cells**2, rel_tol=1e-9)


def test_the_bound_of_a_flat_parallelogram_is_nothing(core):
    points = np.array([[[i, j, i + j, 1.0] for i in range(4)] for j in range(4)])
    assert core.BezierPatch(points).facet_distance_bound(1, 1) < 1e-14


@pytest.mark.parametrize("weight_exponent, looseness", [(0.0, 3), (0.15, 6), (0.5, 6)])
def test_the_bound_is_not_wasteful(core, weight_exponent, looseness):
    """The median over random bicubic patches; grids become finer than needed by its root."""
    ratios = []
    for seed in range(40):
        patch = random_patch(core, 3, 3, seed, weight_exponent)
        ratios.append(patch.facet_distance_bound(16, 16) / facet_distance(patch, 16, 16, "diagonal"))
    assert min(ratios) >= 1 and np.median(ratios) < looseness, np.percentile(ratios, [10, 50, 90])


def test_the_bound_shrinks_with_the_square_of_the_cells(core):
    patch = random_patch(core, 3, 3, 1, 0.15)
    assert math.isclose(patch.facet_distance_bound(64, 64) * 16, patch.facet_distance_bound(16, 16), rel_tol=1e-12)
