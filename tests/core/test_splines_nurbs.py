"""NURBS to Bezier form: against de Boor's definition in exact arithmetic, with bit-equal borders and correct continuity."""

import itertools
import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

FLAGS = list(itertools.product((False, True), repeat=3))  # cyclic, endpoint, bezier
CASES = [(order, count, *flags) for order in range(2, 7) for count in range(2, 14) for flags in FLAGS]


def exists(core, count, order, cyclic=False, endpoint=False, bezier=False):
    points = np.ones((count, 4))
    return core.NurbsCurve(points, order, cyclic, endpoint, bezier).problem() is None


def drawn(core):
    return [case for case in CASES if exists(core, case[1], case[0], *case[2:])]


def exact_basis(knots, index, order, t):
    """The B-spline N_index of that order, by the recurrence of Cox and de Boor, in rational numbers."""
    if order == 1:
        return Fraction(int(knots[index] <= t < knots[index + 1]))
    total = Fraction(0)
    low, high = knots[index + order - 1] - knots[index], knots[index + order] - knots[index + 1]
    if low:
        total += (t - knots[index]) / low * exact_basis(knots, index, order - 1, t)
    if high:
        total += (knots[index + order] - t) / high * exact_basis(knots, index + 1, order - 1, t)
    return total


def exact_point(points, knots, order, t):
    """A point of the NURBS curve, points x, y, z, weight repeating cyclically."""
    sums = [Fraction(0)] * 4
    for i in range(len(knots) - order):
        basis = exact_basis(knots, i, order, t)
        if basis:
            x, y, z, w = (Fraction(c) for c in points[i % len(points)].tolist())
            sums = [s + basis * w * c for s, c in zip(sums, (x, y, z, Fraction(1)))]
    return [float(c / sums[3]) for c in sums[:3]]


def random_points(rng, *counts):
    points = rng.uniform(-1, 1, (*counts, 4))
    points[..., 3] = 4.0 ** rng.uniform(-1, 1, counts)
    return points


@pytest.mark.parametrize("flags", FLAGS)
@pytest.mark.parametrize("order", range(2, 7))
def test_curves_match_the_definition_in_exact_arithmetic(core, order, flags):
    counts = [count for count in range(2, 16) if exists(core, count, order, *flags)]
    assert len(counts) >= 2
    for count in counts[:1] + counts[-1:]:
        points = random_points(np.random.default_rng(count), count)
        knots = [Fraction(k) for k in core.implied_knots(count, order, *flags).tolist()]
        begin, end = knots[order - 1], knots[count + (order - 1 if flags[0] else 0)]
        shares = [Fraction(k, 16) for k in range(16)]  # dyadic, so exact in doubles too where the domain is
        exact = [exact_point(points, knots, order, begin + share * (end - begin)) for share in shares]
        curve = core.NurbsCurve(points, order, *flags).to_bezier()
        found = curve.positions(np.array([float(share) for share in shares]))
        assert np.abs(found - exact).max() < 1e-14, (order, count, flags)


def test_the_ranges_of_the_spans_cover_the_domain_in_order(core):
    for order, count, *flags in drawn(core):
        chain = core.NurbsCurve(random_points(np.random.default_rng(0), count), order, *flags).to_bezier()
        ranges = chain.ranges
        assert ranges[0, 0] == 0 and ranges[-1, 1] == 1
        assert np.array_equal(ranges[1:, 0], ranges[:-1, 1]) and (ranges[:, 0] < ranges[:, 1]).all()


def test_neighbouring_segments_share_their_points_and_closed_curves_close_bit_by_bit(core):
    for order, count, *flags in drawn(core):
        chain = core.NurbsCurve(random_points(np.random.default_rng(1), count), order, *flags).to_bezier()
        segments = [chain.segment(i) for i in range(len(chain.ranges))]
        for a, b in itertools.pairwise(segments):
            assert np.array_equal(a.points[-1], b.points[0]), (order, count, flags)
        assert chain.closed == flags[0]
        if chain.closed:
            assert np.array_equal(segments[-1].points[-1], segments[0].points[0]), (order, count, flags)


def homogeneous_end_derivatives(points, degree, width, at_end):
    """Derivatives 0..degree of a homogeneous Bezier segment at an end, by the spline's parameter."""
    out, differences, factor = [], points, 1.0
    for k in range(degree + 1):
        out.append(differences[-1 if at_end else 0] * factor / width**k)
        differences, factor = np.diff(differences, axis=0), factor * (degree - k)
    return out


