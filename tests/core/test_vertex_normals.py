"""Normals of vertices: Blender's means of the faces around, with the same bits in whatever order the faces come."""

import numpy as np
import pytest
from rayleaf import _core as core


def expected(vertices, faces):
    sums = np.zeros((len(vertices), 3))
    for face in faces:
        here = vertices[face].astype(float)
        before, after = np.roll(here, 1, axis=0) - here, np.roll(here, -1, axis=0) - here
        cosines = (before * after).sum(axis=1) / np.linalg.norm(before, axis=1) / np.linalg.norm(after, axis=1)
        area = np.cross(np.roll(here, 1, axis=0), here).sum(axis=0)
        np.add.at(sums, face, np.arccos(cosines.clip(-1, 1))[:, None] * area / np.linalg.norm(area))
    used = np.unique(np.concatenate(faces))
    return used, sums[used] / np.linalg.norm(sums[used], axis=1, keepdims=True)


def normals(vertices, faces):
    sizes = np.array([len(face) for face in faces], np.int32)
    return core.vertex_normals(vertices, sizes, np.concatenate(faces).astype(np.int32))


def rough_grid(side=40, seed=1):
    """Triangles, quads and hexagons over uneven ground."""
    numbers = np.random.default_rng(seed)
    y, x = np.mgrid[:side, :side]
    vertices = np.stack([x, y, numbers.normal(size=x.shape)], axis=-1).reshape(-1, 3).astype(np.float32)
    at = np.arange(side * side).reshape(side, side)
    faces = []
    for row in range(side - 1):
        for column in range(0, side - 2, 2):
            a, b, c = at[row, column : column + 3]
            d, e, f = at[row + 1, column : column + 3]
            kinds = ([[a, b, c, f, e, d]], [[a, b, e, d], [b, c, f, e]], [[a, b, d], [b, e, d], [b, c, f, e]])
            faces += [np.array(face) for face in kinds[numbers.integers(3)]]
    return vertices, faces


def test_normals_are_means_of_faces_by_their_angles():
    vertices, faces = rough_grid()
    used, wanted = expected(vertices, faces)
    np.testing.assert_allclose(normals(vertices, faces)[used], wanted, atol=1e-6)


def test_the_order_of_faces_and_where_they_begin_change_no_bit():
    vertices, faces = rough_grid()
    numbers = np.random.default_rng(2)
    first = normals(vertices, faces)
    for _ in range(5):
        shuffled = [np.roll(faces[i], numbers.integers(6)) for i in numbers.permutation(len(faces))]
        assert (normals(vertices, shuffled) == first).mean() > 0.999  # where a face begins may round its area's normal
        assert (normals(vertices, [faces[i] for i in numbers.permutation(len(faces))]) == first).all()


def test_a_vertex_of_very_many_faces_has_their_mean():
    count = 100_000
    angles = np.arange(count) * (2 * np.pi / count)
    rim = np.stack([np.cos(angles), np.sin(angles), np.zeros(count)], axis=1)
    vertices = np.concatenate([[(0, 0, 1)], rim]).astype(np.float32)
    around = np.arange(count, dtype=np.int32)
    faces = np.stack([np.zeros(count, np.int32), around + 1, (around + 1) % count + 1], axis=1)
    found = core.vertex_normals(vertices, np.full(count, 3, np.int32), faces.ravel())
    np.testing.assert_allclose(found[0], (0, 0, 1), atol=1e-4)


def test_vertices_without_area_look_away_from_the_origin():
    vertices = np.array([(0, 0, 0), (0, 0, 2), (3, 0, 0), (6, 0, 0)], np.float32)
    found = normals(vertices, [np.array([0, 2, 3]), np.array([1, 1, 1])])
    np.testing.assert_array_equal(found, [(0, 0, 0), (0, 0, 1), (1, 0, 0), (1, 0, 0)])


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("axis", range(3))
def test_faces_with_a_vertex_that_is_nowhere_do_not_count(bad, axis):
    vertices = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0)], np.float32)
    vertices[3, axis] = bad
    found = normals(vertices, [np.array([0, 1, 2]), np.array([1, 3, 2])])
    np.testing.assert_array_equal(found[:3], [(0, 0, 1)] * 3)


@pytest.mark.parametrize(
    ("sizes", "corners", "argument"),
    [
        ([3], [0, 1], "face_sizes"),
        ([-1, 3], [0, 1], "face_sizes"),
        ([3], [0, 1, 3], "corners"),
        ([3], [0, -1, 2], "corners"),
    ],
)
def test_faces_that_are_none_are_refused(sizes, corners, argument):
    with pytest.raises(core.InputError, match=argument):
        core.vertex_normals(np.eye(3, dtype=np.float32), np.array(sizes), np.array(corners))
