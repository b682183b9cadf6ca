"""The ray cache at its limits: settings, cache sizes, shapes, places and rays."""

import numpy as np
import pytest
from core import ri_tree_support as support
from core import shapes
from core.ri_tree_support import BOX_MISSED, CELL_MISSED, INTERPOLATED, NOT_A_RAY, ORIGIN
from rayleaf import _core


@pytest.mark.parametrize("kind", ["SIMPLE", "GLASS", "VOLUME"])
def test_pruning_changes_no_answer(kind):
    origins, directions = support.scattered_rays(200, spread=0.6)
    settings = {"depth_limit": 20, "angle_threshold": support.ANY_ANGLE}
    plenty = support.tree_of(shapes.nurbs_torus(), kind, **settings)
    expected = plenty.ask(origins, directions)
    assert plenty.statistics()["prunes"] == 0
    assert (expected["answered_by"] == INTERPOLATED).any(), support.counts(expected)
    for cache_bytes, share in ((0, 0.7), (30_000, 0.7), (100_000, 1.0), (100_000, 0.1)):
        tree = support.tree_of(shapes.nurbs_torus(), kind, cache_bytes=cache_bytes, pruned_share=share, **settings)
        support.check_same_answers(expected, tree.ask(origins, directions))
        statistics = tree.statistics()
        assert statistics["prunes"] > 0 and statistics["bytes"] <= cache_bytes
        # What one ray adds before the next pruning: a path of 21 cells of some 250 bytes, 9 samples of 80 bytes each.
        assert statistics["most_bytes"] <= cache_bytes + 21 * (300 + 9 * 80), statistics


def test_the_order_of_rays_changes_no_answer():
    origins, directions = support.scattered_rays(300, spread=0.6)
    first = support.tree_of(shapes.nurbs_torus(), "MIRROR").ask(origins, directions)
    order = np.random.default_rng(5).permutation(300)
    tree = support.tree_of(shapes.nurbs_torus(), "MIRROR", cache_bytes=200_000)
    second = tree.ask(origins[order], directions[order])
    restored = {name: second[name][np.argsort(order)] for name in (*support.OUTPUTS, "answered_by", "error")}
    support.check_same_answers(first, restored)


def test_what_is_held_and_taken_is_counted():
    origins, directions = support.rays_towards(np.zeros(3), 0.3, 200)
    tree = support.tree_of(shapes.nurbs_sphere(), "MIRROR")
    assert tree.statistics()["bytes"] == 0
    tree.ask(origins, directions)
    once = tree.statistics()
    tree.ask(origins, directions)
    twice = tree.statistics()
    assert twice["samples_taken"] == once["samples_taken"] and twice["nodes"] == once["nodes"]
    assert sum(twice["answers"].values()) == 400 and once["leaves"] < once["nodes"]
    assert once["samples"] <= once["samples_taken"] and once["bytes"] > once["samples"] * 24


@pytest.mark.parametrize("kind", ["SIMPLE", "MIRROR", "GLASS", "VOLUME"])
@pytest.mark.parametrize("distance", [0.0, np.inf])
@pytest.mark.parametrize("angle", [0.0, np.inf])
def test_thresholds_of_zero_and_infinity(kind, distance, angle):
    origins, directions = support.rays_towards(np.zeros(3), 1.3, 150)
    settings = {"distance_threshold": distance, "angle_threshold": angle, "depth_limit": 18}
    tree = support.tree_of(shapes.nurbs_sphere(), kind, **settings)
    got, truth = tree.ask(origins, directions), tree.trace(origins, directions)
    assert np.isfinite(got["exit_direction"]).all() and np.isfinite(got["length"]).all()
    if angle == 0.0 and kind != "VOLUME":
        # No two directions are alike on a sphere: what is hit is traced, so all is exact.
        assert not (got["answered_by"] == INTERPOLATED).any()
        np.testing.assert_array_equal(got["exit_direction"], truth["exit_direction"])
    else:
        assert (got["answered_by"] == INTERPOLATED).any(), support.counts(got)
    if distance == 0.0:
        assert {cell[1] for cell in tree.final_cells(origins, directions) if cell} >= {18}


@pytest.mark.parametrize("kind", ["SIMPLE", "MIRROR", "GLASS", "VOLUME"])
def test_at_depth_zero_everything_is_traced(kind):
    origins, directions = support.scattered_rays(300)
    tree = support.tree_of(shapes.nurbs_torus(), kind, depth_limit=0)
    got, truth = tree.ask(origins, directions), tree.trace(origins, directions)
    for name in support.OUTPUTS:
        np.testing.assert_array_equal(got[name], truth[name], err_msg=name)
    assert tree.statistics()["nodes"] == len({cell[0] for cell in tree.final_cells(origins, directions) if cell})


