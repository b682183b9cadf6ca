"""The answers of the published tree: against closed forms, against tracing, and where samples must not blend."""

import numpy as np
import pytest
from core import ri_tree_support as support
from core import shapes
from core.ri_tree_support import INTERPOLATED, TWO_CLASS_MISSED, TWO_CLASSES

IOR = 1.5


def test_tracing_a_mirror_plane_agrees_with_the_closed_form():
    origins, directions = support.rays_towards(np.zeros(3), 0.5, 2000, eye=(0.2, -1.0, 2.0))
    # Rays are interpolated if their cells span less than the angle; with any angle, nearly all are.
    for angle in (np.radians(30), support.ANY_ANGLE):
        tree = support.tree_of(support.square(), "MIRROR", angle_threshold=angle)
        got = tree.ask(origins, directions)
        t = -origins[:, 2] / directions[:, 2]
        inside = (np.abs(origins + t[:, None] * directions)[:, :2] < 1).all(axis=1)
        np.testing.assert_array_equal(got["hit"], inside)
        expected = directions * [1, 1, -1]
        # Normals of all corners are equal and stored exactly, so the direction is exact however large the cell is.
        np.testing.assert_allclose(got["exit_direction"][inside], expected[inside], atol=1e-7)
        # The square lies in the middle plane: the hit is the line's intercepts, which interpolation reproduces.
        np.testing.assert_allclose(got["position"][inside], (origins + t[:, None] * directions)[inside], atol=1e-6)
    assert (got["answered_by"] == INTERPOLATED).mean() > 0.5, support.counts(got)


def test_some_corners_of_a_cell_reproduce_affine_functions():
    """At a border some corners hit and some miss; hits in the middle plane are affine functions of the line."""
    origins, directions = support.rays_towards(np.zeros(3), 0.3, 3000, eye=(0.2, -1.0, 2.0))
    settings = {"depth_limit": 22, "angle_threshold": support.ANY_ANGLE}
    # A slanted border: along an axis, the corners that hit would all be on one side of the cell, which is not enough.
    corners = np.array([[-1, -1, 0], [1, -1, 0], [-0.5, 1, 0]], np.float32)
    triangle = shapes.trace.TriangleMesh("triangle", corners, np.array([[0, 1, 2]], np.int32))
    tree = support.tree_of(triangle, "MIRROR", **settings)
    got = tree.ask(origins, directions)
    two_classes = got["answered_by"] == TWO_CLASSES
    assert two_classes.sum() > 20, support.counts(got)
    t = -origins[:, 2] / directions[:, 2]
    expected = origins + t[:, None] * directions
    np.testing.assert_allclose(got["position"][two_classes], expected[two_classes], atol=2e-6)
    np.testing.assert_array_equal(got["hit"], tree.trace(origins, directions)["hit"])


def test_a_mirror_sphere_agrees_with_the_closed_form():
    origins, directions = support.rays_towards(np.zeros(3), 0.8, 3000)
    points, hit = support.sphere_hit(origins, directions)
    assert hit.all()
    expected = support.reflected(directions, points)
    tree = support.tree_of(shapes.nurbs_sphere(), "MIRROR", distance_threshold=0.004)
    truth, got = tree.trace(origins, directions), tree.ask(origins, directions)
    # Facets are 2^-20 from the sphere; at glancing incidence that moves the hit by more.
    assert np.quantile(support.angles(truth["exit_direction"], expected), 0.99) < 2e-4
    interpolated = got["answered_by"] == INTERPOLATED
    assert interpolated.mean() > 0.5, support.counts(got)
    error = support.angles(got["exit_direction"], expected)[interpolated]
    # The threshold bounds the distance at cell centres: 0.004 at a reach of 2 is 0.002 radians there. Between centre
    # and corners, the error of quadrilinear interpolation of a quadratic function is at most that at the centre.
    assert error.mean() < 0.002 and np.quantile(error, 0.99) < 0.006


def test_a_glass_ball_agrees_with_the_closed_form():
    origins, directions = support.rays_towards(np.zeros(3), 0.7, 3000)
    position, direction = support.through_glass_ball(origins, directions, IOR)
    tree = support.tree_of(shapes.nurbs_sphere(), "GLASS", ior=IOR, distance_threshold=0.004)
    truth, got = tree.trace(origins, directions), tree.ask(origins, directions)
    np.testing.assert_allclose(truth["exit_position"], position, atol=3e-4)
    np.testing.assert_allclose(truth["exit_direction"], direction, atol=3e-4)
    assert (truth["interior_hits"] == 1).all() and (truth["total_reflections"] == 0).all()
    interpolated = got["answered_by"] == INTERPOLATED
    assert interpolated.mean() > 0.5, support.counts(got)
    assert support.angles(got["exit_direction"], direction)[interpolated].mean() < 0.002
    assert np.linalg.norm(got["exit_position"] - position, axis=1)[interpolated].mean() < 0.002


