"""The ray cache in extreme cases: settings, cache sizes, shapes, places and rays."""

import numpy as np
import pytest
from core import ri_tree_support as support
from core import shapes
from core.ri_tree_support import BOX_MISSED, CELL_MISSED, INTERPOLATED, NOT_A_RAY, ORIGIN
from rayleaf import _core


@pytest.fixture(params=[pytest.param("ReferenceTree", marks=pytest.mark.slow), "FastTree"])
def tree(request):
    """Either implementation."""
    return request.param


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["SIMPLE", "GLASS", "VOLUME"])
def test_pruning_changes_no_answer(tree, kind):
    origins, directions = support.scattered_rays(200, spread=0.6)
    settings = {"depth_limit": 20, "angle_threshold": support.ANY_ANGLE}
    plenty = support.tree_of(shapes.nurbs_torus(), kind, tree, **settings)
    expected = plenty.ask(origins, directions)
    assert plenty.statistics()["prunes"] == 0
    assert (expected["answered_by"] == INTERPOLATED).any(), support.counts(expected)
    for cache_bytes, share in ((0, 0.7), (30_000, 0.7), (100_000, 1.0), (100_000, 0.1)):
        cache = support.tree_of(
            shapes.nurbs_torus(), kind, tree, cache_bytes=cache_bytes, pruned_share=share, **settings
        )
        support.check_same_answers(expected, cache.ask(origins, directions))
        statistics = cache.statistics()
        assert statistics["prunes"] > 0 and statistics["bytes"] <= cache_bytes
        # The most that one ray adds before the next pruning: 21 cells of about 250 bytes, with 9 samples of 80 bytes.
        assert statistics["most_bytes"] <= cache_bytes + 21 * (300 + 9 * 80), statistics


def test_the_order_of_rays_changes_no_answer(tree):
    origins, directions = support.scattered_rays(300, spread=0.6)
    first = support.tree_of(shapes.nurbs_torus(), "MIRROR", tree).ask(origins, directions)
    order = np.random.default_rng(5).permutation(300)
    cache = support.tree_of(shapes.nurbs_torus(), "MIRROR", tree, cache_bytes=200_000)
    second = cache.ask(origins[order], directions[order])
    restored = {name: second[name][np.argsort(order)] for name in (*support.OUTPUTS, "answered_by", "error")}
    support.check_same_answers(first, restored)


def test_what_is_held_and_taken_is_counted(tree):
    origins, directions = support.rays_towards(np.zeros(3), 0.3, 200)
    cache = support.tree_of(shapes.nurbs_sphere(), "MIRROR", tree)
    assert cache.statistics()["bytes"] == 0
    cache.ask(origins, directions)
    once = cache.statistics()
    cache.ask(origins, directions)
    twice = cache.statistics()
    assert twice["samples_taken"] == once["samples_taken"] and twice["nodes"] == once["nodes"]
    assert sum(twice["answers"].values()) == 400 and once["leaves"] < once["nodes"]
    assert once["samples"] <= once["samples_taken"] and once["bytes"] > once["samples"] * 24


@pytest.mark.parametrize("kind", ["SIMPLE", "MIRROR", "GLASS", "VOLUME"])
@pytest.mark.parametrize("distance", [0.0, np.inf])
@pytest.mark.parametrize("angle", [0.0, np.inf])
def test_thresholds_of_zero_and_infinity(tree, kind, distance, angle):
    origins, directions = support.rays_towards(np.zeros(3), 1.3, 150)
    settings = {"distance_threshold": distance, "angle_threshold": angle, "depth_limit": 18}
    cache = support.tree_of(shapes.nurbs_sphere(), kind, tree, **settings)
    got, truth = cache.ask(origins, directions), cache.trace(origins, directions)
    assert np.isfinite(got["exit_direction"]).all() and np.isfinite(got["length"]).all()
    if (angle == 0.0 and kind != "VOLUME") or (distance == 0.0 and tree == "FastTree"):
        # No two directions on a sphere are equal, and no blend is exact (the fast tree traces cells that are not close
        # at the depth limit, the published one does not): all hits are traced, so everything is exact.
        assert not (got["answered_by"] == INTERPOLATED).any()
        np.testing.assert_array_equal(got["exit_direction"], truth["exit_direction"])
    else:
        assert (got["answered_by"] == INTERPOLATED).any(), support.counts(got)
    if distance == 0.0:
        deepest = 18 if tree == "ReferenceTree" else 16  # the fast one tests every fourth depth
        assert {cell[1] for cell in cache.final_cells(origins, directions) if cell} >= {deepest}


