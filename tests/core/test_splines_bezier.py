"""Bezier curves and patches of any degree against exact arithmetic and closed forms."""

import math

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

mpmath.mp.dps = 60

DEGREES = range(1, 13)
PARAMETERS = np.array([0.0, 1.0, 0.5, 1 / 3, 1e-9, 1 - 1e-9, 0.73])


def random_net(rng, *counts, weight_exponent=6.0):
    """Control points below 1 with weights 10^-e .. 10^e; e = 0 makes them polynomial."""
    points = rng.uniform(-1, 1, (*counts, 4))
    points[..., 3] = 10.0 ** rng.uniform(-weight_exponent, weight_exponent, counts)
    return points


def exact_basis(degree, t):
    """Values and two derivatives of the Bernstein polynomials, in 60 digits."""
    t = mpmath.mpf(float(t))

    def value(i, n):
        return mpmath.binomial(n, i) * t**i * (1 - t) ** (n - i) if 0 <= i <= n else mpmath.mpf(0)

    n = degree
    first = [n * (value(i - 1, n - 1) - value(i, n - 1)) for i in range(n + 1)]
    second = [n * (n - 1) * (value(i - 2, n - 2) - 2 * value(i - 1, n - 2) + value(i, n - 2)) for i in range(n + 1)]
    return [value(i, n) for i in range(n + 1)], first, second


def exact_sum(points, basis):
    """Homogeneous combination of (n, 4) points x, y, z, weight."""
    out = [mpmath.mpf(0)] * 4
    for (x, y, z, w), b in zip(points.tolist(), basis):
        for axis, coordinate in enumerate((x, y, z, 1.0)):
            out[axis] += mpmath.mpf(coordinate) * mpmath.mpf(w) * b
    return out


def exact_curve(points, t):
    """Position, first and second derivative."""
    a, a1, a2 = (exact_sum(points, basis) for basis in exact_basis(len(points) - 1, t))
    w, w1, w2 = a[3], a1[3], a2[3]
    p = [c / w for c in a[:3]]
    p1 = [(c - x * w1) / w for c, x in zip(a1, p)]
    p2 = [(c - 2 * d * w1 - x * w2) / w for c, d, x in zip(a2, p1, p)]
    return np.array([[float(x) for x in row] for row in (p, p1, p2)])


def exact_patch(points, u, v):
    """P, P_u, P_v, P_uu, P_uv, P_vv."""
    basis_u, basis_v = exact_basis(points.shape[1] - 1, u), exact_basis(points.shape[0] - 1, v)
    flat = points.reshape(-1, 4)

    def derivative(i, j):
        return exact_sum(flat, [a * b for b in basis_v[j] for a in basis_u[i]])

    a, au, av, auu, auv, avv = (derivative(*order) for order in ((0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2)))
    w = a[3]
    p = [x / w for x in a[:3]]
    pu = [(au[k] - p[k] * au[3]) / w for k in range(3)]
    pv = [(av[k] - p[k] * av[3]) / w for k in range(3)]
    puu = [(auu[k] - 2 * pu[k] * au[3] - p[k] * auu[3]) / w for k in range(3)]
    puv = [(auv[k] - pu[k] * av[3] - pv[k] * au[3] - p[k] * auv[3]) / w for k in range(3)]
    pvv = [(avv[k] - 2 * pv[k] * av[3] - p[k] * avv[3]) / w for k in range(3)]
    return np.array([[float(x) for x in row] for row in (p, pu, pv, puu, puv, pvv)])


def relative_error(value, exact):
    """Largest difference of each vector, by the largest coordinate of the exact one or 1."""
    return np.abs(value - exact).max(axis=-1) / np.maximum(np.abs(exact).max(axis=-1), 1.0)


# Roundings: a position sums degree + 1 products of basis values with at most 3 degree roundings each; measured 4e-16,
# whatever the weights. Derivatives subtract P w' from A', which cancels where weights differ: measured 5e-15, 8e-14 with
# weights from a millionth to a million.
POSITION_TOLERANCE = 1e-15
DERIVATIVE_TOLERANCE = 3e-13