@pytest.mark.parametrize("half", [(1, 1, 1), (2.0, 0.5, 0.03)])
def test_the_length_inside_a_slab_agrees_with_the_closed_form(half):
    origins, directions = support.scattered_rays(4000, distance=5.0)
    expected = support.cuboid_length(origins, directions, half)
    tree = support.tree_of(support.cuboid(half), "VOLUME", depth_limit=24)
    truth, got = tree.trace(origins, directions), tree.ask(origins, directions)
    np.testing.assert_allclose(truth["length"], expected, atol=2e-6)
    # Within a cell whose lines cross one pair of faces the length is smooth; the threshold is a share of the half side.
    # The error elsewhere in a cell may exceed that at its centre by a little: the length is not quite quadratic.
    assert np.abs(got["length"] - expected).max() < 4 * 0.01 * max(half), support.counts(got)
    assert set(np.unique(got["answered_by"])) & {INTERPOLATED, TWO_CLASSES}


def test_a_volume_counts_nested_and_separate_bodies():
    """Two cubes in a row, the second around a third one: nested bodies of one shape count once."""
    sizes, centers = (1.0, 1.0, 0.5), (0.0, 3.0, 3.0)
    vertices = np.concatenate([shapes.CUBE_VERTICES * s + [c, 0, 0] for s, c in zip(sizes, centers)])
    triangles = np.concatenate([shapes.CUBE_TRIANGLES + 8 * i for i in range(3)])
    shape = shapes.trace.TriangleMesh("row", vertices.astype(np.float32), triangles)
    tree = support.tree_of(shape, "VOLUME")
    got = tree.trace(np.array([[-5.0, 0.1, 0.2], [0.5, 0.1, 0.2], [10.0, 0.1, 0.2]]), np.array([[1.0, 0, 0]] * 3))
    np.testing.assert_allclose(got["length"], [4.0, 2.5, 0.0], atol=1e-6)
    np.testing.assert_array_equal(got["hit"], [True, True, False])


@pytest.mark.parametrize("kind", ["SIMPLE", "MIRROR", "GLASS", "VOLUME"])
def test_the_error_at_the_centre_of_a_cell_is_within_the_threshold(kind):
    threshold, limit = 0.004, 40
    shape = shapes.cube() if kind == "VOLUME" else shapes.nurbs_sphere()
    # Away from edges, seams and silhouettes, so that the limit of depth is never reached.
    target, radius = (np.zeros(3), 0.4) if kind == "VOLUME" else (np.array([0.3, -0.6, 0.1]), 0.1)
    origins, directions = support.rays_towards(target, radius, 60)
    settings = {"distance_threshold": threshold, "depth_limit": limit, "angle_threshold": support.ANY_ANGLE}
    tree = support.tree_of(shape, kind, **settings)
    cells = {str(cell): cell for cell in tree.final_cells(origins, directions)}.values()
    assert len(cells) > 5 and all(cell[1] < limit for cell in cells)
    rays = [np.concatenate(part) for part in zip(*[tree.center_ray(cell) for cell in cells])]
    extent = max(np.array(tree.box()[1]) - np.array(tree.box()[0])) / 2 / (1 + 2.0**-10)
    # Half extents of these shapes are 1, so local space, that of the centre rays, is object space.
    got, truth = tree.ask(*rays), tree.trace(*rays)
    assert (got["answered_by"] == INTERPOLATED).all(), support.counts(got)
    if kind == "VOLUME":
        distance = np.abs(got["length"] - truth["length"])
    else:
        start = got["exit_position"] - truth["exit_position"]
        end = start + 2 * extent * (got["exit_direction"] - truth["exit_direction"])
        distance = np.sqrt(np.sum(start**2, axis=1) + np.sum(end**2, axis=1))
    assert distance.max() <= threshold * extent * (1 + 1e-6)
    assert (got["error"] <= threshold).all() and (got["error"] >= distance / extent - 1e-6).all()


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["SIMPLE", "MIRROR", "GLASS"])
def test_the_error_is_of_second_order_in_the_cells_sides(kind):
    """Four more halvings halve every side: a quarter of the error."""
    origins, directions = support.rays_towards(np.zeros(3), 0.5, 400)
    errors = []
    for depth in (20, 24, 28):
        settings = {"distance_threshold": 0.0, "depth_limit": depth, "angle_threshold": support.ANY_ANGLE}
        tree = support.tree_of(shapes.nurbs_sphere(), kind, **settings)
        got, truth = tree.ask(origins, directions), tree.trace(origins, directions)
        interpolated = got["answered_by"] == INTERPOLATED
        assert interpolated.mean() > 0.5, (depth, support.counts(got))
        errors.append(support.angles(got["exit_direction"], truth["exit_direction"])[interpolated].mean())
    ratios = np.array(errors[:-1]) / errors[1:]
    # 4 in the limit; less here, because the cells of these rays are not all halved along the same axes.
    assert (ratios > 3.2).all() and (ratios < 4.8).all(), errors


