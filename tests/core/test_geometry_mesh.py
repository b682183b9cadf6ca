"""Triangle meshes: invalid input, and the surface at a hit."""

import numpy as np
import pytest
from core import shapes
from rayleaf import _core

trace = shapes.trace
SQUARE = np.array([[0, 0, 0], [2, 0, 0], [2, 1, 0], [0, 1, 0]], np.float32)
HALVES = np.array([[0, 1, 2], [0, 2, 3]], np.int32)


def down_on(mesh, points):
    points = np.asarray(points, float)
    origins = np.column_stack([points, np.full(len(points), 5.0)])
    tracer = trace.Tracer([(mesh, np.eye(4), 31)])
    return tracer.closest_hits(origins, np.broadcast_to([0.0, 0.0, -1.0], origins.shape))


@pytest.mark.parametrize(
    "change,words",
    [
        ({"vertices": np.full((4, 3), np.nan, np.float32)}, "vertices[0]"),
        ({"vertices": np.full((4, 3), np.inf, np.float32)}, "finite"),
        ({"triangles": np.array([[0, 1, 4]], np.int32)}, "triangles[2] is 4"),
        ({"triangles": np.array([[0, -1, 2]], np.int32)}, "triangles[1] is -1"),
        ({"triangles": np.array([0, 1, 2, 3], np.int32)}, "multiple of 3"),
        ({"corner_normals": np.zeros(9, np.float32)}, "corner_normals"),
        ({"material_slots": np.array([0], np.int32)}, "material_slots"),
        ({"material_slots": np.array([0, -2], np.int32)}, "material_slots is -2"),
        ({"uv": np.zeros((2, 3), np.float32)}, "attributes[0]"),
        ({"uv": np.full((2, 3, 2), np.nan, np.float32)}, "attributes[0]"),
    ],
)
def test_bad_arrays_are_refused_with_the_objects_name(change, words):
    with pytest.raises(_core.InputError) as error:
        trace.TriangleMesh(**({"name": "Roof", "vertices": SQUARE, "triangles": HALVES} | change))
    assert "'Roof'" in str(error.value) and words in str(error.value)


def test_texture_coordinates_and_their_derivatives_are_those_of_the_corners():
    uv = (SQUARE[HALVES][..., :2] * [0.25, 3.0] + [0.1, 0.2]).astype(np.float32)
    points = np.random.default_rng(1).uniform([0.05, 0.05], [1.95, 0.95], (50, 2))
    hits = down_on(trace.TriangleMesh("square", SQUARE, HALVES, uv=uv), points)
    np.testing.assert_allclose(hits["uv"], points * [0.25, 3.0] + [0.1, 0.2], atol=1e-6)
    np.testing.assert_allclose(hits["derivatives"][:, 0], np.broadcast_to([4.0, 0, 0], (50, 3)), atol=1e-5)
    np.testing.assert_allclose(hits["derivatives"][:, 1], np.broadcast_to([0, 1 / 3, 0], (50, 3)), atol=1e-5)
    np.testing.assert_array_equal(hits["derivatives"][:, 2:], 0.0)


def test_a_mesh_with_unusable_texture_coordinates_has_no_derivatives():
    uv = np.zeros((2, 3, 2), np.float32)
    hits = down_on(trace.TriangleMesh("square", SQUARE, HALVES, uv=uv), [[0.5, 0.5]])
    np.testing.assert_array_equal(hits["derivatives"], 0.0)


def test_smooth_normals_are_interpolated_and_turn_with_the_texture_coordinates():
    def exact(points):
        return shapes.unit(np.column_stack([0.3 * points[:, 0], 0.2 * points[:, 1], np.ones(len(points))]))

    # Interpolating normals that are not of unit length yet is linear in position; unit corners bend it slightly.
    corners = SQUARE[HALVES]
    normals = exact(corners.reshape(-1, 3)[:, :2]).reshape(2, 3, 3).astype(np.float32)
    uv = corners[..., :2].astype(np.float32)
    mesh = trace.TriangleMesh("square", SQUARE, HALVES, corner_normals=normals, uv=uv)
    points = np.array([[0.5, 0.2], [1.5, 0.9], [1.2, 0.4]])
    hits = down_on(mesh, points)
    np.testing.assert_allclose(np.linalg.norm(hits["normal"], axis=1), 1, atol=1e-6)
    assert np.abs(hits["normal"] - exact(points)).max() < 0.03
    step = 1e-3
    for axis in range(2):
        offset = step * np.eye(2)[axis]
        change = (down_on(mesh, points + offset)["normal"] - down_on(mesh, points - offset)["normal"]) / (2 * step)
        np.testing.assert_allclose(hits["derivatives"][:, 2 + axis], change, atol=2e-4)  # float normals over 2e-3


def test_normals_that_point_inwards_are_turned_to_the_side_of_the_winding():
    normals = np.broadcast_to(np.float32([0.6, 0, -0.8]), (2, 3, 3))
    hits = down_on(trace.TriangleMesh("square", SQUARE, HALVES, corner_normals=normals), [[0.5, 0.5]])
    np.testing.assert_allclose(hits["normal"][0], [-0.6, 0, 0.8], atol=1e-6)


def test_a_far_mesh_keeps_the_precision_of_its_vertices():
    offset = np.float32(2**20)
    mesh = trace.TriangleMesh("far", SQUARE + [offset, 0, 0], HALVES)
    tracer = trace.Tracer([(mesh, np.eye(4), 31)])
    hits = tracer.closest_hits([[offset + 1.25, 0.5, 3.0]], [[0.0, 0.0, -1.0]])
    np.testing.assert_array_equal(hits["facet_position"], [[offset + 1.25, 0.5, 0.0]])
    assert hits["t"][0] == 3.0