@pytest.mark.parametrize("degree", DEGREES)
@pytest.mark.parametrize("weight_exponent", [0.0, 0.5, 6.0])
def test_a_curve_and_its_derivatives_match_exact_arithmetic(core, degree, weight_exponent):
    points = random_net(np.random.default_rng(degree), degree + 1, weight_exponent=weight_exponent)
    curve = core.BezierCurve(points)
    assert (curve.degree, curve.rational) == (degree, weight_exponent > 0)
    for t, value in zip(PARAMETERS, curve.evaluate(PARAMETERS)):
        error = relative_error(value, exact_curve(points, t))
        assert error[0] < POSITION_TOLERANCE and error.max() < DERIVATIVE_TOLERANCE, (t, error)


@pytest.mark.parametrize("degrees", [(1, 1), (3, 3), (2, 5), (7, 1), (1, 12), (9, 8), (12, 12)])
@pytest.mark.parametrize("weight_exponent", [0.0, 0.5, 6.0])
def test_a_patch_and_its_derivatives_match_exact_arithmetic(core, degrees, weight_exponent):
    degree_u, degree_v = degrees
    points = random_net(np.random.default_rng(7), degree_v + 1, degree_u + 1, weight_exponent=weight_exponent)
    patch = core.BezierPatch(points)
    assert (patch.degree_u, patch.degree_v) == degrees
    u, v = PARAMETERS, PARAMETERS[::-1].copy()
    for a, b, value in zip(u, v, patch.evaluate(u, v)):
        error = relative_error(value, exact_patch(points, a, b))
        assert error[0] < POSITION_TOLERANCE and error.max() < DERIVATIVE_TOLERANCE, (a, b, error)


def test_degrees_beyond_the_stack_buffers_are_evaluated_too(core):
    points = random_net(np.random.default_rng(3), 19, 18, weight_exponent=0.5)
    value = core.BezierPatch(points).evaluate(np.array([0.3]), np.array([0.6]))[0]
    assert relative_error(value, exact_patch(points, 0.3, 0.6)).max() < DERIVATIVE_TOLERANCE


def test_a_quarter_circle_is_round_to_a_rounding(core):
    circle = core.BezierCurve(np.array([[1, 0, 0, 1], [1, 1, 0, math.sqrt(0.5)], [0, 1, 0, 1]]))
    points = circle.evaluate(np.linspace(0, 1, 1001))[:, 0]
    assert np.abs(np.hypot(points[:, 0], points[:, 1]) - 1).max() <= 1e-15


def octant(radius=1.0):
    """An eighth of a sphere, with its pole at v = 1, as a biquadratic patch: x, y, z, weight."""
    arc = np.array([[1, 0, 1], [1, 1, math.sqrt(0.5)], [0, 1, 1]])
    points = np.array([[(x * a, y * a, b, w * g) for x, y, w in arc] for a, b, g in arc])
    points[..., :3] *= radius
    return points


def test_an_octant_of_a_sphere_has_the_radius_and_curvature_of_the_sphere(core):
    u, v = (grid.ravel() for grid in np.meshgrid(np.linspace(0, 1, 21), np.linspace(0, 0.95, 20)))
    p, pu, pv, puu, puv, pvv = np.moveaxis(core.BezierPatch(octant()).evaluate(u, v), 1, 0)
    assert np.abs(np.linalg.norm(p, axis=1) - 1).max() < 2e-15

    def dot(a, b):
        return (a * b).sum(axis=1)

    # On the unit sphere P·P = 1: its derivatives are P·P_u = 0, P·P_uu = -P_u·P_u and so on.
    assert max(np.abs(dot(p, pu)).max(), np.abs(dot(p, pv)).max()) < 1e-14
    for second, a, b in ((puu, pu, pu), (puv, pu, pv), (pvv, pv, pv)):
        assert np.abs(dot(p, second) + dot(a, b)).max() < 1e-13


nets = st.tuples(st.integers(1, 7), st.integers(1, 7), st.integers(0, 2**32 - 1), st.sampled_from([0.0, 0.5, 3.0]))
inner = st.floats(0.01, 0.99)
GRID_U, GRID_V = (grid.ravel() for grid in np.meshgrid(np.linspace(0, 1, 5), np.linspace(0, 1, 5)))


def make_patch(core, net):
    degree_u, degree_v, seed, weight_exponent = net
    points = random_net(np.random.default_rng(seed), degree_v + 1, degree_u + 1, weight_exponent=weight_exponent)
    return core.BezierPatch(points)


def positions(patch, u=GRID_U, v=GRID_V):
    return patch.evaluate(u, v)[:, 0]


