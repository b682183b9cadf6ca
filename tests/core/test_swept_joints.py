"""Rings where segments of bevelled curves meet, begin and end: place and direction as in Blender."""

import numpy as np
import pytest
from core import shapes
from core import swept_support as swept
from rayleaf import _core


def rings_of(shape):
    """(n, 3, 3) centre, x and y direction at both ends of each piece, in object units."""
    pieces = np.arange(shape.element_count)
    rings = shape.rings(np.stack([pieces, pieces + 1 - 1e-12], axis=1).ravel())[:, :3]
    center, scale = shape.frame
    rings = rings * scale
    rings[:, 0] += center
    return rings


def test_tangent_twist_keeps_its_side_where_the_second_derivative_passes_through_zero():
    """A third of the way from a vector handle: the curve bends the other way there, in a plane."""
    points = np.array([[0.0, 0, 0], [3, 0.3, 0.6]])
    handles = np.array([[[-1, 0, 0], points[1] / 3], [[2.2, -0.8, 1.2], [4, 0, 0]]])
    across = shapes.unit(rings_of(swept.surface("BEZIER", points, handles, extrude=0.1, twist="TANGENT"))[:, 1])
    assert np.sum(across[:-1] * across[1:], axis=1).min() > 0.5


def test_tangent_twist_ends_on_the_side_that_its_last_ring_has_by_itself():
    """The second derivative turns by more than a right angle: the first ring takes the side of the last, and carries it on."""
    points = np.array([[0.0, 0, 0], [2, 0, 0]])
    handles = np.array([[[0, -1, 0], [0, 1.0, 0]], [[2, 1, 0.5], [2, -1, 0]]])
    begin, *_, before, last = rings_of(swept.surface("BEZIER", points, handles, extrude=0.1, twist="TANGENT"))
    np.testing.assert_allclose(last[1:], -before[1:], atol=1e-6)
    second_begin, second_end = handles[1, 0] - 2 * handles[0, 1], handles[0, 1] - 2 * handles[1, 0] + points[1]
    assert second_begin @ second_end < 0
    assert last[2] @ second_end < 0  # Y lies opposite to the second derivative,
    assert begin[2] @ second_begin > 0  # at the begin to the one that is turned round


def test_blender_cuts_the_corner_of_a_nurbs_polygon_in_the_plane():
    """No sample lies at the corner: two rings, on either side of the chord from one leg to the other, as long as each has of it."""
    points = np.array([[0.0, 0, 0], [1, 0, 0], [1, 2, 0], [3, 2, 0]])
    shape = swept.surface("NURBS", points, dimensions="2D", bevel_depth=0.1, order=2, endpoint=True)
    rings = rings_of(shape)
    at_corner = rings[np.linalg.norm(rings[:, 0] - points[1], axis=1) < 1e-6]
    widths = np.linalg.norm(at_corner[:, 1], axis=1)
    directions = shapes.unit(at_corner[:, 1])
    # The corner is a third of the way: a sample lies two thirds of a step before it, and a third after it.
    chord = np.arctan2(2 * (1 / 3), 1 * (2 / 3))
    for angle, turned in ((chord / 2, chord), ((chord + np.pi / 2) / 2, np.pi / 2 - chord)):
        found = np.isclose(directions @ [-np.sin(angle), np.cos(angle), 0], 1, atol=1e-9)
        assert found.any()
        np.testing.assert_allclose(widths[found], 1 / np.cos(turned / 2), rtol=1e-9)


def test_the_taper_of_a_closed_polygon_ends_at_its_last_point():
    points = np.array([[0.0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0]])
    taper = swept.splines("POLY", [[0, 1, 0], [1, 4, 0]])
    shape = swept.surface("POLY", points, cyclic=True, bevel_depth=0.1, taper=taper, twist="Z_UP")
    radii = np.linalg.norm(rings_of(shape)[:, 2], axis=1)
    np.testing.assert_allclose(radii, [1, 2, 2, 3, 3, 4, 4, 1], atol=1e-6)


@pytest.mark.parametrize("ends_at_seam", [False, True])
def test_the_taper_of_a_smooth_closed_spline_goes_back_at_its_end(ends_at_seam):
    angle = np.arange(6) * np.pi / 3
    points = np.stack([np.cos(angle), np.sin(angle), np.zeros(6)], axis=1)
    taper = swept.splines("POLY", [[0, 1, 0], [1, 4, 0]])
    shape = swept.surface("NURBS", points, cyclic=True, bevel_depth=0.1, taper=taper, ends_at_seam=ends_at_seam)
    radii = np.linalg.norm(rings_of(shape)[:, 2], axis=1)
    np.testing.assert_allclose(radii[[0, -3, -2, -1]], [1, 4, 4, 1], atol=1e-6)


def test_a_closed_spline_of_two_rings_is_open_has_no_caps_and_is_not_cut():
    points, handles = np.array([[0.0, 0, 0], [3, 0, 0]]), np.array([[[-1.0, 0, 0], [1, 0, 0]], [[2, 0, 0], [4, 0, 0]]])
    given = {"cyclic": True, "radii": np.array([1.0, 2]), "tilts": np.array([0.0, 0.5])}
    shape = swept.surface(
        "BEZIER",
        points,
        handles,
        straight=np.array([True, True]),
        bevel_depth=0.1,
        bevel_start=0.3,
        bevel_end=0.6,
        fill_caps=True,
        **given,
    )
    first, last = shape.rings(np.array([0.0, 1 - 1e-12])) * shape.frame[1]
    np.testing.assert_allclose(first[0] + shape.frame[0], points[1], atol=1e-6)  # it runs from its last point
    np.testing.assert_allclose(last[0] + shape.frame[0], points[0], atol=1e-6)
    np.testing.assert_allclose(np.linalg.norm([first[1], last[1]], axis=1), [2, 1], atol=1e-6)
    tracer = _core.trace.Tracer([(shape, np.eye(4), shapes.EVERYTHING)], eye=(0, 0, 5))
    along = tracer.closest_hits(np.array([[5.0, 0.01, 0.02]]), np.array([[-1.0, 0, 0]]))
    assert along["instance"][0] < 0
