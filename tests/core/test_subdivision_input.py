"""Cages as users make them: each is either rejected with a clear message or rendered."""

import numpy as np
import pytest
from core import shapes
from core import subdivision_cages as cages
from rayleaf import _core

QUAD = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], np.float32)


def surface(vertices=QUAD, sizes=(4,), corners=(0, 1, 2, 3), **options):
    return _core.SubdivisionSurface(
        "thing", vertices, np.array(sizes, np.int32), np.array(corners, np.int32), **options
    )


BAD = {
    "NaN": (dict(vertices=np.where(QUAD == 1, np.nan, QUAD)), "vertices"),
    "infinity": (dict(vertices=np.where(QUAD == 1, np.inf, QUAD)), "vertices"),
    "an index out of range": (dict(corners=(0, 1, 2, 4)), "corners"),
    "a negative index": (dict(corners=(0, 1, 2, -1)), "corners"),
    "a vertex twice in a face": (dict(corners=(0, 1, 2, 1)), "face 0"),
    "a face of two corners": (dict(sizes=(2, 2)), "face_sizes"),
    "too few corners": (dict(corners=(0, 1, 2)), "corners"),
    "a crease to nowhere": (
        dict(crease_edges=np.array([[0, 9]], np.int32), crease_sharpness=np.ones(1, np.float32)),
        "crease_edges",
    ),
    "a crease of NaN": (
        dict(crease_edges=np.array([[0, 1]], np.int32), crease_sharpness=np.full(1, np.nan, np.float32)),
        "crease_sharpness",
    ),
    "a negative crease": (
        dict(crease_edges=np.array([[0, 1]], np.int32), crease_sharpness=np.full(1, -1, np.float32)),
        "crease_sharpness",
    ),
    "a corner without a normal": (dict(corner_normals=np.ones((3, 3), np.float32)), "corner_normals"),
    "a normal of NaN": (dict(corner_normals=np.full((4, 3), np.nan, np.float32)), "corner_normals"),
    "an unknown scheme": (dict(scheme="LOOP"), "scheme"),
    "an unknown option": (dict(uv_smoothing="SOME"), "uv_smoothing"),
    "a short UV map": (dict(uv_maps={3: np.zeros((3, 2), np.float32)}), "uv_maps"),
    "an attribute of five channels": (dict(attributes={3: np.zeros((4, 5), np.float32)}), "attributes"),
    "a slot below zero": (dict(material_slots=np.array([-1], np.int32)), "material_slots"),
}


@pytest.mark.parametrize("name", BAD)
def test_a_bad_cage_is_refused_by_name_and_argument(name):
    options, argument = BAD[name]
    with pytest.raises(_core.InputError, match=f"object 'thing'.*{argument}"):
        surface(**options)


def test_a_vertex_of_too_many_faces_is_refused():
    count = 1100
    angle = np.arange(count) * 2 * np.pi / count
    ring = np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
    faces = [(0, 1 + i, 1 + (i + 1) % count) for i in range(count)]
    with pytest.raises(_core.InputError, match="vertex 0"):
        surface(np.concatenate([[[0, 0, 1]], ring]).astype(np.float32), [3] * count, np.ravel(faces))


def rays_answer(shape):
    """Rays against the shape: finite points wherever they hit."""
    tracer = shapes.trace.Tracer([(shape, np.eye(4), shapes.EVERYTHING)])
    random = np.random.default_rng(2)
    hits = tracer.closest_hits(random.normal(size=(3000, 3)), shapes.random_directions(random, 3000))
    found = hits["instance"] >= 0
    for key in ("position", "normal", "facet_normal", "uv"):
        assert np.isfinite(hits[key][found]).all(), key
    np.testing.assert_allclose(np.linalg.norm(hits["normal"][found], axis=1), 1, atol=1e-5)
    return int(found.sum())


def three_wings():
    points = np.array([[0, 0, z] for z in (0, 1)] + [[np.cos(a), np.sin(a), z] for a in (0, 2, 4) for z in (0, 1)])
    return points.astype(np.float32), [4] * 3, [0, 2, 3, 1, 0, 4, 5, 1, 0, 6, 7, 1]


ODD = {
    "an edge of three faces": lambda **o: surface(*three_wings(), **o),
    "two faces that touch in a vertex": lambda **o: surface(
        np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [-1, 0, 0], [-1, -1, 0], [0, -1, 0]], np.float32),
        (4, 4),
        (0, 1, 2, 3, 0, 4, 5, 6),
        **o,
    ),
    "the same face twice": lambda **o: surface(sizes=(4, 4), corners=(0, 1, 2, 3, 0, 1, 2, 3), **o),
    "a face and its back": lambda **o: surface(sizes=(4, 4), corners=(0, 1, 2, 3, 3, 2, 1, 0), **o),
    "neighbours wound against each other": lambda **o: surface(
        np.concatenate([QUAD, QUAD[1:3] + [1, 0, 0]]).astype(np.float32), (4, 4), (0, 1, 2, 3, 1, 2, 5, 4), **o
    ),
    "a face that crosses itself": lambda **o: surface(corners=(0, 2, 1, 3), **o),
    "faces far apart": lambda **o: surface(np.concatenate([QUAD, QUAD + 1e6]), (4, 4), range(8), **o),
    "a Moebius strip": lambda **o: moebius(**o),
}