@pytest.mark.parametrize("kind", ["SIMPLE", "MIRROR", "GLASS", "VOLUME"])
def test_at_depth_zero_everything_is_traced(tree, kind):
    origins, directions = support.scattered_rays(300)
    cache = support.tree_of(shapes.nurbs_torus(), kind, tree, depth_limit=0)
    got, truth = cache.ask(origins, directions), cache.trace(origins, directions)
    for name in support.OUTPUTS:
        np.testing.assert_array_equal(got[name], truth[name], err_msg=name)
    # One cell per direction; the fast tree stores none, because such settings leave all rays to tracing.
    directions_met = {cell[0] for cell in cache.final_cells(origins, directions) if cell}
    assert cache.statistics()["nodes"] <= len(directions_met) == 6


def check_close(cache, origins, directions, tolerance):
    """Hits agree, and the mean error of interpolated exit directions is within the tolerance."""
    got, truth = cache.ask(origins, directions), cache.trace(origins, directions)
    assert (got["hit"] == truth["hit"]).mean() > 0.985, support.counts(got)
    interpolated = (got["answered_by"] == INTERPOLATED) & truth["hit"]
    assert interpolated.sum() > 20, support.counts(got)
    error = support.angles(got["exit_direction"], truth["exit_direction"])[interpolated]
    assert error.mean() < tolerance, support.counts(got)


def test_a_sheet_without_thickness_and_a_needle(tree):
    origins, directions = support.rays_towards(np.zeros(3), 0.8, 500)
    settings = {"angle_threshold": support.ANY_ANGLE, "depth_limit": 24}
    check_close(support.tree_of(support.square(), "MIRROR", tree, **settings), origins, directions, 1e-6)
    thin = support.cuboid((1e-5, 1.0, 1e-5))
    at_needle = np.zeros((300, 3))
    at_needle[:, 1] = np.linspace(-0.9, 0.9, 300)
    at_needle[::2, 0] = 3e-6
    towards = shapes.unit(at_needle - origins[:300])
    cache = support.tree_of(thin, "SIMPLE", tree, depth_limit=50)
    got, truth = cache.ask(origins[:300], towards), cache.trace(origins[:300], towards)
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
def test_size_and_place_of_an_object_change_nothing(tree, center, scale):
    """About 1e-6, 1e6 and at 1e6, as powers of two: the local space is then the same bit by bit."""
    origins, directions = support.scattered_rays(400, spread=0.5)
    # Origins on a grid of 2^-30 so that adding 2^20 rounds nothing.
    origins = np.round(origins * 2.0**30) / 2.0**30
    here = support.tree_of(sphere_at(0.0, 1.0), "GLASS", tree).ask(origins, directions)
    there = support.tree_of(sphere_at(center, scale), "GLASS", tree).ask(origins * scale + center, directions)
    assert (here["answered_by"] == INTERPOLATED).any(), support.counts(here)
    np.testing.assert_array_equal(here["answered_by"], there["answered_by"])
    # Control points at 2^20 are rounded to 2^-32.
    tolerance = 1e-9 if center else 0.0
    np.testing.assert_allclose((there["exit_position"] - center) / scale, here["exit_position"], atol=1e-6)
    np.testing.assert_allclose(there["exit_direction"], here["exit_direction"], atol=1e3 * tolerance)


