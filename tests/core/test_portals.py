"""Rays that go on from another place, and rays that programs cast, against what geometry says."""

import numpy as np
import pytest
from path_scenes import material, picture, render
from scenes import CUBE_TRIANGLES, CUBE_VERTICES, look_down, matrix, quad


def portal(core, scene, position=(0, 0, 0), direction=(0, 0, 0), color=1.0, weight=1.0, name="portal", *more):
    """A portal to one place, and other closures."""
    return material(core, scene, ("ray_portal", weight, color, position, direction), *more, name=name)


def shining_plates(core, closure):
    """A plate of that closure at 0, seen from above; behind it a red one at z = -5; far away, at x = 100, a green one at 0."""
    scene = core.SceneDescription()
    scene.add_instance("seen", quad(scene, "seen", 1.0), matrix(), closure(scene))
    for name, place, color in (("below", (0, 0, -5), (1, 0, 0)), ("far", (100, 0, 0), (0, 1, 0))):
        shown = material(core, scene, ("emission", 1.0, color, 1.0), name=name)
        scene.add_instance(name, quad(scene, name, 2.0), matrix(place), shown)
    look_down(scene, 3.0, 0.1)
    return scene


@pytest.mark.parametrize("integrator", ["PATH", "DISTRIBUTION"])
@pytest.mark.parametrize(
    "position, direction, seen",
    [
        ((100, 0, 2), (0, 0, 0), (0, 1, 0)),  # straight on from there
        ((100, 0, -3), (0, 0, 5), (0, 1, 0)),  # from below, by a vector of any length
        ((100, 0, 2), (0, 0, 1), (0, 0, 0)),  # away from it
        ((0, 0, -1), (0, 0, 0), (1, 0, 0)),
        ((1e30, 0, 0), (0, 0, 0), (0, 0, 0)),
        ((3e38, 3e38, 0), (0, 0, 0), (0, 0, 0)),
        ((100, 0, 2), (0, 0, -3e38), (0, 1, 0)),
    ],
)
def test_a_portal_shows_what_a_ray_from_there_meets(core, integrator, position, direction, seen):
    scene = shining_plates(core, lambda scene: portal(core, scene, position, direction))
    shown = picture(core, scene, integrator=integrator)
    assert np.allclose(shown, seen, atol=1e-5), shown.mean((0, 1))


@pytest.mark.parametrize("integrator", ["PATH", "DISTRIBUTION"])
def test_parts_of_light_add_up(core, integrator):
    """A portal, what is behind and the surface's own light, by their weights."""
    more = [("transparent", 0.25, 1.0), ("emission", 1.0, (0, 0, 0.125), 1.0)]
    scene = shining_plates(
        core, lambda scene: portal(core, scene, (100, 0, 2), (0, 0, 0), (0.5, 0.5, 0.5), 0.5, "mixed", *more)
    )
    assert np.allclose(
        picture(core, scene, integrator=integrator, samples=256).mean((0, 1)), (0.25, 0.25, 0.125), atol=0.01
    )


def chain(core, limit, integrator):
    """A plate sends rays to itself from above, always again, and shines a little."""
    scene = core.SceneDescription()
    around = portal(core, scene, (0, 0, 1), (0, 0, -1), 1.0, 1.0, "around", ("emission", 1.0, 1.0, 1.0))
    scene.add_instance("plate", quad(scene, "plate", 1.0), matrix(), around)
    look_down(scene, 3.0, 0.1)
    return picture(core, scene, transparent_bounces=limit, integrator=integrator, samples=4).mean()


@pytest.mark.parametrize("integrator", ["PATH", "DISTRIBUTION"])
@pytest.mark.parametrize("limit", [0, 1, 7])
def test_portals_count_as_transparent_surfaces(core, limit, integrator):
    """Each passage shows the plate once more, and the last one too, as behind transparent surfaces."""
    assert chain(core, limit, integrator) == pytest.approx(limit + 2)


def test_a_plate_blocks_light_unless_it_is_transparent_too(core):
    def below(*closures):
        scene = core.SceneDescription()
        scene.add_instance("floor", quad(scene, "floor", 10.0), matrix(), material(core, scene, ("diffuse", 1.0, 1.0)))
        plate = material(core, scene, *closures, name="plate")
        scene.add_instance("plate", quad(scene, "plate", 10.0), matrix((0, 0, 2)), plate, visibility=16)
        scene.add_lamp("sun", "SUN", matrix(), (np.pi,) * 3)
        look_down(scene, 1.0, 0.1)
        return picture(core, scene).mean()

    beside = ("ray_portal", 0.5, 1.0, (0, 0, -50), (0, 0, 0))
    assert below(beside) == 0.0
    both, clear = below(beside, ("transparent", 0.5, 1.0)), below(("transparent", 1.0, 1.0))
    assert both == pytest.approx(clear) and clear > 0.1