def moebius(count=9, **options):
    angle = np.arange(count) * 2 * np.pi / count
    points = []
    for a in angle:
        for side in (-0.3, 0.3):
            radius = 1 + side * np.cos(a / 2)
            points.append([radius * np.cos(a), radius * np.sin(a), side * np.sin(a / 2)])
    corners = []
    for i in range(count):
        a, b = 2 * i, 2 * i + 1
        c, d = (2 * i + 3, 2 * i + 2) if i + 1 < count else (0, 1)
        corners += [a, b, c, d]
    return surface(np.array(points, np.float32), [4] * count, corners, **options)


@pytest.mark.parametrize("scheme", ["CATMULL_CLARK", "BILINEAR"])
@pytest.mark.parametrize("name", ODD)
def test_an_odd_cage_is_rendered(name, scheme):
    assert rays_answer(ODD[name](scheme=scheme)) > 0


FLAT = {
    "all vertices in one place": lambda: surface(np.ones((4, 3), np.float32)),
    "all vertices on a line": lambda: surface(np.outer(np.arange(4), [1, 2, 3]).astype(np.float32)),
    "no faces": lambda: surface(sizes=(), corners=()),
    "nothing": lambda: surface(np.zeros((0, 3), np.float32), (), ()),
}


@pytest.mark.parametrize("name", FLAT)
def test_a_cage_without_area_shows_nothing(name):
    assert rays_answer(FLAT[name]()) == 0


def test_vertices_of_no_face_change_nothing():
    cube = cages.cube()
    loose = cages.Cage(np.concatenate([cube.vertices, [[100, 0, 0]]]), cube.faces)
    elements, at = np.arange(6, dtype=np.int32), np.full((6, 2), 0.3)
    np.testing.assert_array_equal(cube.surface().points(elements, at), loose.surface().points(elements, at))


def test_a_crease_on_an_edge_of_no_face_changes_nothing():
    cube = cages.cube()
    diagonal = cages.creased(cube, [(0, 7)], 10.0)
    elements, at = np.arange(6, dtype=np.int32), np.full((6, 2), 0.3)
    np.testing.assert_array_equal(cube.surface().points(elements, at), diagonal.surface().points(elements, at))


def grid_with_uv(**options):
    cage = cages.open_grid()
    corners = [vertex for face in cage.faces for vertex in face]
    uv = (cage.vertices[corners, :2] * 0.5 + 0.5).astype(np.float32)
    return cage.surface(uv_maps={7: uv}, uv=7, attributes={8: uv[:, :1] * [1, 2, 3]}, **options), uv.reshape(-1, 4, 2)


def test_linear_texture_coordinates_are_those_of_the_faces():
    shape, uv = grid_with_uv(uv_smoothing="NONE")
    elements = np.arange(9, dtype=np.int32)
    at = np.full((9, 2), [0.25, 0.5])  # a quarter of the way back, half of the way on
    on = uv[:, 0] * 0.5 + uv[:, 1] * 0.5
    beyond = uv[:, 3] * 0.5 + uv[:, 2] * 0.5
    np.testing.assert_allclose(shape.values(7, elements, at)[:, :2], on * 0.75 + beyond * 0.25, atol=1e-6)


def test_texture_coordinates_keep_to_their_island_s_border():
    shape, uv = grid_with_uv(uv_smoothing="PRESERVE_BOUNDARIES")
    t = np.linspace(0, 1, 9)
    along = shape.values(7, np.zeros(9, np.int32), np.stack([0 * t, t], axis=1))
    np.testing.assert_allclose(along[:, 1], 0, atol=1e-7)


def test_other_attributes_are_linear_in_faces():
    shape, uv = grid_with_uv()
    at = np.array([[0.25, 0.5]])
    value = shape.values(8, np.array([4], np.int32), at)[0]
    wanted = np.mean(uv[4, :2, 0]) * 0.75 + np.mean(uv[4, 2:, 0]) * 0.25
    np.testing.assert_allclose(value, [wanted, 2 * wanted, 3 * wanted, 1], atol=1e-6)


def test_the_middle_of_a_face_of_many_corners_has_the_mean_of_an_attribute():
    cage = cages.prism(5)
    values = np.arange(sum(len(face) for face in cage.faces), dtype=np.float32)[:, None]
    shape = cage.surface(attributes={1: values})
    for element in range(5):
        middle = shape.values(1, np.array([element], np.int32), np.ones((1, 2)))[0, 0]
        assert middle == pytest.approx(2.0)


def test_material_slots_follow_faces():
    cube = cages.cube()
    shape = cube.surface(material_slots=np.arange(6, dtype=np.int32))
    scene = _core.SceneDescription()
    assert scene.add_shape(shape) == 0
