"""The fast tree in extreme cases: settings, shapes, places and rays."""

import numpy as np
import pytest
from core import ri_tree_support as support
from core import shapes
from core.ri_tree_support import ANGLE, BOX_MISSED, ERROR, INTERPOLATED, LARGE_CELL, MANY_CLASSES
from core.test_fast_tree import fast_tree
from core.test_ri_tree_extremes import sphere_at
from rayleaf import _core

EXACT = {"distance_threshold": 0.0, "direction_threshold": 0.0}
ANYTHING = {"distance_threshold": np.inf, "direction_threshold": np.inf, "angle_threshold": np.inf}


@pytest.mark.parametrize("kind", ["SIMPLE", "GLASS", "VOLUME"])
def test_thresholds_of_zero_give_tracings_own_answers(kind):
    rays = support.rays_towards(np.zeros(3), 1.2, 300)
    tree = fast_tree(shapes.nurbs_sphere(), kind, depth_limit=16, mixed_depth_limit=8, **EXACT)
    got, truth = tree.ask(*rays), tree.trace(*rays)
    hit = truth["hit"]
    assert set(np.unique(got["answered_by"][hit])) <= {MANY_CLASSES, ANGLE, LARGE_CELL, ERROR}, support.counts(got)
    for name in support.OUTPUTS:
        np.testing.assert_array_equal(got[name][hit], truth[name][hit], err_msg=name)


def test_infinite_thresholds_and_depth_zero_still_answer_with_finite_numbers():
    rays = support.rays_towards(np.zeros(3), 1.2, 300)
    for settings in (ANYTHING, {"depth_limit": 0}, {"depth_limit": 0, **ANYTHING}, {"depth_limit": 60, **ANYTHING}):
        tree = fast_tree(shapes.nurbs_sphere(), "GLASS", **settings)
        got, truth = tree.ask(*rays), tree.trace(*rays)
        for name in ("position", "normal", "exit_position", "exit_direction", "error"):
            assert np.isfinite(got[name]).all(), (settings, name)
        # Whatever the allowed error, no cell with misses and hits is interpolated.
        assert (got["hit"] != truth["hit"]).mean() < 0.01, (settings, support.counts(got))
        if settings.get("depth_limit") == 0:
            np.testing.assert_array_equal(got["exit_direction"], truth["exit_direction"])


def test_a_sheet_without_thickness_and_a_needle():
    origins, directions = support.rays_towards(np.zeros(3), 0.5, 500, eye=(0.2, -1.0, 2.5))
    tree = fast_tree(support.square(), "MIRROR", depth_limit=40)
    got, truth = tree.ask(origins, directions), tree.trace(origins, directions)
    used = got["answered_by"] == INTERPOLATED
    assert used.mean() > 0.2, support.counts(got)
    assert (got["hit"] != truth["hit"]).mean() < 0.01
    both = used & truth["hit"]
    # All normals are equal, and the sheet is the middle plane: exact up to the rounding of floats.
    np.testing.assert_allclose(got["exit_direction"][both], truth["exit_direction"][both], atol=3e-7)
    np.testing.assert_allclose(got["position"][both], truth["position"][both], atol=3e-7)
    thin = support.cuboid((1e-5, 1.0, 1e-5))
    at_needle = np.zeros((200, 3))
    at_needle[:, 1] = np.linspace(-0.9, 0.9, 200)
    at_needle[::2, 0] = 3e-6
    towards = shapes.unit(at_needle - origins[:200])
    needle = fast_tree(thin, "SIMPLE", depth_limit=60, mixed_depth_limit=60)
    got, truth = needle.ask(origins[:200], towards), needle.trace(origins[:200], towards)
    assert truth["hit"].all() and got["hit"].all(), support.counts(got)
    np.testing.assert_allclose(got["position"], truth["position"], atol=0.02)


