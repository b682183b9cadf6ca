"""Normals of patches at singular points."""

import numpy as np

OPEN_QUADRATIC, OPEN_LINEAR = (3, False, False, False), (2, False, False, False)
SECOND_ORDER, INSET, NEIGHBOUR, GEOMETRIC = 1, 2, 3, 4


def sheet(core, columns):
    """Quadratic along u through the given x and z, straight along y."""
    points = np.array([[(x, y, z, 1.0) for x, z in columns] for y in (0.0, 1.0)])
    return core.trace.PatchSurface("sheet", [(points, OPEN_QUADRATIC, OPEN_LINEAR, True, 0)])


def test_a_patch_drawn_to_a_line_takes_the_normal_of_its_neighbour(core):
    """Three columns in one place: the second span of the quadratic spline is a line, the first one ends on it."""
    surface = sheet(core, [(0.0, 0.0), (1.0, 1.0), (1.0, 1.0), (1.0, 1.0)])
    assert surface.element_count == 2
    normal, counts = surface.normal_at(1, 0.25, 0.5)
    assert counts[NEIGHBOUR] == 1 and counts[GEOMETRIC] == 0, counts
    np.testing.assert_allclose(normal, np.array([-1, 0, 1]) / np.sqrt(2), atol=1e-6)


def test_without_a_smooth_neighbour_the_facet_decides(core):
    surface = sheet(core, [(1.0, 1.0), (1.0, 1.0), (1.0, 1.0)])
    normal, counts = surface.normal_at(0, 0.25, 0.5)
    assert counts[GEOMETRIC] == 1, counts
    np.testing.assert_array_equal(normal, [0, 0, 1])


def test_a_regular_point_is_not_counted(core):
    surface = sheet(core, [(0.0, 0.0), (1.0, 1.0), (2.0, 2.0)])
    normal, counts = surface.normal_at(0, 0.5, 0.5)
    assert sum(counts) == 0, counts
    np.testing.assert_allclose(normal, np.array([-1, 0, 1]) / np.sqrt(2), atol=1e-6)
