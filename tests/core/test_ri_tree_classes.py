"""Which patches and triangles belong to one class: samples are blended only within a class."""

import numpy as np
import pytest
from core import ri_tree_support as support
from core import shapes

UP, TILTED = (0.0, 0.0, 1.0), (0.0, 0.6, 0.8)
# Two triangles over an edge, bent by 0.5.
BENT = np.array([[-1, -1, 0], [1, -1, 0.5], [1, 1, 0], [-1, 1, 0.5]], np.float32)
TWO = np.array([[0, 1, 2], [0, 2, 3]], np.int32)


def bent_mesh(normals=None, slots=(0, 0), uv=None):
    """The two triangles, with one normal each or with common normals at the shared edge."""
    more = {}
    if normals is not None:
        more["corner_normals"] = np.array(normals, np.float32)
    if uv is not None:
        more["uv"] = np.array(uv, np.float32)
    return shapes.trace.TriangleMesh("bent", BENT, TWO, material_slots=np.array(slots, np.int32), **more)


def test_triangles_join_where_their_normals_agree_along_the_edge():
    smooth = [[UP, UP, TILTED], [UP, TILTED, UP]]  # vertex 0 has one normal in both, and vertex 2
    sharp = [[UP, UP, UP], [TILTED, TILTED, TILTED]]
    half_sharp = [[UP, UP, TILTED], [UP, UP, UP]]  # agrees at vertex 0 only
    for normals, count in ((smooth, 1), (sharp, 2), (half_sharp, 2), (None, 2)):
        assert support.tree_of(bent_mesh(normals), "MIRROR").class_count == count, normals


def test_materials_part_classes():
    assert support.tree_of(bent_mesh([[UP] * 3] * 2, slots=(0, 1)), "MIRROR").class_count == 2


def test_texture_seams_part_classes_only_where_coordinates_are_stored():
    one_map = [[(0, 0), (1, 0), (1, 1)], [(0, 0), (1, 1), (0, 1)]]
    two_islands = [[(0, 0), (1, 0), (1, 1)], [(0.5, 0), (1, 1), (0, 1)]]
    for uv, kind, count in ((one_map, "SIMPLE", 1), (two_islands, "SIMPLE", 2), (two_islands, "MIRROR", 1)):
        assert support.tree_of(bent_mesh([[UP] * 3] * 2, uv=uv), kind).class_count == count, (uv, kind)


def strip(profile):
    """A quadratic spline with Bezier knots along u, straight along v."""
    points = np.ones((2, len(profile), 4))
    points[:, :, [0, 2]] = profile
    points[:, :, 1] = np.array([[0.0], [1.0]])
    return points, (3, False, True, True), (2, False, True, False), True, 0


@pytest.mark.parametrize(
    "profile,count",
    [
        ([(0, 0), (1, 0), (2, 0), (3, 0), (4, 1)], 1),  # C0 by its knots, smooth by its points
        ([(0, 0), (1, 0), (2, 0), (2, 1), (2, 2)], 2),  # a right angle
        ([(0, 0), (1, 0), (2, 0), (3, 0.01), (4, 1)], 2),  # a hundredth of a radian
    ],
)
def test_patches_join_where_the_surface_is_smooth_whatever_the_knots_say(profile, count):
    assert support.tree_of(shapes.trace.PatchSurface("strip", [strip(profile)]), "MIRROR").class_count == count


def test_splines_are_not_joined_to_one_another():
    flat = strip([(0, 0), (1, 0), (2, 0)])
    beside = strip([(2, 0), (3, 0), (4, 0)])
    assert support.tree_of(shapes.trace.PatchSurface("strips", [flat, beside]), "MIRROR").class_count == 2


def test_samples_on_both_sides_of_a_crease_are_not_blended():
    surface = shapes.trace.PatchSurface("crease", [strip([(0, 0), (1, 0), (2, 0), (2, 1), (2, 2)])])
    origins, directions = support.rays_towards(np.array([2.0, 0.5, 0.0]), 0.4, 1500, eye=(-1.0, 0.3, 2.0))
    tree = support.tree_of(surface, "SIMPLE", depth_limit=22)
    got, truth = tree.ask(origins, directions), tree.trace(origins, directions)
    both = got["hit"] & truth["hit"]
    assert set(truth["first_class"][both]) == {1, 2}
    np.testing.assert_array_equal(got["first_class"][both], truth["first_class"][both])
    # Both sides are flat: a blend would be detected in the normal.
    np.testing.assert_allclose(got["normal"][both], truth["normal"][both], atol=1e-6)
