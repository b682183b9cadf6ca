"""What programs ask about the space around a point: ambient occlusion and rounded edges, against what geometry says."""

import numpy as np
import pytest
from path_scenes import picture
from scenes import CUBE_TRIANGLES, CUBE_VERTICES, look_down, matrix, quad, sphere_spline


def glowing(core, scene, operation, values, ints, scale=1.0, shift=0.0):
    """A material that shines by `scale` times the operation's answer, plus `shift`."""
    program = core.Program("glow")
    answer = program.operation(operation, [program.constant(*[value] * 4) for value in values], ints)
    sizes = [program.constant(*[size] * 4) for size in (scale, shift)]
    color = program.operation("vector_math", [answer, *sizes], text="MULTIPLY_ADD")
    white = program.constant(1, 1, 1, 1)
    program.operation("emission", [white, color, white])
    return scene.add_material_list([scene.add_material("glow", program)])


def under_a_ceiling(core, height, distance, ints=(64, 0, 0), wide=1e4):
    """The mean light of a floor below a wide ceiling, seen from between the two."""
    scene = core.SceneDescription()
    shown = glowing(core, scene, "ambient_occlusion", [distance], list(ints))
    scene.add_instance("floor", quad(scene, "floor", 1.0), matrix(), shown)
    scene.add_instance("ceiling", quad(scene, "ceiling", wide, height), matrix(), shown)
    look_down(scene, 0.5 * height, 0.1)
    return picture(core, scene, samples=64).mean()


@pytest.mark.parametrize("distance", [0.5, 1.0, 1.25, 2.0, 4.0])
def test_a_ceiling_hides_what_is_steeper_than_where_it_is_out_of_reach(core, distance):
    """Of the hemisphere weighed by the cosine, the part below the angle whose cosine is height / distance."""
    assert under_a_ceiling(core, 1.0, distance) == pytest.approx(min((1.0 / distance) ** 2, 1.0), abs=0.01)


def test_only_the_object_itself_may_count(core):
    assert under_a_ceiling(core, 1.0, 4.0, (8, 0, 1)) == 1.0


def test_inside_looks_behind_the_surface(core):
    scene = core.SceneDescription()
    shown = glowing(core, scene, "ambient_occlusion", [10.0], [8, 1, 0])
    scene.add_instance("cube", scene.add_mesh("cube", CUBE_VERTICES, CUBE_TRIANGLES), matrix(), shown)
    look_down(scene, 5.0, 0.1)
    assert picture(core, scene).max() == 0.0


@pytest.mark.parametrize("distance", [0.0, -1.0])
def test_nothing_is_near_without_a_distance(core, distance):
    assert under_a_ceiling(core, 1.0, distance, (4, 0, 0)) == 1.0


def normals_of_a_cube(core, radius, samples=64, **settings):
    """Of its top face, a row of pixels from edge to edge: normals brought to 0..1."""
    scene = core.SceneDescription()
    shown = glowing(core, scene, "bevel", [radius], [16], 0.5, 0.5)
    scene.add_instance("cube", scene.add_mesh("cube", CUBE_VERTICES, CUBE_TRIANGLES), matrix(), shown)
    scene.set_camera("ORTHOGRAPHIC", matrix((0, 0, 5)), (-1, -1), (1, 1), 0.01, 100.0)
    return 2.0 * picture(core, scene, size=16, samples=samples, **settings)[8] - 1.0


def test_edges_are_rounded_within_the_radius_and_flat_beyond(core):
    rounded = normals_of_a_cube(core, 0.5)
    assert np.allclose(rounded[5:11], (0, 0, 1), atol=1e-6)
    assert np.all(np.diff(rounded[:5, 0]) > 0) and rounded[0, 0] < -0.5
    assert np.allclose(rounded[:5, 0], -rounded[::-1][:5, 0], atol=0.03)
    assert np.allclose(np.linalg.norm(rounded, axis=1), 1.0, atol=0.05)


@pytest.mark.parametrize("radius", [0.0, -1.0])
def test_without_a_radius_edges_are_sharp(core, radius):
    assert np.allclose(normals_of_a_cube(core, radius), (0, 0, 1), atol=1e-6)


def test_a_radius_larger_than_the_body_gives_finite_normals(core):
    assert np.isfinite(normals_of_a_cube(core, 1e6)).all()


@pytest.mark.parametrize("operation, values, ints", [("ambient_occlusion", [1.0], [4, 0, 0]), ("bevel", [0.3], [4])])
def test_the_same_bits_for_any_threads_and_tiles_and_in_both_integrators_finite(core, operation, values, ints):
    def scene():
        result = core.SceneDescription()
        shown = glowing(core, result, operation, values, ints, 0.5, 0.5)
        result.add_instance("floor", quad(result, "floor", 3.0, -1.0), matrix(), shown)
        result.add_instance("ball", result.add_surface("ball", [sphere_spline(core)]), matrix(), shown)
        look_down(result)
        return result

    pictures = [picture(core, scene(), threads=threads, tile_size=size) for threads, size in ((1, 64), (3, 4))]
    assert np.array_equal(*pictures)
    assert pictures[0].std() > 0.01
    assert np.isfinite(picture(core, scene(), integrator="DISTRIBUTION")).all()
    assert np.allclose(picture(core, scene(), integrator="DISTRIBUTION"), pictures[0], atol=0.1)


def test_fewer_than_one_ray_is_refused_by_name(core):
    program = core.Program("Corner")
    with pytest.raises(ValueError, match="Corner"):
        program.operation("ambient_occlusion", [program.constant(1, 1, 1, 1)], [0])
