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
    with pytest.raises(core.InputError, match="camera.*window width"):
        scene.set_camera("PERSPECTIVE", scenes.matrix(), (1, 0), (0, 1), 0.1, 100)


NO_CAMERA = {
    "NaN in its matrix": (dict(matrix=np.full((4, 4), np.nan)), "matrix"),
    "a projective matrix": (dict(matrix=np.eye(4) + np.eye(4)[[3, 3, 3, 0]]), "last row"),
    "axes in a plane": (dict(matrix=np.array([[1, 0, 1, 0], [0, 1, 1, 0], [0, 0, 0, 0], [0, 0, 0, 1.0]])), "matrix"),
    "NaN in its window": (dict(window_min=(np.nan, 0)), "window"),
    "a window of infinite width": (dict(window_max=(np.inf, 1)), "window width"),
    "a clip range of NaN": (dict(clip_end=np.nan), "clip start"),
    "a focus at NaN": (dict(aperture_radius=0.1, focus_distance=np.nan), "focus distance"),
    "an aperture of NaN": (dict(aperture_radius=np.nan), "aperture radius"),
    "blades turned by NaN": (dict(aperture_radius=0.1, blade_rotation=np.nan), "blade rotation"),
    "a place too far away": (dict(matrix=scenes.matrix((1e200, 0, 0))), "location"),
}


@pytest.mark.parametrize("name", NO_CAMERA)
def test_a_camera_of_bad_numbers_is_refused_when_it_is_described(core, scene, name):
    options, argument = NO_CAMERA[name]
    camera = dict(matrix=np.eye(4), window_min=(-1, -1), window_max=(1, 1), clip_start=0.1, clip_end=100)
    with pytest.raises(core.InputError, match=f"object 'camera'.*{argument}"):
        scene.set_camera("PERSPECTIVE", **{**camera, **options})


def test_a_projective_matrix_is_refused(core, scene):
    matrix = np.eye(4)
    matrix[3, 0] = 0.5
    shape = scenes.quad(scene, "floor")
    with pytest.raises(core.InputError, match=r"object 'floor': matrix .*\(0.5, 0, 0, 1\).*expected \(0, 0, 0, 1\)"):
        scene.add_instance("floor", shape, matrix)
    with pytest.raises(core.InputError, match="object 'lamp': matrix"):
        scene.add_lamp("lamp", "POINT", matrix, (1, 1, 1))


def test_a_matrix_whose_last_row_is_rounded_is_taken(core, scene):
    """Blender multiplies the matrices of parents in single precision, that row too."""
    matrix = np.array(scenes.matrix())
    matrix[3] = (1e-9, 0, -1e-9, 0.9999999403953552)
    scene.add_instance("floor", scenes.quad(scene, "floor"), matrix)
    scene.set_camera("PERSPECTIVE", matrix, (-1, -1), (1, 1), 0.1, 100)
    assert np.isfinite(scenes.render(core, scene)["combined"]).all()


@pytest.mark.parametrize("given", [b"bytes", "text", None, np.ones((3, 3), complex), np.full((3, 3), "a"), object()])
def test_vertices_that_are_no_numbers_are_refused_by_name_and_kind(core, scene, given):
    with pytest.raises(core.InputError, match="object 'mesh': vertices is .*expected an array of float32"):
        scene.add_mesh("mesh", given, np.array([[0, 1, 2]], np.int32))


def test_indices_that_an_int32_does_not_hold_are_refused(core, scene):
    for given in (np.array([[0, 1, 2**32]]), np.array([[0, 1, 1.5]]), np.array([[0, 1, np.nan]])):
        with pytest.raises(core.InputError, match="object 'mesh': triangles"):
            scene.add_mesh("mesh", np.eye(3, dtype=np.float32), given)


def test_a_long_name_is_quoted_in_part(core, scene):
    with pytest.raises(core.InputError) as raised:
        scene.add_instance("ä" * 5_000_000, 99, np.eye(4))
    assert len(str(raised.value)) < 1000 and "ä... (10000000 bytes)" in str(raised.value)


def test_numbers_are_told_shortly(core, scene):
    for depth in (np.nan, 1e300):
        with pytest.raises(core.InputError, match="bevel_depth") as raised:
            core.SweptCurve("curve", [], bevel_depth=depth)
        assert len(str(raised.value)) < 100


LARGE = 1e307
LARGE_POINTS = np.array([[[0.0, 0, 0, 1], [1, 0, 0, 1]], [[0, LARGE, 0, 1], [1, 1, 0, 1]]])


def test_coordinates_too_large_are_refused_where_they_come_in(core, scene):
    with pytest.raises(core.InputError, match=r"object 'surface': splines\[0\].points\[2\] is \(0, 1e\+307, 0\)"):
        scene.add_surface("surface", [core.NurbsSpline(LARGE_POINTS, 2, 2)])
    with pytest.raises(core.InputError, match=r"points\[1\].*1e\+307"):
        core.CurveSplines("POLY", np.array([2], np.int32), LARGE_POINTS[:, 0])
    with pytest.raises(core.InputError, match=r"object 'hair': points\[1\].*1e\+307"):
        core.Strands("hair", LARGE_POINTS[:, 0, :3], np.ones(2, np.float32), np.array([0, 2], np.int32))


def test_a_scene_cannot_be_missing(core, scene):
    with pytest.raises(TypeError, match="scene"):
        core.Session(None, core.Settings())
    with pytest.raises(TypeError, match="shape"):
        scene.add_shape(None)
    with pytest.raises(core.InputError, match="'simd'.*'NONE'"):
        core.trace.use_simd_target("NONE")