def check_close(tree, origins, directions, tolerance):
    """Hits agree, and interpolated exit directions within the tolerance on the mean."""
    got, truth = tree.ask(origins, directions), tree.trace(origins, directions)
    assert (got["hit"] == truth["hit"]).mean() > 0.985, support.counts(got)
    interpolated = (got["answered_by"] == INTERPOLATED) & truth["hit"]
    assert interpolated.sum() > 20, support.counts(got)
    error = support.angles(got["exit_direction"], truth["exit_direction"])[interpolated]
    assert error.mean() < tolerance, support.counts(got)


def test_a_sheet_without_thickness_and_a_needle():
    origins, directions = support.rays_towards(np.zeros(3), 0.8, 500)
    settings = {"angle_threshold": support.ANY_ANGLE, "depth_limit": 24}
    check_close(support.tree_of(support.square(), "MIRROR", **settings), origins, directions, 1e-6)
    thin = support.cuboid((1e-5, 1.0, 1e-5))
    at_needle = np.zeros((300, 3))
    at_needle[:, 1] = np.linspace(-0.9, 0.9, 300)
    at_needle[::2, 0] = 3e-6
    towards = shapes.unit(at_needle - origins[:300])
    tree = support.tree_of(thin, "SIMPLE", depth_limit=50)
    got, truth = tree.ask(origins[:300], towards), tree.trace(origins[:300], towards)
    assert truth["hit"].all() and got["hit"].all(), support.counts(got)
    np.testing.assert_array_equal(got["first_class"], truth["first_class"])
    np.testing.assert_allclose(got["position"], truth["position"], atol=0.02)


def sphere_at(center, scale):
    """A NURBS sphere whose control points lie elsewhere, in object space."""
    around = np.append(shapes.CIRCLE[:1], shapes.CIRCLE[1:], axis=0)[::-1]
    half_circle = np.array([[0, -1], [1, -1], [1, 0], [1, 1], [0, 1]], float)
    points = np.empty((8, 5, 4))
    points[..., :2] = np.roll(around, 1, axis=0)[:, None, :] * half_circle[None, :, :1]
    points[..., 2] = half_circle[None, :, 1]
    points[..., :3] = scale * points[..., :3] + center
    points[..., 3] = shapes.CIRCLE_WEIGHTS[:, None] * np.array([1, shapes.HALF, 1, shapes.HALF, 1])[None, :]
    return shapes.trace.PatchSurface("sphere", [(points, shapes.QUADRATIC_ARC, shapes.QUADRATIC_CLOSED, True, 0)])


@pytest.mark.parametrize("center,scale", [(0.0, 2.0**-20), (0.0, 2.0**20), (2.0**20, 1.0)])
def test_size_and_place_of_an_object_change_nothing(center, scale):
    """About 1e-6, 1e6 and at 1e6, as powers of two: the local space is then the same bit by bit."""
    origins, directions = support.scattered_rays(400, spread=0.5)
    # Origins on a grid of 2^-30 so that adding 2^20 rounds nothing.
    origins = np.round(origins * 2.0**30) / 2.0**30
    here = support.tree_of(sphere_at(0.0, 1.0), "GLASS").ask(origins, directions)
    there = support.tree_of(sphere_at(center, scale), "GLASS").ask(origins * scale + center, directions)
    assert (here["answered_by"] == INTERPOLATED).any(), support.counts(here)
    np.testing.assert_array_equal(here["answered_by"], there["answered_by"])
    # Control points at 2^20 are rounded to 2^-32.
    tolerance = 1e-9 if center else 0.0
    np.testing.assert_allclose((there["exit_position"] - center) / scale, here["exit_position"], atol=1e-6)
    np.testing.assert_allclose(there["exit_direction"], here["exit_direction"], atol=1e3 * tolerance)


def test_rays_from_afar_and_with_long_directions():
    origins, directions = support.scattered_rays(400, spread=0.5)
    tree = support.tree_of(shapes.nurbs_sphere(), "MIRROR")
    near = tree.ask(origins, directions)
    far = tree.ask(origins - 1e6 * directions, 1e200 * directions)
    # A start at 1e6 is rounded to 1e-10, which may decide a cell's side.
    assert (near["answered_by"] == far["answered_by"]).mean() > 0.99
    np.testing.assert_allclose(near["exit_direction"], far["exit_direction"], atol=2e-3)


def test_rays_that_are_not_rays_are_answered_as_such():
    nan, inf = np.nan, np.inf
    bad = [((0, 0, 3), (0, 0, 0)), ((nan, 0, 0), (0, 0, 1)), ((0, 0, 3), (0, nan, -1)), ((inf, 0, 0), (-1, 0, 0))]
    bad.append(((0, 0, 3), (0, 0, -inf)))
    origins, directions = (np.array(part, float) for part in zip(*bad))
    for kind in ("SIMPLE", "VOLUME"):
        tree = support.tree_of(shapes.nurbs_sphere(), kind)
        got = tree.ask(origins, directions)
        assert (got["answered_by"] == NOT_A_RAY).all() and not got["hit"].any()
        assert not tree.trace(origins, directions)["hit"].any()
        assert tree.final_cells(origins, directions) == [None] * len(bad)
        assert tree.statistics()["nodes"] == 0