def test_rays_from_afar_and_with_long_directions(tree):
    origins, directions = support.scattered_rays(400, spread=0.5)
    cache = support.tree_of(shapes.nurbs_sphere(), "MIRROR", tree)
    near = cache.ask(origins, directions)
    far = cache.ask(origins - 1e6 * directions, 1e200 * directions)
    # A start at 1e6 is rounded to 1e-10, which may decide a cell's side.
    assert (near["answered_by"] == far["answered_by"]).mean() > 0.99
    np.testing.assert_allclose(near["exit_direction"], far["exit_direction"], atol=2e-3)


def test_rays_that_are_not_rays_are_answered_as_such(tree):
    nan, inf = np.nan, np.inf
    bad = [((0, 0, 3), (0, 0, 0)), ((nan, 0, 0), (0, 0, 1)), ((0, 0, 3), (0, nan, -1)), ((inf, 0, 0), (-1, 0, 0))]
    bad.append(((0, 0, 3), (0, 0, -inf)))
    origins, directions = (np.array(part, float) for part in zip(*bad))
    for kind in ("SIMPLE", "VOLUME"):
        cache = support.tree_of(shapes.nurbs_sphere(), kind, tree)
        got = cache.ask(origins, directions)
        assert (got["answered_by"] == NOT_A_RAY).all() and not got["hit"].any()
        assert not cache.trace(origins, directions)["hit"].any()
        assert cache.final_cells(origins, directions) == [None] * len(bad)
        assert cache.statistics()["nodes"] == 0


def test_rays_in_the_faces_of_the_box_and_on_its_diagonals(tree):
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
        cache = support.tree_of(shape, "SIMPLE", tree, depth_limit=16)
        got, truth = cache.ask(origins, directions), cache.trace(origins, directions)
        assert np.isfinite(got["position"]).all()
        diagonal = (np.abs(directions) > 0.5).all(axis=1)
        np.testing.assert_array_equal(got["hit"][diagonal], truth["hit"][diagonal])


def test_an_empty_shape_is_missed(tree):
    empty = shapes.trace.TriangleMesh("empty", np.empty((0, 3), np.float32), np.empty((0, 3), np.int32))
    origins, directions = support.scattered_rays(10)
    got = support.tree_of(empty, "MIRROR", tree).ask(origins, directions)
    assert (got["answered_by"] == BOX_MISSED).all() and not got["hit"].any()


@pytest.mark.parametrize("kind", ["SIMPLE", "VOLUME"])
def test_a_ray_from_inside_the_box_is_not_told_what_lies_behind_it(tree, kind):
    random = np.random.default_rng(9)
    origins = random.uniform([-1, -1, -0.25], [1, 1, 0.25], (6000, 3))
    ring = np.hypot(origins[:, 0], origins[:, 1]) - 0.75
    origins = origins[np.hypot(ring, origins[:, 2]) > 0.3]
    directions = shapes.random_directions(random, len(origins))
    cache = support.tree_of(shapes.nurbs_torus(), kind, tree, depth_limit=22)
    got, truth = cache.ask(origins, directions), cache.trace(origins, directions)
    by = got["answered_by"]
    assert (by == ORIGIN).any() and (by == CELL_MISSED).any(), support.counts(got)
    # The rest are silhouettes thinner than a cell, between its samples.
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


def test_a_path_inside_glass_ends_after_64_hits(tree):
    """A light guide: total reflections along a rod of 1 x 1 x 200."""
    rod = support.cuboid((0.5, 0.5, 100.0))
    cache = support.tree_of(rod, "GLASS", tree, ior=1.5)
    random = np.random.default_rng(4)
    origins = np.concatenate([random.uniform(-0.4, 0.4, (50, 2)), np.full((50, 1), -100.5)], axis=1)
    directions = shapes.unit(np.array([[0.9, 0.4, 1.0]]) + random.uniform(-0.01, 0.01, (50, 3)))
    origins = origins - 0.2 * directions
    for got in (cache.trace(origins, directions), cache.ask(origins, directions)):
        inside = got["hit"] & (got["position"][:, 2] < -99.99)
        assert inside.sum() > 10
        assert (got["ending"][inside] == 2).all() and (got["interior_hits"][inside] == 64).all()
        # All paths that are cut off are alike: their first hit takes the place of the ray that leaves.
        assert (got["total_reflections"][inside] == 0).all() and (got["exit_class"][inside] == 0).all()
        np.testing.assert_array_equal(got["exit_direction"][inside], got["normal"][inside])


