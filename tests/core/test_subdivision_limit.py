"""The limit of cages: against a reference of the rules of Catmull and Clark, and closed forms."""

import numpy as np
import pytest
from core import subdivision_cages as cages
from core.subdivision_cages import FOREVER

CUBE_EDGES = [(0, 1), (1, 3), (3, 2), (2, 0)]  # around one face
CASES = {
    "a cube": cages.cube,
    "a tetrahedron": cages.tetrahedron,
    "a prism of seven sides": lambda: cages.prism(7),
    "a torus": cages.torus,
    "a drum with poles of 5 faces": lambda: cages.double_pole(5),
    "an open grid": cages.open_grid,
    "a cube with a sharp face": lambda: cages.creased(cages.cube(), CUBE_EDGES, FOREVER),
    "a cube with one sharp edge": lambda: cages.creased(cages.cube(), [(0, 1)], FOREVER),
    "a cube with a half sharp face": lambda: cages.creased(cages.cube(), CUBE_EDGES, 2.0),
    "a torus with a crease along it": lambda: cages.creased(
        cages.torus(), [(6 * j, 6 * ((j + 1) % 8)) for j in range(8)], FOREVER
    ),
}


def object_space(surface, local):
    """Positions of the shape in object space."""
    center, scale = surface.frame
    return local * scale + center


def at_places(surface, refined):
    """The surface at the corners of a refined cage's faces: (faces * 4, 6, 3), and their vertices."""
    elements = np.repeat([element for element, _ in refined.places], 4).astype(np.int32)
    parameters = np.concatenate([corners for _, corners in refined.places])
    return surface.points(elements, parameters), np.concatenate(refined.faces)


@pytest.mark.parametrize("name", CASES)
def test_points_are_the_limits_of_the_refined_cage(name):
    cage = CASES[name]()
    surface = cage.surface()
    for _ in range(3):
        cage = cages.refined(cage)
    points, vertices = at_places(surface, cage)
    wanted = cages.limit_points(cage)[vertices]
    off = np.abs(object_space(surface, points[:, 0]) - wanted).max(axis=1)
    known = np.isfinite(off)
    assert known.mean() > 0.9
    off = off[known]
    # The vertices come in single precision.
    assert off.max() < 5e-7, f"{name}: off by {off.max()} at face {off.argmax() // 4}"


@pytest.mark.parametrize("name", ["a cube", "a prism of seven sides", "a torus", "an open grid"])
def test_derivatives_are_those_of_differences(name):
    surface = CASES[name]().surface()
    random = np.random.default_rng(5)
    elements = random.integers(0, surface.element_count, 300).astype(np.int32)
    at = random.uniform(0.05, 0.95, (300, 2))
    here = surface.points(elements, at)
    step = 1e-5
    for axis, (first, along_u, along_v) in enumerate([(1, 3, 4), (2, 4, 5)]):
        move = np.eye(2)[axis] * step
        difference = (surface.points(elements, at + move) - surface.points(elements, at - move)) / (2 * step)
        np.testing.assert_allclose(here[:, first], difference[:, 0], atol=1e-7)
        # Second derivatives jump between the patches around irregular vertices.
        near = np.abs(difference[:, [1, 2]] - here[:, [along_u, along_v]]).max(axis=(1, 2)) < 1e-4
        assert np.mean(near) > 0.98


@pytest.mark.parametrize("name", ["a cube", "a tetrahedron", "a prism of seven sides", "a drum with poles of 5 faces"])
def test_the_patches_of_an_irregular_face_join(name):
    """Where a step of subdivision ends, and around irregular corners, where OpenSubdiv goes on."""
    surface = CASES[name]().surface()
    elements = np.arange(surface.element_count, dtype=np.int32)
    apart = 1e-9
    for at in (2.0**-6, 2.0**-5, 2.0**-4, 2.0**-3, 0.25, 0.5, 0.75, 1 - 2.0**-4):
        for other in (2.0**-7, 0.3, 1 - 2.0**-7):
            for low, high in (((at - apart, other), (at + apart, other)), ((other, at - apart), (other, at + apart))):
                below = surface.points(elements, np.broadcast_to(low, (len(elements), 2)))
                above = surface.points(elements, np.broadcast_to(high, (len(elements), 2)))
                np.testing.assert_allclose(below[:, 0], above[:, 0], rtol=0, atol=2e-8)
                # The patch that ends the row at an irregular corner is only near the limit.
                np.testing.assert_allclose(below[:, 1:3], above[:, 1:3], rtol=0, atol=1e-5)


