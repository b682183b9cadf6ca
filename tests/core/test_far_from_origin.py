"""An object of size 1 at 10^6 renders as it does at 0."""

import numpy as np
import pytest
import scenes


def scene_at(core, offset, size=1.0):
    """Clay and glass in the light of a lamp, everything moved by `offset` and scaled by `size`."""
    scene = core.SceneDescription()
    glass = core.Program("glass")
    white, zero, ior = glass.constant(1, 1, 1, 1), glass.constant(0, 0, 0, 0), glass.constant(1.5, 1.5, 1.5, 1.5)
    glass.operation("glass", [white, white, zero, ior], text="GGX")
    clay = scene.add_material_list([scene.add_material("clay", scenes.diffuse(core))])
    clear = scene.add_material_list([scene.add_material("glass", glass)])

    def place(x, y, z, scale=1.0):
        return scenes.matrix(np.array([x, y, z]) * size + offset, scale * size)

    ball = scene.add_surface("ball", [scenes.sphere_spline(core)])
    cube = scene.add_mesh("cube", scenes.CUBE_VERTICES, scenes.CUBE_TRIANGLES)
    scene.add_instance("floor", scenes.quad(scene, "floor", 4.0), place(0, 0, -1), clay, 1)
    scene.add_instance("ball", ball, place(-1, 0, 0, 0.8), clear, 2)
    scene.add_instance("cube", cube, place(1.2, 0, 0, 0.6), clay, 3)
    scene.add_lamp("lamp", "POINT", place(1, -2, 3), np.array([300.0] * 3) * size**2, radius=0.2 * size)
    scene.set_camera("PERSPECTIVE", place(0, 0, 6), (-0.5, -0.5), (0.5, 0.5), 0.01 * size, 100.0 * size)
    return scene


def render(core, offset, size=1.0):
    return scenes.render(
        core,
        scene_at(core, offset, size),
        width=48,
        height=48,
        samples=4,
        passes=["combined", "normal", "object_index"],
    )


@pytest.mark.parametrize("offset", [(2.0**20, 0, 0), (-(2.0**20), 2.0**20, 2.0**19)])
def test_a_scene_far_away_renders_as_it_does_at_the_origin(core, offset):
    """Powers of two, so that the described places are the same numbers; what differs is the renderer's own rounding.

    A ray on a silhouette may fall to either side: at most a few pixels of 2304 may differ.
    """
    near, far = render(core, np.zeros(3)), render(core, np.array(offset))
    same = np.all(np.abs(near["normal"] - far["normal"]) < 1e-4, axis=-1)
    assert np.mean(~same) < 0.002, np.argwhere(~same)
    assert np.mean(near["object_index"] != far["object_index"]) < 0.002
    light = np.all(np.isclose(near["combined"], far["combined"], rtol=1e-3, atol=1e-4), axis=-1)
    assert np.mean(~light) < 0.01, np.argwhere(~light)


@pytest.mark.parametrize("size", [2.0**-20, 2.0**20])
def test_a_scene_of_any_size_renders_as_it_does_at_size_one(core, size):
    one, other = render(core, np.zeros(3)), render(core, np.zeros(3), size)
    assert np.mean(one["object_index"] != other["object_index"]) < 0.002
    light = np.all(np.isclose(one["combined"], other["combined"], rtol=1e-3, atol=1e-4), axis=-1)
    assert np.mean(~light) < 0.01, np.argwhere(~light)