# De Casteljau adds one rounding a level and keeps weights positive, so points of parts differ by a few roundings of
# numbers below 1. Parameters are rounded as well, and uneven weights make points run fast along the border.
def same_surface_tolerance(net):
    return 4e-15 * 10.0 ** net[3]


@given(nets, inner, st.sampled_from("UV"))
def test_both_parts_of_a_split_patch_lie_on_it(core, net, t, direction):
    patch = make_patch(core, net)
    low, high = patch.split(direction, t)
    if direction == "U":
        expected = positions(patch, GRID_U * t, GRID_V), positions(patch, t + GRID_U * (1 - t), GRID_V)
        borders = low.points[:, -1], high.points[:, 0]
    else:
        expected = positions(patch, GRID_U, GRID_V * t), positions(patch, GRID_U, t + GRID_V * (1 - t))
        borders = low.points[-1], high.points[0]
    for part, points in zip((low, high), expected):
        assert np.abs(positions(part) - points).max() < same_surface_tolerance(net)
    assert np.array_equal(*borders), "the parts do not share their border bit by bit"


@given(nets, st.lists(inner, min_size=4, max_size=4, unique=True))
def test_a_restricted_patch_is_that_part(core, net, ends):
    patch = make_patch(core, net)
    (u0, u1), (v0, v1) = sorted(ends[:2]), sorted(ends[2:])
    part = patch.restricted(u0, u1, v0, v1)
    expected = positions(patch, u0 + GRID_U * (u1 - u0), v0 + GRID_V * (v1 - v0))
    assert np.abs(positions(part) - expected).max() < same_surface_tolerance(net)


@given(nets)
def test_restricting_to_everything_changes_nothing(core, net):
    patch = make_patch(core, net)
    assert np.array_equal(patch.restricted(0, 1, 0, 1).points, patch.points)


@given(nets, st.sampled_from("UV"))
def test_elevation_keeps_the_surface(core, net, direction):
    patch = make_patch(core, net)
    elevated = patch.elevated(direction)
    assert elevated.degree_u + elevated.degree_v == patch.degree_u + patch.degree_v + 1
    assert np.abs(positions(elevated) - positions(patch)).max() < same_surface_tolerance(net)


@given(st.integers(1, 9), st.integers(0, 2**32 - 1), inner)
def test_splitting_restricting_and_elevating_keep_a_curve(core, degree, seed, t):
    curve = core.BezierCurve(random_net(np.random.default_rng(seed), degree + 1, weight_exponent=0.5))
    s = np.linspace(0, 1, 9)
    low, high = curve.split(t)
    assert np.array_equal(low.points[-1], high.points[0])

    def off(part, parameters):
        return np.abs(part.evaluate(s)[:, 0] - curve.evaluate(parameters)[:, 0]).max()

    assert off(low, s * t) < 4e-14
    assert off(high, t + s * (1 - t)) < 4e-14
    assert off(curve.restricted(t / 2, t), t / 2 + s * t / 2) < 4e-14
    assert off(curve.elevated(), s) < 4e-14


def test_patches_that_share_a_border_row_share_its_points_bit_by_bit(core):
    rng = np.random.default_rng(5)
    left, right = (random_net(rng, 4, 4, weight_exponent=0.5) for _ in range(2))
    right[:, 0] = left[:, -1]
    v = rng.uniform(0, 1, 500)
    a = core.BezierPatch(left).evaluate(np.ones(500), v)
    b = core.BezierPatch(right).evaluate(np.zeros(500), v)
    for derivative in (0, 2, 5):  # P, P_v, P_vv
        assert np.array_equal(a[:, derivative], b[:, derivative])


@pytest.mark.parametrize("weight", [0.0, -1.0, math.nan, math.inf])
def test_control_points_without_a_positive_weight_are_refused(core, weight):
    points = np.ones((3, 3, 4))
    points[1, 1, 3] = weight
    with pytest.raises(core.InputError, match="weight"):
        core.BezierPatch(points)


def test_arrays_of_a_wrong_shape_are_refused_by_name(core):
    with pytest.raises(core.InputError, match="points is an array of shape"):
        core.BezierPatch(np.ones((3, 4)))
    with pytest.raises(core.InputError, match="v is an array of shape"):
        core.BezierPatch(np.ones((3, 3, 4))).evaluate(np.zeros(3), np.zeros(2))
    with pytest.raises(core.InputError, match="direction is 'X'"):
        core.BezierPatch(np.ones((3, 3, 4))).split("X", 0.5)
