"""Unit normals exist everywhere, also where the Jacobian of a patch degenerates, and are limits from inside."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

ARC = np.array([[1, 0, 1], [1, 1, math.sqrt(0.5)], [0, 1, 1]])


def octant(radius=1.0, center=(0.0, 0.0, 0.0)):
    """An eighth of a sphere with its pole (z) on the collapsed edge v = 1."""
    points = np.array([[(x * a, y * a, b, w * g) for x, y, w in ARC] for a, b, g in ARC])
    points[..., :3] = points[..., :3] * radius + center
    return points


def bumpy_net(seed=0, degree_u=3, degree_v=3, weight_exponent=0.0):
    """Points of a graph z(x, y), so that every normal points up (z > 0)."""
    rng = np.random.default_rng(seed)
    x, y = np.meshgrid(np.linspace(0, 1, degree_u + 1), np.linspace(0, 1, degree_v + 1))
    weights = 10.0 ** rng.uniform(-weight_exponent, weight_exponent, x.shape)
    return np.stack([x, y, 0.3 * rng.uniform(-1, 1, x.shape), weights], axis=-1)


EDGES = {
    "u=0": (np.s_[:, 0], 0.0, None),
    "u=1": (np.s_[:, -1], 1.0, None),
    "v=0": (np.s_[0], None, 0.0),
    "v=1": (np.s_[-1], None, 1.0),
}


def collapsed(net, edge, rows=1):
    """The net with the border column or row, and the `rows` - 1 next to it, in one point, and parameters along it."""
    net = net.copy()
    where, u, v = EDGES[edge]
    point = net[where][0, :3].copy()
    axis = 1 if edge[0] == "u" else 0
    lines = np.moveaxis(net, axis, 0)
    for row in range(rows):
        lines[row if edge[2] == "0" else -1 - row][:, :3] = point
    along = np.linspace(0.05, 0.95, 13)
    return net, np.full(13, u) if u is not None else along, np.full(13, v) if v is not None else along


def inside(u, v, step):
    """Parameters a step further inside where they are on the border."""
    return np.clip(u, step, 1 - step), np.clip(v, step, 1 - step)


def check_unit_and_finite(normals):
    assert np.isfinite(normals).all()
    assert np.abs(np.linalg.norm(normals[:, 0], axis=1) - 1).max() < 1e-14


def test_an_ordinary_patch_needs_no_limit_and_its_normals_are_the_cross_products(core):
    patch = core.BezierPatch(bumpy_net())
    u, v = (grid.ravel() for grid in np.meshgrid(np.linspace(0, 1, 9), np.linspace(0, 1, 9)))
    normals, stages = patch.normals(u, v)
    assert set(stages) == {"REGULAR"}
    values = patch.evaluate(u, v)
    cross = np.cross(values[:, 1], values[:, 2])
    assert np.abs(normals[:, 0] - cross / np.linalg.norm(cross, axis=1)[:, None]).max() < 1e-14


@pytest.mark.parametrize("weight_exponent", [0.0, 0.5])
def test_derivatives_of_the_unit_normal_match_finite_differences(core, weight_exponent):
    patch = core.BezierPatch(bumpy_net(3, 3, 4, weight_exponent))
    u, v = (grid.ravel() for grid in np.meshgrid(np.linspace(0.1, 0.9, 7), np.linspace(0.1, 0.9, 7)))
    normals, _ = patch.normals(u, v)
    h = 1e-6  # truncation ~ h², rounding ~ 1e-16 / h: about 1e-10 of the derivatives
    du = (patch.normals(u + h, v)[0][:, 0] - patch.normals(u - h, v)[0][:, 0]) / (2 * h)
    dv = (patch.normals(u, v + h)[0][:, 0] - patch.normals(u, v - h)[0][:, 0]) / (2 * h)
    scale = np.abs(normals[:, 1:]).max()
    assert np.abs(normals[:, 1] - du).max() < 1e-7 * scale
    assert np.abs(normals[:, 2] - dv).max() < 1e-7 * scale


@pytest.mark.parametrize("radius, center", [(1.0, (0, 0, 0)), (1e-3, (100, -50, 20)), (1e4, (0, 0, 0))])
def test_the_pole_of_a_sphere_has_the_spheres_normal(core, radius, center):
    patch = core.BezierPatch(octant(radius, center))
    u = np.linspace(0, 1, 11)
    normals, stages = patch.normals(u, np.ones(11))
    assert set(stages) == {"SECOND_ORDER"}
    check_unit_and_finite(normals)
    # One step of 1e-3 of a parameter is not taken: the direction is the limit's, up to roundings at the center.
    tolerance = 1e-13 * max(1.0, np.abs(center).max() / radius)
    assert np.abs(normals[:, 0] - [0, 0, 1]).max() < tolerance


def test_normals_approach_the_limit_at_a_pole_continuously(core):
    patch = core.BezierPatch(octant())
    for exponent in range(1, 16):
        v = np.array([1 - 10.0**-exponent])
        normals, stages = patch.normals(np.array([0.4]), v)
        exact = patch.evaluate(np.array([0.4]), v)[0, 0]  # on the unit sphere
        assert np.abs(normals[0, 0] - exact).max() < 1e-6, (exponent, stages)


@pytest.mark.parametrize("edge", EDGES)
@pytest.mark.parametrize("weight_exponent", [0.0, 0.5, 3.0])
def test_a_collapsed_edge_has_the_limit_of_the_normals_inside(core, edge, weight_exponent):
    net, u, v = collapsed(bumpy_net(1, 3, 3, weight_exponent), edge)
    patch = core.BezierPatch(net)
    normals, stages = patch.normals(u, v)
    check_unit_and_finite(normals)
    assert set(stages) == {"SECOND_ORDER"}
    step = 1e-4 * 10.0**-weight_exponent
    near, near_stages = patch.normals(*inside(u, v, step))
    assert set(near_stages) == {"REGULAR"}
    # The normal turns by its derivative over the step; weights make it turn faster near the edge.
    assert np.abs(normals[:, 0] - near[:, 0]).max() < 0.02


@pytest.mark.parametrize("edge", EDGES)
def test_the_error_of_the_limit_shrinks_with_the_distance_it_is_compared_at(core, edge):
    net, u, v = collapsed(bumpy_net(4), edge)
    patch = core.BezierPatch(net)
    limit = patch.normals(u, v)[0][:, 0]
    errors = [np.abs(limit - patch.normals(*inside(u, v, step))[0][:, 0]).max() for step in (1e-3, 1e-4, 1e-5)]
    assert errors[0] / errors[1] == pytest.approx(10, rel=0.05) and errors[1] / errors[2] == pytest.approx(10, rel=0.05)


@pytest.mark.parametrize("edge", EDGES)
def test_two_collapsed_rows_are_answered_from_a_little_inside(core, edge):
    net, u, v = collapsed(bumpy_net(1, 4, 4), edge, rows=2)
    patch = core.BezierPatch(net)
    normals, stages = patch.normals(u, v)
    check_unit_and_finite(normals)
    assert set(stages) == {"INSET"}
    near = patch.normals(*inside(u, v, 1e-3))[0]
    assert np.abs(normals[:, 0] - near[:, 0]).max() < 0.02


def test_a_corner_with_coincident_points_points_inside(core):
    for corner, neighbour, u, v in (((0, 0), (0, 1), 0, 0), ((3, 3), (2, 3), 1, 1), ((0, 3), (1, 3), 1, 0)):
        net = bumpy_net(2)
        net[neighbour] = net[corner]
        normals, stages = core.BezierPatch(net).normals(np.array([u * 1.0]), np.array([v * 1.0]))
        check_unit_and_finite(normals)
        assert stages == ["SECOND_ORDER"] and normals[0, 0, 2] > 0, corner


def test_a_nearly_collapsed_row_is_regular(core):
    """The lid of the old teapot: a row 0.0006 wide."""
    net, u, v = collapsed(bumpy_net(1), "v=0")
    net[0, :, 0] += np.linspace(0, 0.0006, 4)
    normals, stages = core.BezierPatch(net).normals(u, v)
    check_unit_and_finite(normals)
    assert set(stages) == {"REGULAR"}


def test_a_sheared_patch_keeps_its_own_normal(core):
    """P_u and P_v 1e-6 from parallel everywhere: below the threshold, but the cross product is accurate."""
    x, y = np.meshgrid(np.linspace(0, 1, 4), np.linspace(0, 1, 4))
    net = np.stack([x + 1e6 * y, y, np.zeros_like(x), np.ones_like(x)], axis=-1)
    normals, _ = core.BezierPatch(net).normals(np.array([0.0, 0.3, 1.0]), np.array([0.0, 0.6, 1.0]))
    assert np.abs(normals[:, 0] - [0, 0, 1]).max() < 1e-9


def test_a_thin_ribbon_is_regular(core):
    net = bumpy_net()
    net[..., 0] *= 1e-8
    net[..., 2] = 0
    normals, stages = core.BezierPatch(net).normals(np.linspace(0, 1, 5), np.linspace(0, 1, 5))
    assert set(stages) == {"REGULAR"} and np.abs(normals[:, 0] - [0, 0, 1]).max() < 1e-12


def test_a_patch_in_one_point_asks_its_neighbour_and_then_takes_the_geometric_normal(core):
    net = np.tile([0.3, 0.7, -0.1, 1.0], (4, 4, 1))
    patch = core.BezierPatch(net)
    u, v = np.array([0.2]), np.array([0.9])
    normals, stages = patch.normals(u, v, neighbour=(0, 3, 0), geometric=(1, 0, 0))
    assert stages == ["NEIGHBOUR"] and np.array_equal(normals[0], [[0, 1, 0], [0, 0, 0], [0, 0, 0]])
    for useless in (None, (0, 0, 0), (math.nan, 0, 0)):
        normals, stages = patch.normals(u, v, neighbour=useless, geometric=(2, 0, 0))
        assert stages == ["GEOMETRIC"] and np.array_equal(normals[0, 0], [1, 0, 0])
    normals, stages = patch.normals(u, v, geometric=(math.inf, 0, 0))
    assert stages == ["GEOMETRIC"] and np.array_equal(normals[0, 0], [0, 0, 1])


def test_a_patch_on_a_line_has_only_what_the_caller_gives(core):
    t = np.random.default_rng(0).uniform(0, 1, (4, 4, 1))
    net = np.concatenate([t * [1.0, 2.0, -1.0], np.ones_like(t)], axis=-1)
    normals, stages = core.BezierPatch(net).normals(np.array([0.5]), np.array([0.5]), neighbour=(0, 0, -2))
    assert stages == ["NEIGHBOUR"] and np.array_equal(normals[0, 0], [0, 0, -1])


CHOICES = st.sampled_from(["keep", "edge u=0", "edge u=1", "edge v=0", "edge v=1", "merge", "line", "point"])


@given(
    st.lists(CHOICES, min_size=1, max_size=4),
    st.integers(1, 6),
    st.integers(1, 6),
    st.integers(0, 2**32 - 1),
    st.sampled_from([0.0, 0.5, 6.0]),
    st.sampled_from([1e-30, 1e-6, 1.0, 1e12]),
)
def test_normals_of_any_degenerate_patch_are_unit_and_finite(core, choices, degree_u, degree_v, seed, exponent, size):
    rng = np.random.default_rng(seed)
    net = rng.uniform(-1, 1, (degree_v + 1, degree_u + 1, 4))
    net[..., 3] = 10.0 ** rng.uniform(-exponent, exponent, net.shape[:2])
    for choice in choices:
        if choice.startswith("edge"):
            net = collapsed(net, choice[5:], rows=int(rng.integers(1, 3)))[0]
        elif choice == "merge":
            flat = net.reshape(-1, 4)
            flat[rng.integers(len(flat)), :3] = flat[rng.integers(len(flat)), :3]
        elif choice == "line":
            net[..., 1:3] = net[..., :1] * [2.0, -0.5]
        elif choice == "point":
            net[..., :3] = net[0, 0, :3]
    net[..., :3] *= size
    u, v = (grid.ravel() for grid in np.meshgrid([0, 1e-12, 1e-5, 0.5, 1 - 1e-9, 1], [0, 1e-12, 0.3, 1]))
    check_unit_and_finite(core.BezierPatch(net).normals(u, v)[0])


@pytest.mark.parametrize("target_distance", [0.0, 0.01])
def test_the_closest_point_of_a_patch_is_found(core, target_distance):
    """Lifted off along the normal, a point's nearest point is where it came from (curvature radii are larger)."""
    patch = core.BezierPatch(bumpy_net(5, 3, 3, 0.3))
    rng = np.random.default_rng(0)
    u, v = rng.uniform(0, 1, (2, 50))
    points = patch.evaluate(u, v)[:, 0]
    normals = patch.normals(u, v)[0][:, 0]
    for i in range(50):
        found_u, found_v, distance = patch.closest_point(points[i] + normals[i] * target_distance)
        assert math.isclose(distance, target_distance, abs_tol=1e-12)
        assert abs(found_u - u[i]) < 1e-6 and abs(found_v - v[i]) < 1e-6