def test_the_same_bits_for_any_threads_and_tiles(core):
    def scene():
        return shining_plates(
            core, lambda made: portal(core, made, (100, 0, 2), (0, 0.1, -1), 0.5, 0.6, "mixed", ("diffuse", 0.4, 0.8))
        )

    pictures = [picture(core, scene(), threads=threads, tile_size=size) for threads, size in ((1, 64), (3, 4))]
    assert np.array_equal(*pictures)


def test_what_the_portal_shows_is_neither_first_surface_nor_alpha(core):
    scene = shining_plates(core, lambda made: portal(core, made, (100, 0, 2)))
    session = render(core, scene, passes=["combined", "object_index", "depth"], film_transparent=True)
    assert np.all(session.pass_pixels("combined")[..., 3] == 1.0)
    assert np.allclose(session.pass_pixels("depth"), 3.0, atol=0.01)  # of the far plate, from the camera's plane


def casting(core, ints, position, direction, length):
    """What a ray meets, of a floor with a cube of half width 1 above it."""
    scene = core.SceneDescription()
    program = core.Program("cast")
    operands = [program.constant(*position, 1), program.constant(*direction, 1), program.constant(*[length] * 4)]
    white = program.constant(1, 1, 1, 1)
    answer = program.operation("raycast", operands, list(ints))
    shifted = program.operation("vector_math", [answer, white], text="ADD")  # nothing shines negatively
    program.operation("emission", [white, shifted, white])
    shown = scene.add_material_list([scene.add_material("cast", program)])
    scene.add_instance("floor", quad(scene, "floor", 1.0), matrix(), shown)
    cube = material(core, scene, ("emission", 1.0, 0.0, 0.0), name="cube")
    scene.add_instance("cube", scene.add_mesh("cube", CUBE_VERTICES, CUBE_TRIANGLES), matrix((10, 0, 0)), cube)
    look_down(scene, 5.0, 0.1)
    return picture(core, scene, samples=1)[0, 0] - 1.0


@pytest.mark.parametrize(
    "ints, position, direction, length, expected",
    [
        ([0], (10, 0, 5), (0, 0, -1), 10.0, (1, 0, 4)),
        ([0], (10, 0, 5), (0, 0, -2), 10.0, (1, 0, 2)),  # in lengths of the direction
        ([0], (10, 0, 5), (0, 0, -2), 1.5, (0, 0, 1.5)),  # too far
        ([0, 1], (10, 0, 5), (0, 0, -1), 10.0, (0, 0, 10)),  # another object
        ([0], (0, 0, 5), (0, 0, -1), 10.0, (1, 1, 5)),  # itself
        ([0, 1], (0, 0, 5), (0, 0, -1), 10.0, (1, 1, 5)),
        ([1], (10, 0, 5), (0, 0, -1), 10.0, (0, 0, 1)),
        ([1], (10, 0, 0), (0, 0, -1), 10.0, (0, 0, 1)),  # from inside: towards the ray
        ([1], (10, 5, 5), (0, 0, -1), 10.0, (0, 0, 0)),
        ([0], (10, 0, 5), (0, 0, 0), 3.0, (0, 0, 3)),  # no direction
        ([0], (3e38, 3e38, 5), (0, 0, -1), 3.0, (0, 0, 3)),
        ([0], (10, 0, 5), (0, 0, -3e38), 3.0, (0, 0, 3)),  # its length is infinite in single precision
    ],
)
def test_a_ray_that_is_cast_tells_what_it_meets(core, ints, position, direction, length, expected):
    assert np.allclose(casting(core, ints, position, direction, length), expected, atol=1e-4)


def test_a_ray_from_the_point_itself_does_not_meet_it(core):
    scene = core.SceneDescription()
    program = core.Program("cast")
    operands = [program.operation("position"), program.operation("normal"), program.constant(5, 5, 5, 5)]
    white = program.constant(1, 1, 1, 1)
    program.operation("emission", [white, program.operation("raycast", operands, [0]), white])
    shown = scene.add_material_list([scene.add_material("cast", program)])
    scene.add_instance("ball", scene.add_mesh("cube", CUBE_VERTICES, CUBE_TRIANGLES), matrix((1e4, 3e3, 0)), shown)
    scene.set_camera("ORTHOGRAPHIC", matrix((1e4, 3e3, 5)), (-0.9, -0.9), (0.9, 0.9), 0.01, 100.0)
    assert np.allclose(picture(core, scene), (0, 0, 5))
