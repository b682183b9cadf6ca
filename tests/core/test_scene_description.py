"""Bad input is refused where it enters, by name, and the rest of the scene stays."""

import numpy as np
import pytest
import scenes


@pytest.fixture()
def scene(core):
    description = core.SceneDescription()
    scenes.quad(description, "floor")
    return description


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_coordinates_that_are_not_finite_are_refused(core, scene, bad):
    vertices = scenes.CUBE_VERTICES.copy()
    vertices[3, 1] = bad
    with pytest.raises(core.InputError, match="object 'crate'.*finite"):
        scene.add_mesh("crate", vertices, scenes.CUBE_TRIANGLES)


def test_an_index_past_the_vertices_is_refused(core, scene):
    triangles = scenes.CUBE_TRIANGLES.copy()
    triangles[5, 2] = 8
    with pytest.raises(core.InputError, match="object 'crate'"):
        scene.add_mesh("crate", scenes.CUBE_VERTICES, triangles)


def test_an_array_of_the_wrong_shape_is_refused_by_name(core, scene):
    with pytest.raises(
        core.InputError, match=r"object 'crate': triangles is an array of shape \(6, 6\), expected shape \(n, 3\)"
    ):
        scene.add_mesh("crate", scenes.CUBE_VERTICES, scenes.CUBE_TRIANGLES.reshape(6, 6))


@pytest.mark.parametrize(
    "change,words",
    [((0, 0), "scale is zero"), ((slice(0, 3), slice(0, 3)), "scale is zero"), ((1, 3), "matrix is not finite")],
)
def test_a_matrix_that_cannot_be_inverted_is_refused(core, scene, change, words):
    m = scenes.matrix()
    m[change] = np.nan if "finite" in words else 0.0
    with pytest.raises(core.InputError, match=f"object 'crate': {words}"):
        scene.add_instance("crate", 0, m)


def test_bad_instances_of_many_are_named_and_the_others_stay(core, scene):
    matrices = np.repeat(scenes.matrix()[None], 4, 0)
    matrices[2] = 0.0
    zeros = np.zeros(4, np.int32)
    names = ["a", "b", "c", "d"]
    messages = scene.add_instances(names, zeros, matrices, zeros - 1, zeros, np.zeros(4, np.float32), zeros + 31)
    assert len(messages) == 1 and "object 'c'" in messages[0]
    scenes.look_down(scene)
    session = core.Session(scene, core.Settings(width=4, height=4, samples=1))
    session.render()
    assert session.statistics()["geometry"]["instances"] == 3


def test_a_shape_that_does_not_exist_is_refused(core, scene):
    with pytest.raises(core.InputError, match="object 'crate': shape is 7"):
        scene.add_instance("crate", 7, scenes.matrix())


@pytest.mark.parametrize("weight", [0.0, -1.0, np.nan])
def test_weights_that_are_not_positive_are_refused(core, scene, weight):
    points = np.ones((4, 4, 4))
    points[..., :2] = np.stack(np.meshgrid(range(4), range(4)), -1)
    points[2, 1, 3] = weight
    with pytest.raises(core.InputError, match="object 'sail'.*weight"):
        scene.add_surface("sail", [core.NurbsSpline(points, 4, 4, endpoint_u=True, endpoint_v=True)])


def test_a_lamp_kind_that_does_not_exist_is_refused(core, scene):
    with pytest.raises(core.InputError, match="object 'lamp': kind is 'LASER'"):
        scene.add_lamp("lamp", "LASER", scenes.matrix(), (1, 1, 1))


def test_a_lamp_strength_that_is_not_finite_is_refused(core, scene):
    with pytest.raises(core.InputError, match="object 'lamp': strength is not finite"):
        scene.add_lamp("lamp", "POINT", scenes.matrix(), (1, np.inf, 1))


def test_a_mesh_without_faces_is_an_empty_shape(core, scene):
    shape = scene.add_mesh("points", np.zeros((3, 3), np.float32), np.zeros((0, 3), np.int32))
    scene.add_instance("points", shape, scenes.matrix())
    scenes.look_down(scene)
    assert np.isfinite(scenes.render(core, scene)["combined"]).all()


def test_a_camera_that_shows_nothing_is_refused(core, scene):
    scene.set_camera("PERSPECTIVE", scenes.matrix(), (1, 0), (0, 1), 0.1, 100)
    with pytest.raises(core.InputError, match="camera.*window width"):
        core.Session(scene, core.Settings(width=4, height=4)).render()
