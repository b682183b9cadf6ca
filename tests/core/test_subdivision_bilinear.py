"""The bilinear scheme: plain meshes with a point at any parameters, as displacement needs them."""

import numpy as np
import pytest
from core import shapes
from core import subdivision_cages as cages
from rayleaf import _core

CASES = {
    "a cube": cages.cube,
    "a tetrahedron": cages.tetrahedron,
    "a prism of seven sides": lambda: cages.prism(7),
    "an open grid": cages.open_grid,
}


def corner_parts(cage):
    """The corners of each element, as (faces or corners of faces, 4, 3), towards the next corner first."""
    quads = all(len(face) == 4 for face in cage.faces)
    for face in cage.faces:
        points = cage.vertices[face]
        if quads:
            yield points
            continue
        for i, point in enumerate(points):
            after, before = points[(i + 1) % len(face)], points[i - 1]
            yield np.array([point, (point + after) / 2, points.mean(axis=0), (point + before) / 2])


@pytest.mark.parametrize("name", CASES)
def test_points_are_those_of_ruled_faces(name):
    cage = CASES[name]()
    surface = cage.surface(scheme="BILINEAR")
    at = np.random.default_rng(1).uniform(size=(50, 2))
    u, v = at[:, :1], at[:, 1:]
    center, scale = surface.frame
    for element, (first, after, across, before) in enumerate(corner_parts(cage)):
        wanted = (first * (1 - u) + before * u) * (1 - v) + (after * (1 - u) + across * u) * v
        points = surface.points(np.full(50, element, np.int32), at)[:, 0] * scale + center
        np.testing.assert_allclose(points, wanted, atol=1e-6, err_msg=f"element {element}")
    assert surface.element_count == element + 1


def twisted_cube():
    """Its sides are no planes."""
    cage = cages.cube()
    turn = 0.4 * cage.vertices[:, 2]
    x, y = cage.vertices[:, 0].copy(), cage.vertices[:, 1].copy()
    cage.vertices[:, 0], cage.vertices[:, 1] = x * np.cos(turn) - y * np.sin(turn), x * np.sin(turn) + y * np.cos(turn)
    return cage


def vertex_normals(cage):
    """Away from the middle, one a corner."""
    return np.float32(shapes.unit(cage.vertices[[vertex for face in cage.faces for vertex in face]]))


def moved(surface, amount):
    """A surface displaced along the normals that count."""
    program = _core.Program("displacement")
    normal = program.operation("object_normal")
    offset = program.operation("vector_math", [normal, program.constant(*[amount] * 4)], text="MULTIPLY")
    return _core.displaced(surface, program, object=offset)


SHELLS = {
    "a twisted cube": twisted_cube,
    "a prism of seven sides": lambda: cages.prism(7),
    "a double pole of twelve sides": lambda: cages.double_pole(12),
}


@pytest.mark.slow
@pytest.mark.parametrize("smooth", [False, True])
@pytest.mark.parametrize("displaced", [False, True])
@pytest.mark.parametrize("name", SHELLS)
def test_every_ray_from_inside_meets_a_shell_of_polygons(name, displaced, smooth):
    cage = SHELLS[name]()
    normals = vertex_normals(cage) if smooth else None
    surface = cage.surface(scheme="BILINEAR", corner_normals=normals)
    random = np.random.default_rng(3)
    tracer = shapes.trace.Tracer([(moved(surface, 0.2) if displaced else surface, np.eye(4), shapes.EVERYTHING)])
    directions = shapes.random_directions(random, 3000)
    hits = tracer.closest_hits(0.05 * shapes.random_directions(random, 3000), directions)
    missed = np.flatnonzero(hits["instance"] < 0)
    assert len(missed) == 0, f"{len(missed)} missed: towards {directions[missed[:3]]!r}"


def test_corner_normals_say_where_points_move_and_how_they_are_shaded():
    cage = cages.cube()
    surface = cage.surface(scheme="BILINEAR", corner_normals=vertex_normals(cage))
    along = shapes.unit(np.array([[1, 0.5, 0.25], [0.3, -0.2, 1]]))
    origins = 5 * along

    def first_hits(shape):
        tracer = shapes.trace.Tracer([(shape, np.eye(4), shapes.EVERYTHING)])
        return tracer.closest_hits(origins, -along)

    # Towards the middle of a cube and away from it, to a bilinear map's accuracy at most.
    np.testing.assert_allclose(first_hits(surface)["normal"], along, atol=0.06)
    distance = np.linalg.norm(first_hits(moved(surface, 0.5))["position"], axis=1)
    np.testing.assert_allclose(distance, np.linalg.norm(first_hits(surface)["position"], axis=1) + 0.5, atol=0.01)