def test_no_blend_crosses_a_border_of_total_reflection(tree):
    """A prism with a right angle: rays through its hypotenuse change from refraction to total reflection."""
    vertices = np.array([[-1, -1, -1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1], [1, -1, 1], [-1, 1, 1]], np.float32)
    faces = [[0, 2, 1], [3, 4, 5], [0, 1, 4], [0, 4, 3], [0, 3, 5], [0, 5, 2], [1, 2, 5], [1, 5, 4]]
    prism = shapes.trace.TriangleMesh("prism", vertices, np.array(faces, np.int32))
    random = np.random.default_rng(12)
    origins = np.column_stack([np.full(3000, -4.0), random.uniform(-0.7, -0.1, 3000), random.uniform(-0.5, 0.5, 3000)])
    directions = shapes.unit(np.array([[1.0, 0.0, 0.0]]) + random.uniform(-0.25, 0.25, (3000, 3)) * [0, 1, 0.3])
    cache = support.tree_of(prism, "GLASS", tree, ior=1.45, depth_limit=32)
    got, truth = cache.ask(origins, directions), cache.trace(origins, directions)
    assert len({*truth["total_reflections"][truth["hit"]]}) > 1
    used = got["answered_by"] == INTERPOLATED
    assert used.sum() > 300, support.counts(got)
    # Cells as narrow as the depth allows may still hide a border between their samples.
    assert (got["total_reflections"] != truth["total_reflections"])[used].mean() < 0.01
    same = used & (got["total_reflections"] == truth["total_reflections"]) & (got["exit_class"] == truth["exit_class"])
    assert np.degrees(support.angles(got["exit_direction"], truth["exit_direction"])[same]).max() < 2.0


def test_an_object_that_changes_shape_every_frame(tree):
    origins, directions = support.scattered_rays(300, spread=0.5)
    for frame in range(6):
        shape = sphere_at(0.05 * frame, 1.0 - 0.08 * frame)
        cache = support.tree_of(shape, "MIRROR", tree, cache_bytes=100_000)
        check_close(cache, origins, directions, 0.02)
        assert cache.statistics()["bytes"] <= 100_000


@pytest.mark.parametrize(
    "argument,value",
    [
        ("distance_threshold", -0.1),
        ("distance_threshold", np.nan),
        ("angle_threshold", -1.0),
        ("angle_threshold", np.nan),
        ("depth_limit", -1),
        ("depth_limit", 61),
        ("direction_threshold", -1.0),
        ("direction_threshold", np.nan),
        ("pruned_share", 0.0),
        ("pruned_share", 1.5),
        ("ior", 0.0),
        ("ior", np.inf),
        ("facet_tolerance", 0.0),
    ],
)
def test_settings_without_meaning_are_named(tree, argument, value):
    with pytest.raises(_core.InputError, match=f"cube.*{argument}"):
        support.tree_of(shapes.cube(), "MIRROR", tree, **{argument: value})


def test_a_kind_that_is_none_and_arrays_that_do_not_fit_are_named(tree):
    with pytest.raises(_core.InputError, match="kind"):
        support.tree_of(shapes.cube(), "MATTE", tree)
    cache = support.tree_of(shapes.cube(), "MIRROR", tree)
    with pytest.raises(_core.InputError, match="origins"):
        cache.ask(np.zeros(3), np.zeros(3))
    with pytest.raises(_core.InputError, match="directions"):
        cache.ask(np.zeros((2, 3)), np.zeros((3, 3)))