def test_the_outside_of_a_closed_surface_is_that_of_its_cage():
    surface = cages.prism(5).surface()
    elements = np.arange(surface.element_count, dtype=np.int32)
    points = surface.points(elements, np.full((len(elements), 2), 0.4))
    outside = np.cross(points[:, 2], points[:, 1])
    assert (np.sum(outside * points[:, 0], axis=1) > 0).all()


def test_the_limit_of_a_cube_has_its_corners_at_half_their_place():
    surface = cages.cube().surface()
    elements = np.arange(6, dtype=np.int32)
    corners = surface.points(elements, np.zeros((6, 2)))[:, 0]
    # Along each axis: (9 v + 4 sum of neighbours + sum of diagonals) / 24 = (9 + 4 - 1) / 24.
    np.testing.assert_allclose(np.abs(object_space(surface, corners)), 0.5, atol=1e-12)
    middles = object_space(surface, surface.points(elements, np.full((6, 2), 0.5))[:, 0])
    # After one step: face point 1, four edge points 3/4, four vertices 5/9: (16 + 4 * 4 * 3/4 + 4 * 5/9) / 36.
    np.testing.assert_allclose(np.abs(middles).max(axis=1), (16 + 12 + 20 / 9) / 36, atol=1e-9)


def test_an_edge_that_is_sharp_for_ever_between_sharp_ends_is_straight():
    cube = cages.cube()
    edges = [each for face in cube.faces for each in cages.face_edges(face)]
    surface = cages.creased(cube, edges, FOREVER).surface()
    t = np.linspace(0, 1, 33)
    for parameters in ([t, 0 * t], [t, 0 * t + 1], [0 * t, t], [0 * t + 1, t]):
        for element in range(6):
            line = surface.points(np.full(33, element, np.int32), np.stack(parameters, axis=1))[:, 0]
            straight = line[0] + (line[-1] - line[0]) * t[:, None]
            np.testing.assert_allclose(line, straight, atol=1e-12)
            assert np.abs(np.abs(line).max(axis=1) - 1).max() < 1e-12


def test_a_more_than_sharp_crease_is_one_that_is_sharp_for_ever():
    sharp = cages.creased(cages.cube(), CUBE_EDGES, FOREVER).surface()
    sharper = cages.creased(cages.cube(), CUBE_EDGES, 1e9).surface()
    elements = np.arange(6, dtype=np.int32)
    at = np.full((6, 2), 0.3)
    np.testing.assert_array_equal(sharp.points(elements, at), sharper.points(elements, at))


@pytest.mark.parametrize("sides", [3, 64, 65])
def test_the_end_of_a_pole_of_any_number_of_faces_is_its_limit(sides):
    cage = cages.double_pole(sides)
    surface = cage.surface()
    refined = cages.refined(cage)
    wanted = cages.limit_points(refined)
    points, vertices = at_places(surface, refined)
    for pole in (4 * sides, 4 * sides + 1):
        at_pole = object_space(surface, points[vertices == pole, 0])
        np.testing.assert_allclose(at_pole, np.broadcast_to(wanted[pole], at_pole.shape), atol=1e-9)


def test_sharp_border_corners_stay_where_they_are_and_smooth_ones_do_not():
    cage = cages.open_grid()
    for option, stays in (("SHARP", True), ("SMOOTH", False)):
        surface = cage.surface(border_corners=option)
        corner = object_space(surface, surface.points(np.array([0], np.int32), np.zeros((1, 2)))[0, 0])
        assert np.allclose(corner, cage.vertices[0], atol=1e-7) == stays


def test_a_sharp_vertex_stays_where_it_is():
    cube = cages.cube()
    surface = cube.surface(crease_vertices=np.array([0], np.int32), vertex_sharpness=np.array([10], np.float32))
    corner = surface.points(np.array([0], np.int32), np.zeros((1, 2)))[0, 0]
    np.testing.assert_allclose(object_space(surface, corner), cube.vertices[0], atol=1e-7)