@pytest.mark.parametrize("center,scale", [(0.0, 2.0**-20), (0.0, 2.0**20), (2.0**20, 1.0)])
def test_size_and_place_of_an_object_change_nothing(center, scale):
    """About 1e-6, 1e6 and at 1e6, as powers of two: the local space is then the same bit by bit."""
    origins, directions = support.scattered_rays(400, spread=0.5)
    origins = np.round(origins * 2.0**30) / 2.0**30  # so that adding 2^20 rounds nothing
    here = fast_tree(sphere_at(0.0, 1.0), "GLASS").ask(origins, directions)
    there = fast_tree(sphere_at(center, scale), "GLASS").ask(origins * scale + center, directions)
    assert (here["answered_by"] == INTERPOLATED).any(), support.counts(here)
    np.testing.assert_array_equal(here["answered_by"], there["answered_by"])
    # Control points at 2^20 are rounded to 2^-32; leaves are stored in floats.
    np.testing.assert_allclose((there["exit_position"] - center) / scale, here["exit_position"], atol=1e-6)
    np.testing.assert_allclose(there["exit_direction"], here["exit_direction"], atol=1e-6 if center else 0)


def test_rays_from_afar_and_with_long_and_short_directions():
    origins, directions = support.scattered_rays(400, spread=0.5)
    tree = fast_tree(shapes.nurbs_sphere(), "MIRROR")
    near = tree.ask(origins, directions)
    for length in (1e200, 1e-200):
        far = tree.ask(origins - 1e6 * directions, length * directions)
        # A start at 1e6 is rounded to 1e-10, which may decide a cell's side.
        assert (near["answered_by"] == far["answered_by"]).mean() > 0.99
        np.testing.assert_allclose(near["exit_direction"], far["exit_direction"], atol=2e-3)


def test_rays_in_the_faces_of_the_box_and_on_its_diagonals():
    """Ties of the dominant direction, and lines along faces and edges of the shape."""
    corners = shapes.CUBE_VERTICES.astype(float)
    pairs = [(a, b) for a in corners for b in corners if (a != b).any()]
    origins = np.array([a - 3 * (b - a) for a, b in pairs])
    directions = shapes.unit(np.array([b - a for a, b in pairs]))
    for shape in (shapes.cube(), shapes.nurbs_sphere()):
        tree = fast_tree(shape, "SIMPLE", depth_limit=16)
        got, truth = tree.ask(origins, directions), tree.trace(origins, directions)
        assert np.isfinite(got["position"]).all()
        diagonal = (np.abs(directions) > 0.5).all(axis=1)
        np.testing.assert_array_equal(got["hit"][diagonal], truth["hit"][diagonal])


def test_an_empty_shape_and_flat_shading():
    empty = shapes.trace.TriangleMesh("empty", np.empty((0, 3), np.float32), np.empty((0, 3), np.int32))
    rays = support.scattered_rays(10)
    got = fast_tree(empty, "MIRROR").ask(*rays)
    assert (got["answered_by"] == BOX_MISSED).all() and not got["hit"].any()
    flat = fast_tree(shapes.nurbs_sphere(smooth=False), "MIRROR")
    rays = support.rays_towards(np.zeros(3), 0.3, 50)
    got, truth = flat.ask(*rays), flat.trace(*rays)
    assert (got["answered_by"] == MANY_CLASSES).all(), support.counts(got)
    np.testing.assert_array_equal(got["normal"], truth["normal"])


def test_a_path_inside_glass_ends_after_64_hits():
    """A light guide: total reflections along a rod of 1 x 1 x 200."""
    random = np.random.default_rng(4)
    origins = np.concatenate([random.uniform(-0.4, 0.4, (50, 2)), np.full((50, 1), -100.5)], axis=1)
    directions = shapes.unit(np.array([[0.9, 0.4, 1.0]]) + random.uniform(-0.01, 0.01, (50, 3)))
    origins = origins - 0.2 * directions
    got = fast_tree(support.cuboid((0.5, 0.5, 100.0)), "GLASS", ior=1.5).ask(origins, directions)
    inside = got["hit"] & (got["position"][:, 2] < -99.99)
    assert inside.sum() > 10
    assert (got["ending"][inside] == 2).all() and (got["interior_hits"][inside] == 64).all()


@pytest.mark.parametrize(
    "argument,value",
    [("direction_threshold", np.nan), ("direction_threshold", -1.0), ("mixed_depth_limit", 61), ("depth_limit", -1),
     ("rays_per_cell", np.nan), ("rays_per_cell", -1.0)],  # fmt: skip
)
def test_settings_without_meaning_are_named(argument, value):
    with pytest.raises(_core.InputError, match=f"cube.*{argument}"):
        fast_tree(shapes.cube(), "MIRROR", **{argument: value})