def test_a_smaller_threshold_gives_a_smaller_error():
    origins, directions = support.rays_towards(np.zeros(3), 0.6, 500)
    errors, samples = [], []
    for threshold in (0.1, 0.03, 0.01, 0.003):
        settings = {"distance_threshold": threshold, "depth_limit": 40, "angle_threshold": support.ANY_ANGLE}
        tree = support.tree_of(shapes.nurbs_sphere(), "MIRROR", **settings)
        got, truth = tree.ask(origins, directions), tree.trace(origins, directions)
        interpolated = got["answered_by"] == INTERPOLATED
        errors.append(support.angles(got["exit_direction"], truth["exit_direction"])[interpolated].mean())
        samples.append(tree.statistics()["samples_taken"])
    assert errors == sorted(errors, reverse=True) and errors[-1] < errors[0] / 8, errors
    assert samples == sorted(samples), samples


def test_nothing_is_blended_over_the_edges_of_a_cube():
    tree = support.tree_of(shapes.cube(), "SIMPLE", depth_limit=20)
    assert tree.class_count == 6
    origins, directions = support.scattered_rays(6000, spread=1.8)
    got, truth = tree.ask(origins, directions), tree.trace(origins, directions)
    np.testing.assert_array_equal(got["hit"], truth["hit"])
    hit = truth["hit"]
    # Face normals are exact in floats, so a blend of two would be detected.
    np.testing.assert_array_equal(got["normal"][hit], truth["normal"][hit])
    np.testing.assert_array_equal(got["first_class"], truth["first_class"])
    by = got["answered_by"]
    for kind in (INTERPOLATED, TWO_CLASSES, TWO_CLASS_MISSED):
        assert (by == kind).any(), support.counts(got)


def test_classes_follow_smoothness():
    sphere = shapes.nurbs_sphere()
    assert support.tree_of(sphere, "MIRROR").class_count == 1
    assert support.tree_of(shapes.nurbs_torus(), "MIRROR").class_count == 1
    # Texture coordinates jump at a seam: where they are stored the sphere is cut open, and so are both ways of a torus,
    # which stay one class: it can be walked around within the cuts.
    assert support.tree_of(shapes.nurbs_torus(), "SIMPLE").class_count == 1
    # Flat shaded splines have no class, so nothing is interpolated.
    faceted = support.tree_of(shapes.nurbs_sphere(smooth=False), "MIRROR")
    assert faceted.class_count == 0
    origins, directions = support.rays_towards(np.zeros(3), 0.3, 50)
    answers = faceted.ask(origins, directions)
    assert (answers["answered_by"] == support.MANY_CLASSES).all(), support.counts(answers)
    np.testing.assert_array_equal(answers["normal"], faceted.trace(origins, directions)["normal"])


def test_a_silhouette_is_where_tracing_has_it():
    """Rays around the rim of a ball, where cells contain misses and hits: the first-hit test decides."""
    random = np.random.default_rng(8)
    angle, radius = random.uniform(0, 2 * np.pi, 1500), random.uniform(0.9, 1.1, 1500)
    points = np.stack([radius * np.cos(angle), radius * np.sin(angle), np.zeros(1500)], axis=1)
    origins = np.broadcast_to([0.0, 0.0, 30.0], points.shape).copy()
    directions = shapes.unit(points - origins)
    tree = support.tree_of(shapes.nurbs_sphere(), "SIMPLE", depth_limit=24)
    got, truth = tree.ask(origins, directions), tree.trace(origins, directions)
    decided = np.isin(got["answered_by"], (TWO_CLASSES, TWO_CLASS_MISSED))
    assert decided.mean() > 0.1, support.counts(got)
    np.testing.assert_array_equal(got["hit"][decided], truth["hit"][decided])
    # Elsewhere the rim may cut a cell's side without touching corners or centre.
    assert (got["hit"] != truth["hit"]).mean() < 0.01