def test_rays_in_the_faces_of_the_box_and_on_its_diagonals():
    """Ties of the dominant direction, and lines along faces and edges of the shape."""
    corners = shapes.CUBE_VERTICES.astype(float)
    starts, towards = [], []
    for corner in corners:
        for other in corners:
            if (corner != other).any():
                towards.append(other - corner)
                starts.append(corner - 3 * (other - corner))
    origins, directions = np.array(starts), shapes.unit(np.array(towards))
    for shape in (shapes.cube(), shapes.nurbs_sphere()):
        tree = support.tree_of(shape, "SIMPLE", depth_limit=16)
        got, truth = tree.ask(origins, directions), tree.trace(origins, directions)
        assert np.isfinite(got["position"]).all()
        diagonal = (np.abs(directions) > 0.5).all(axis=1)
        np.testing.assert_array_equal(got["hit"][diagonal], truth["hit"][diagonal])


def test_an_empty_shape_is_missed():
    empty = shapes.trace.TriangleMesh("empty", np.empty((0, 3), np.float32), np.empty((0, 3), np.int32))
    origins, directions = support.scattered_rays(10)
    got = support.tree_of(empty, "MIRROR").ask(origins, directions)
    assert (got["answered_by"] == BOX_MISSED).all() and not got["hit"].any()


@pytest.mark.parametrize("kind", ["SIMPLE", "VOLUME"])
def test_a_ray_from_inside_the_box_is_not_told_what_lies_behind_it(kind):
    random = np.random.default_rng(9)
    origins = random.uniform([-1, -1, -0.25], [1, 1, 0.25], (6000, 3))
    ring = np.hypot(origins[:, 0], origins[:, 1]) - 0.75
    origins = origins[np.hypot(ring, origins[:, 2]) > 0.3]
    directions = shapes.random_directions(random, len(origins))
    tree = support.tree_of(shapes.nurbs_torus(), kind, depth_limit=22)
    got, truth = tree.ask(origins, directions), tree.trace(origins, directions)
    by = got["answered_by"]
    assert (by == ORIGIN).any() and (by == CELL_MISSED).any(), support.counts(got)
    # What is left are silhouettes thinner than a cell that no sample met.
    assert (got["hit"] != truth["hit"]).mean() < 0.005, support.counts(got)
    if kind == "VOLUME":
        assert not (by == INTERPOLATED).any()
        return
    used = by == INTERPOLATED
    assert used.any()
    ahead = np.sum((got["position"] - origins) * directions, axis=1)[used]
    assert (ahead > 0).all()
    far_off = np.linalg.norm(got["position"] - truth["position"], axis=1)[used] > 0.1
    assert far_off.mean() < 0.01


def test_a_path_inside_glass_ends_after_64_hits():
    """A light guide: total reflections along a rod of 1 x 1 x 200."""
    rod = support.cuboid((0.5, 0.5, 100.0))
    tree = support.tree_of(rod, "GLASS", ior=1.5)
    random = np.random.default_rng(4)
    origins = np.concatenate([random.uniform(-0.4, 0.4, (50, 2)), np.full((50, 1), -100.5)], axis=1)
    directions = shapes.unit(np.array([[0.9, 0.4, 1.0]]) + random.uniform(-0.01, 0.01, (50, 3)))
    origins = origins - 0.2 * directions
    for got in (tree.trace(origins, directions), tree.ask(origins, directions)):
        inside = got["hit"] & (got["position"][:, 2] < -99.99)
        assert inside.sum() > 10
        assert (got["ending"][inside] == 2).all() and (got["interior_hits"][inside] == 64).all()
        assert (got["total_reflections"][inside] == 64).all()


@pytest.mark.parametrize(
    "argument,value",
    [
        ("distance_threshold", -0.1),
        ("distance_threshold", np.nan),
        ("angle_threshold", -1.0),
        ("angle_threshold", np.nan),
        ("depth_limit", -1),
        ("depth_limit", 61),
        ("pruned_share", 0.0),
        ("pruned_share", 1.5),
        ("ior", 0.0),
        ("ior", np.inf),
        ("facet_tolerance", 0.0),
    ],
)
def test_settings_without_meaning_are_named(argument, value):
    with pytest.raises(_core.InputError, match=f"cube.*{argument}"):
        support.tree_of(shapes.cube(), "MIRROR", **{argument: value})


def test_a_kind_that_is_none_and_arrays_that_do_not_fit_are_named():
    with pytest.raises(_core.InputError, match="kind"):
        support.tree_of(shapes.cube(), "MATTE")
    tree = support.tree_of(shapes.cube(), "MIRROR")
    with pytest.raises(_core.InputError, match="origins"):
        tree.ask(np.zeros(3), np.zeros(3))
    with pytest.raises(_core.InputError, match="directions"):
        tree.ask(np.zeros((2, 3)), np.zeros((3, 3)))