def test_the_continuity_that_is_reported_is_what_the_derivatives_show(core):
    """C^k exactly: derivatives up to k agree and, with random points, the next one does not."""
    for order, count, *flags in drawn(core):
        chain = core.NurbsCurve(random_points(np.random.default_rng(2), count), order, *flags).to_bezier()
        spans, degree = len(chain.ranges), order - 1
        for i, k in enumerate(chain.continuity):
            if i == spans - 1 and not chain.closed:
                assert k == -1
                continue
            a, b = chain.segment(i), chain.segment((i + 1) % spans)
            width_a, width_b = np.diff(chain.ranges[[i, (i + 1) % spans]], axis=1).ravel()
            left = homogeneous_end_derivatives(a.points, degree, width_a, True)
            right = homogeneous_end_derivatives(b.points, degree, width_b, False)
            jumps = [np.abs(x - y).max() / max(1, np.abs(x).max()) for x, y in zip(left, right)]
            assert max(jumps[: k + 1]) < 1e-10, (order, count, flags, i, k, jumps)
            assert spans == 1 or jumps[k + 1] > 1e-4, (order, count, flags, i, k, jumps)


directions = st.tuples(st.integers(2, 6), st.integers(2, 9), st.booleans(), st.booleans(), st.booleans())


@given(directions, directions, st.integers(0, 2**32 - 1))
def test_a_surface_is_the_tensor_product_of_its_directions(core, u, v, seed):
    """A point of the surface is the point at v of the curve that the rows' homogeneous points at u control."""
    assume(exists(core, u[1], u[0], *u[2:]) and exists(core, v[1], v[0], *v[2:]))
    points = random_points(np.random.default_rng(seed), v[1], u[1])
    net = core.NurbsSpline(points, u[0], v[0], u[2], v[2], u[3], v[3], u[4], v[4]).to_bezier()
    t = np.linspace(0, 1, 7)
    for at_u in t:
        column = []
        for row in points:
            chain = core.NurbsCurve(row, u[0], *u[2:]).to_bezier()
            span = min(int(np.searchsorted(chain.ranges[:, 0], at_u, side="right")) - 1, len(chain.ranges) - 1)
            begin, end = chain.ranges[span]
            homogeneous = chain.segment(span).points
            basis = [math.comb(u[0] - 1, i) for i in range(u[0])]
            s = (at_u - begin) / (end - begin)
            x, y, z, w = sum(b * (1 - s) ** (u[0] - 1 - i) * s**i * homogeneous[i] for i, b in enumerate(basis))
            column.append([x / w, y / w, z / w, w])
        expected = core.NurbsCurve(np.array(column), v[0], *v[2:]).to_bezier().positions(t)
        assert np.abs(net.positions(np.full(7, at_u), t) - expected).max() < 1e-13


@given(directions, directions, st.integers(0, 2**32 - 1))
def test_neighbouring_patches_share_their_borders_bit_by_bit_across_seams_too(core, u, v, seed):
    assume(exists(core, u[1], u[0], *u[2:]) and exists(core, v[1], v[0], *v[2:]))
    points = random_points(np.random.default_rng(seed), v[1], u[1])
    net = core.NurbsSpline(points, u[0], v[0], u[2], v[2], u[3], v[3], u[4], v[4]).to_bezier()
    spans_u, spans_v = len(net.ranges_u), len(net.ranges_v)
    patches = [[net.patch(i, j).points for i in range(spans_u)] for j in range(spans_v)]
    for j, i in itertools.product(range(spans_v), range(spans_u)):
        if i + 1 < spans_u or net.closed_u:
            assert np.array_equal(patches[j][i][:, -1], patches[j][(i + 1) % spans_u][:, 0])
        if j + 1 < spans_v or net.closed_v:
            assert np.array_equal(patches[j][i][-1], patches[(j + 1) % spans_v][i][0])


def test_bezier_knots_with_end_points_keep_the_control_points(core):
    points = random_points(np.random.default_rng(3), 7, 10)
    net = core.NurbsSpline(points, 4, 4, endpoint_u=True, endpoint_v=True, bezier_u=True, bezier_v=True).to_bezier()
    assert net.points.shape == (7, 10, 4)
    assert np.array_equal(net.points[..., 3], points[..., 3])
    assert np.array_equal(net.points[..., :3], points[..., :3] * points[..., 3:])
    assert net.continuity_u == [0, 0, -1] and net.continuity_v == [0, -1]


