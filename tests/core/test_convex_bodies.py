"""Rays against convex glass that no cell answers are followed by Newton's iteration, with the results of tracing."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from core import ri_tree_support as support
from core import shapes
from core.ri_tree_support import BOX_MISSED, FOLLOWED, INTERPOLATED, MANY_CLASSES, FOLLOWED_MISSED

BEZIER, CLOSED_BEZIER = (4, False, True, True), (4, True, True, True)
QUARTER = 4 / 3 * (np.sqrt(2) - 1)
NO_CELLS = {"rays_per_cell": np.inf}
IOR = 1.5


def turned(profile, turns_out=True):
    """A body of revolution: Bezier points (radius, height) of a profile, four patches around."""
    around = np.array([(1, 0), (1, -QUARTER), (QUARTER, -1), (0, -1), (-QUARTER, -1), (-1, -QUARTER)])
    around = np.concatenate([around, -around])
    profile = np.array(profile, float)
    points = np.ones((len(profile), 12, 4))
    points[..., :2] = profile[:, :1, None] * around
    points[..., 2] = profile[:, 1:]
    return points if turns_out else points[::-1].copy()


def surface(*grids):
    """A surface of such bodies."""
    return shapes.trace.PatchSurface("body", [(points, CLOSED_BEZIER, BEZIER, True, 0) for points in grids])


def barrel(waist=1.0):
    """Two Bezier curves from pole to pole; convex unless the middle is pulled inwards."""
    return [(0, -1.2), (0.5, -1.2), (waist, -0.6), (waist, 0), (waist, 0.6), (0.5, 1.2), (0, 1.2)]


def spaced(tree, rays, spacing=0.01):
    """Answers to rays with a spacing."""
    apart = np.full(len(rays[0]), spacing, np.float32)
    return tree.ask(*rays, distances=apart, angles=apart)


def same_path(a, b):
    """Which rays took the same path."""
    names = ("hit", "first_class", "exit_class", "interior_hits", "total_reflections", "ending")
    return np.logical_and.reduce([a[name] == b[name] for name in names])


@pytest.mark.parametrize("ior", [1.1, 1.5, 2.4, 0.8])
@pytest.mark.parametrize("shape", [shapes.nurbs_sphere(), surface(turned(barrel()))], ids=["sphere", "barrel"])
def test_what_is_followed_goes_as_traced_and_decides_alike_at_every_crossing(shape, ior):
    rays = support.scattered_rays(4000, spread=1.1)
    tree = support.tree_of(shape, "GLASS", "FastTree", ior=ior, most_interior_hits=8, **NO_CELLS)
    got, truth = spaced(tree, rays), tree.trace(*rays)
    used = got["answered_by"] == FOLLOWED
    assert used[truth["hit"]].mean() > 0.98, support.counts(got)
    assert truth["hit"][used].all()
    missed = got["answered_by"] == FOLLOWED_MISSED
    assert not truth["hit"][missed].any() and not got["hit"][missed].any()
    in_box = got["answered_by"] != BOX_MISSED
    assert missed[~truth["hit"] & in_box].mean() > 0.9, support.counts(got)
    # At a border of total reflection, and at the limit of hits, the last bit decides.
    same = same_path(got, truth)[used]
    assert same.mean() > 0.998, (same.mean(), support.counts(got))
    for name in ("position", "normal", "exit_position", "exit_direction"):
        error = np.linalg.norm(got[name] - truth[name], axis=1)[used][same]
        # Single precision; the error grows on paths of many crossings and at the critical angle.
        assert np.median(error) < 3e-6 and np.quantile(error, 0.99) < 1e-3, (name, np.quantile(error, [0.5, 0.99, 1]))
    traced = got["answered_by"] >= MANY_CLASSES
    np.testing.assert_array_equal(got["exit_direction"][traced], truth["exit_direction"][traced])


def test_a_followed_ball_agrees_with_the_closed_form():
    rays = support.rays_towards(np.zeros(3), 0.9, 3000)
    position, direction = support.through_glass_ball(*rays, IOR)
    got = spaced(support.tree_of(shapes.nurbs_sphere(), "GLASS", "FastTree", ior=IOR, **NO_CELLS), rays)
    assert (got["answered_by"] == FOLLOWED).all(), support.counts(got)
    np.testing.assert_allclose(got["exit_position"], position, atol=2e-5)
    np.testing.assert_allclose(got["exit_direction"], direction, atol=2e-5)


def test_far_away_bodies_and_eyes_cost_a_followed_ray_no_precision():
    near = support.rays_towards(np.zeros(3), 0.9, 500, eye=(0.5, -40.0, 1.5))
    tree = support.tree_of(shapes.nurbs_sphere(), "GLASS", "FastTree", ior=IOR, **NO_CELLS)
    expected = spaced(tree, near)
    for scale, center in ((1e-6, (0, 0, 0)), (1e6, (0, 0, 0)), (1.0, (1e6, -1e6, 1e6))):
        shape = shapes.nurbs_sphere(scale=scale, center=center)
        there = support.tree_of(shape, "GLASS", "FastTree", ior=IOR, **NO_CELLS)
        got = spaced(there, (near[0] * scale + np.array(center), near[1]), 0.01 * scale)
        assert (got["answered_by"] == FOLLOWED).all(), support.counts(got)
        np.testing.assert_allclose(got["exit_direction"], expected["exit_direction"], atol=2e-5)
        # A coordinate of 10^6 has an error of 10^-10.
        position = (got["exit_position"] - np.array(center)) / scale
        np.testing.assert_allclose(position, expected["exit_position"], atol=2e-5)


def dented():
    """A barrel of which one control point beside the middle is pushed in."""
    points = turned(barrel())
    points[2, 4, :3] *= 0.6
    return surface(points)


def finely_cut(curves):
    """A ball of so many rings of patches."""
    angles = np.linspace(-np.pi / 2, np.pi / 2, 3 * curves + 1)
    profile = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    profile[[0, -1], 0] = 0
    return surface(turned(profile))


@pytest.mark.parametrize(
    "shape",
    [
        finely_cut(65),
        surface(turned(barrel(waist=0.3))),
        dented(),
        surface(turned(barrel(), turns_out=False)),
        surface(turned(barrel()), turned(np.array(barrel()) * 0.5)),
        surface(turned([(0.4, -1.2), (0.6, -1.2), *barrel()[2:]])),
        surface(turned(np.array(barrel()) * (1, 0.002))),
        shapes.nurbs_torus(),
        shapes.nurbs_sphere(smooth=False),
        shapes.cube(),
    ],
    ids=["many patches", "waist", "dent", "inside out", "two bodies", "hole", "sheet", "torus", "flat shading", "mesh"],
)
def test_nothing_is_followed_through_what_is_not_a_convex_body(shape):
    rays = support.scattered_rays(300)
    tree = support.tree_of(shape, "GLASS", "FastTree", **NO_CELLS)
    got, truth = spaced(tree, rays), tree.trace(*rays)
    assert not np.isin(got["answered_by"], [FOLLOWED, FOLLOWED_MISSED]).any(), support.counts(got)
    for name in support.OUTPUTS:
        np.testing.assert_array_equal(got[name], truth[name], err_msg=name)


@pytest.mark.parametrize("kind", ["SIMPLE", "MIRROR", "VOLUME"])
def test_only_glass_is_followed(kind):
    got = spaced(support.tree_of(shapes.nurbs_sphere(), kind, "FastTree", **NO_CELLS), support.scattered_rays(300))
    assert not np.isin(got["answered_by"], [FOLLOWED, FOLLOWED_MISSED]).any(), support.counts(got)


def test_rays_that_start_inside_the_box_are_not_followed():
    random = np.random.default_rng(2)
    # Corners of the box, outside the ball: the line may hit the ball behind them.
    origins = random.choice([-1.0, 1.0], (400, 3)) * random.uniform(0.75, 0.99, (400, 3))
    rays = origins, shapes.random_directions(random, 400)
    tree = support.tree_of(shapes.nurbs_sphere(), "GLASS", "FastTree", **NO_CELLS)
    got, truth = spaced(tree, rays), tree.trace(*rays)
    assert not np.isin(got["answered_by"], [FOLLOWED, FOLLOWED_MISSED]).any(), support.counts(got)
    np.testing.assert_array_equal(got["hit"], truth["hit"])


def test_followed_answers_are_the_same_for_any_threads_company_and_cache_size():
    rays = support.rays_towards(np.zeros(3), 1.1, 3000)
    shape = surface(turned(barrel()))
    settings = {"ior": IOR, "depth_limit": 28, "mixed_depth_limit": 28}
    expected = spaced(support.tree_of(shape, "GLASS", "FastTree", **settings), rays)
    by = expected["answered_by"]
    assert (by == FOLLOWED).mean() > 0.02 and (by == INTERPOLATED).mean() > 0.2, support.counts(expected)
    random = np.random.default_rng(4)
    for cache_bytes, size, threads in ((10**8, 19, 4), (100_000, 250, 3), (0, 500, 2)):
        tree = support.tree_of(shape, "GLASS", "FastTree", cache_bytes=cache_bytes, **settings)
        order = random.permutation(len(by))
        parts = [order[i : i + size] for i in range(0, len(order), size)]
        with ThreadPoolExecutor(threads) as pool:
            answers = list(pool.map(lambda part: spaced(tree, (rays[0][part], rays[1][part])), parts))
        for part, got in zip(parts, answers):
            support.check_same_answers(
                {name: value[part] for name, value in expected.items() if name != "seconds"}, got
            )
        assert tree.statistics()["most_bytes"] <= max(cache_bytes, 1)


def test_following_keeps_the_error_that_the_thresholds_allow():
    rays = support.rays_towards(np.zeros(3), 0.9, 3000)
    tree = support.tree_of(shapes.nurbs_sphere(), "GLASS", "FastTree", **support.ri_tree.quality_settings(0.005))
    got, truth = spaced(tree, rays), tree.trace(*rays)
    answers = tree.statistics()["answers"]
    assert answers["followed"] == (got["answered_by"] == FOLLOWED).sum()
    assert support.angles(got["exit_direction"], truth["exit_direction"]).mean() < 0.005, support.counts(got)


@pytest.mark.parametrize("name", ["distance_threshold", "direction_threshold", "angle_threshold", "depth_limit"])
def test_settings_that_allow_no_error_leave_all_to_tracing(name):
    rays = support.scattered_rays(200)
    tree = support.tree_of(shapes.nurbs_sphere(), "GLASS", "FastTree", **NO_CELLS, **{name: 0})
    got, truth = spaced(tree, rays), tree.trace(*rays)
    for output in support.OUTPUTS:
        np.testing.assert_array_equal(got[output], truth[output], err_msg=output)


@pytest.mark.parametrize("shape", [shapes.nurbs_sphere(), surface(turned(barrel()))], ids=["sphere", "barrel"])
def test_samples_are_followed_to_what_tracing_makes_of_them_and_of_their_changes(shape):
    rays = support.scattered_rays(2000, spread=0.9)
    settings = {"ior": 1.3, "facet_tolerance": 2.0**-22}
    following = support.tree_of(shape, "GLASS", "FastTree", **settings)
    tracing = support.tree_of(shape, "GLASS", "FastTree", distance_threshold=0.0, **settings)
    direction, shares = following.lines(*rays)
    places = np.round(shares[direction == 0] * 2**31).astype(np.uint32)
    got, truth = following.samples(0, places), tracing.samples(0, places)
    same = np.logical_and.reduce([got[name] == truth[name] for name in ("hit", "interior_hits", "total_reflections")])
    assert same.mean() > 0.97 and (got["hit"] & same).sum() > 40
    assert (got["values"] != truth["values"]).any()  # they are not the tracer's own
    used = got["hit"] & same
    for name in ("values", "changes"):
        size = 1 + np.abs(truth[name][used])
        error = np.max(np.abs(got[name][used] - truth[name][used]) / size, axis=tuple(range(1, size.ndim)))
        assert np.median(error) < 3e-5 and np.quantile(error, 0.9) < 2e-3, (name, np.quantile(error, [0.5, 0.9, 1]))


@pytest.mark.parametrize("scale, center", [(1.0, (0, 0, 0)), (50.0, (300, -200, 1000))])
def test_changes_of_followed_answers_agree_with_finite_differences(scale, center):
    shape = shapes.nurbs_sphere(scale=scale, center=center)
    # A depth limit so low that no cell is close enough.
    shallow = {"depth_limit": 4, "mixed_depth_limit": 4}
    tree = support.tree_of(shape, "GLASS", "FastTree", ior=1.2, **shallow)
    origins, directions, by_origin, by_direction = support.rays_with_steps(scale, center)
    got = tree.changes(origins, directions, by_origin.astype(np.float32), by_direction.astype(np.float32))
    assert (tree.ask(origins, directions)["answered_by"] == FOLLOWED).all() and got["known"].all()
    step = 1e-3  # rounding of floats over it is 1e-3, too
    for i in range(2):
        sides = []
        for sign in (step, -step):
            turn = shapes.unit(directions + sign * by_direction[:, i])
            sides.append(tree.ask(origins + sign * by_origin[:, i], turn))
        for name, unit in (("normal", 1.0), ("exit_position", scale), ("exit_direction", 1.0)):
            off = np.abs((sides[0][name] - sides[1][name]) / (2 * step) - got[name][:, i]) / unit
            # Near the silhouette third derivatives matter.
            assert np.median(off) < 3e-3 and np.quantile(off, 0.9) < 0.03, (name, np.quantile(off, [0.5, 0.9, 1]))