def test_equal_weights_make_a_polynomial_surface(core):
    points = random_points(np.random.default_rng(4), 5, 6)
    points[..., 3] = 0.7
    net = core.NurbsSpline(points, 4, 3, cyclic_u=True).to_bezier()
    assert not net.rational and not net.patch(0, 0).rational and (net.points[..., 3] == 1).all()
    points[2, 2, 3] = 0.8
    assert core.NurbsSpline(points, 4, 3, cyclic_u=True).to_bezier().rational


def test_orders_beyond_blenders_panel_work(core):
    points = random_points(np.random.default_rng(5), 20)
    chain = core.NurbsCurve(points, 12, endpoint=True).to_bezier()
    ends = chain.positions(np.array([0.0, 1.0]))
    assert np.abs(ends - points[[0, -1], :3]).max() < 1e-15


def surface(core, points, order_u=3, order_v=3, **flags):
    return core.NurbsSpline(np.asarray(points, float), order_u, order_v, **flags)


@pytest.mark.parametrize(
    "make, expected",
    [
        (lambda core: surface(core, np.ones((3, 2, 4))), ("DRAWS_NOTHING", "point count in u", "2")),
        (lambda core: surface(core, np.ones((1, 3, 4))), ("DRAWS_NOTHING", "point count in v", "1")),
        (lambda core: surface(core, np.ones((0, 0, 4))), ("DRAWS_NOTHING", "point count in u", "0")),
        (lambda core: surface(core, np.ones((4, 4, 4)), order_u=1), ("BAD_DATA", "order in u", "1")),
        (
            lambda core: surface(core, np.ones((5, 5, 4)), order_v=4, cyclic_v=True, bezier_v=True),
            ("DRAWS_NOTHING", "point count in v", "5"),
        ),
        (lambda core: surface(core, np.ones((3, 3, 4)), bezier_u=True), ("DRAWS_NOTHING", "point count in u", "3")),
    ],
)
def test_what_blender_does_not_draw_is_named(core, make, expected):
    spline = make(core)
    assert spline.problem()[:3] == expected
    with pytest.raises(core.InputError, match=expected[1]):
        spline.to_bezier()


@pytest.mark.parametrize(
    "axis, value, argument",
    [(0, math.nan, "points[5]"), (2, -math.inf, "points[5]"), (3, 0.0, "points[5].weight"), (3, -1, "points[5].weight")]
    + [(3, math.nan, "points[5].weight"), (3, math.inf, "points[5].weight")],
)
def test_numbers_that_mean_nothing_are_named(core, axis, value, argument):
    points = np.ones((3, 4, 4))
    points[1, 1, axis] = value
    kind, name, got, wanted = surface(core, points).problem()
    assert (kind, name) == ("BAD_DATA", argument) and got and wanted


def test_a_spline_carries_its_material_slot_and_smooth_flag(core):
    spline = core.NurbsSpline(np.ones((4, 4, 4)), 4, 4, material_slot=3, smooth=False)
    assert (spline.material_slot, spline.smooth) == (3, False)
    spline = core.NurbsSpline(np.ones((4, 4, 4)), 4, 4)
    assert (spline.material_slot, spline.smooth) == (0, True)


def test_the_segments_of_a_bezier_spline_cover_exactly_the_unit_range(core):
    ranges = core.BezierSpline(np.random.default_rng(7).uniform(-1, 1, (50, 3, 3))).to_bezier().ranges
    assert ranges[0, 0] == 0 and ranges[-1, 1] == 1 and np.array_equal(ranges[1:, 0], ranges[:-1, 1])


@pytest.mark.parametrize("cyclic", [False, True])
def test_bezier_splines_are_their_cubic_segments(core, cyclic):
    knots = np.random.default_rng(6).uniform(-1, 1, (4, 3, 3))
    chain = core.BezierSpline(knots, cyclic).to_bezier()
    segments = 4 if cyclic else 3
    assert len(chain.ranges) == segments and chain.closed == cyclic
    for i in range(segments):
        following = knots[(i + 1) % 4]
        expected = [knots[i, 1], knots[i, 2], following[0], following[1]]
        assert np.array_equal(chain.segment(i).points[:, :3], expected)


def test_bezier_splines_with_bad_numbers_or_one_knot_are_named(core):
    knots = np.zeros((3, 3, 3))
    assert core.BezierSpline(knots).problem() is None
    knots[1, 2, 0] = math.nan
    assert core.BezierSpline(knots).problem()[:2] == ("BAD_DATA", "bezier_points[1]")
    assert core.BezierSpline(knots[:1]).problem()[:2] == ("DRAWS_NOTHING", "point count")
