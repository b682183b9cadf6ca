"""Lights in smooth reflections: sampled more often than by their share, and no brighter for it."""

import numpy as np
import pytest
from path_scenes import material, picture, uneven_world, veil
from scenes import emission, look_down, matrix, quad

IOR = 1.5
FRESNEL = ((IOR - 1) / (IOR + 1)) ** 2  # at normal incidence
GLASS = ("glass", 1.0, 1.0, 0.0, IOR, "SHARP")

PANES = {
    "glass": lambda core, scene: (material(core, scene, GLASS, name="pane"), FRESNEL),
    "window": lambda core, scene: (veil(core, scene, 0.8, ("glass", 0.2, 1.0, 0.0, IOR, "SHARP")), 0.2 * FRESNEL),
    "varnish": lambda core, scene: (
        material(core, scene, ("diffuse", 0.9, (1e-4,) * 3), ("glossy", 0.1, 0.5, 0.0, "GGX"), name="pane"),
        0.05,
    ),
}
SIZE = 4.0


def emitter(core, scene, radiance):
    lamp = scene.add_material("light", emission(core, strength=radiance))
    scene.add_instance("light", quad(scene, "light", SIZE), matrix((0, 0, 8)), scene.add_material_list([lamp]))


def lamp(core, scene, radiance):
    watts = radiance * 4 * SIZE**2
    scene.add_lamp("light", "RECTANGLE", matrix((0, 0, 8)), (watts,) * 3, size_x=SIZE, size_y=SIZE)


def sun(core, scene, radiance):
    angle = 0.2
    solid = 2 * np.pi * (1 - np.cos(angle / 2))
    scene.add_lamp("light", "SUN", matrix(), (radiance * solid,) * 3, angle=angle)


LIGHTS = {"surface": emitter, "lamp": lamp, "sun": sun}


def pane_scene(core, pane, light, radiance):
    """A pane seen from above that mirrors a light behind the camera, before nothing; what the pane shows of it."""
    scene = core.SceneDescription()
    materials, share = PANES[pane](core, scene)
    scene.add_instance("pane", quad(scene, "pane", 2.0), matrix(), materials)
    LIGHTS[light](core, scene, radiance)
    look_down(scene, half=0.01)
    return scene, share * radiance


@pytest.mark.slow
@pytest.mark.parametrize("light", LIGHTS)
@pytest.mark.parametrize("pane", PANES)
def test_what_a_pane_mirrors_has_less_noise_the_brighter_it_is(core, pane, light):
    noise = {}
    for radiance in (1.0, 12.0):
        scene, expected = pane_scene(core, pane, light, radiance)
        image = picture(core, scene, size=48, samples=16)
        assert image.mean() == pytest.approx(expected, rel=0.1)
        noise[radiance] = image.std() / image.mean()
    assert noise[12.0] < 0.6 * noise[1.0]


def test_of_a_pixels_samples_a_window_mirrors_as_many_as_of_the_next_or_one_more(core):
    """One number chooses whether a sample goes straight on, is mirrored or is refracted."""
    scene, _ = pane_scene(core, "window", "lamp", 12.0)
    image = picture(core, scene, size=48, samples=16)[..., 0]
    assert len(np.unique(np.round(image, 4))) == 2


def test_a_bright_part_of_the_world_is_such_a_light(core):
    noise, means = {}, {}
    for strength in (0.04, 1.0):  # its bright parts shine with 20 times that
        scene = core.SceneDescription()
        scene.add_instance("pane", quad(scene, "pane", 2.0), matrix(), PANES["glass"](core, scene)[0])
        below = material(core, scene, ("diffuse", 1.0, 0.0), name="below")
        scene.add_instance("below", quad(scene, "below", SIZE), matrix((0, 0, -3)), below)
        look_down(scene, half=0.01)
        scene.set_world(uneven_world(core, strength), 32)
        one, other = (picture(core, scene, size=48, samples=16, seed=seed) / strength for seed in (1, 2))
        noise[strength], means[strength] = np.sqrt(np.mean((one - other) ** 2)), one.mean()
    assert means[1.0] == pytest.approx(means[0.04], rel=0.1)
    assert noise[1.0] < 0.6 * noise[0.04]


def test_a_light_behind_a_wall_changes_nothing(core):
    pictures = []
    for radiance in (0.0, 12.0):
        scene, _ = pane_scene(core, "glass", "lamp", radiance)
        below = scene.add_material("below", emission(core, strength=0.5))
        scene.add_instance("below", quad(scene, "below", SIZE), matrix((0, 0, -3)), scene.add_material_list([below]))
        wall = material(core, scene, ("diffuse", 1.0, 0.0), name="wall")
        scene.add_instance("wall", quad(scene, "wall", 2 * SIZE), matrix((0, 0, 7)), wall)
        pictures.append(picture(core, scene, size=32, samples=4))
    np.testing.assert_array_equal(*pictures)
    assert pictures[0].max() > 0.4


def test_what_is_seen_through_glass_weighs_no_more_than_twice(core):
    """However bright the light is that the glass mirrors."""
    ior, fresnel = 2.5, (1.5 / 3.5) ** 2
    scene = core.SceneDescription()
    pane = material(core, scene, ("glass", 1.0, 1.0, 0.0, ior, "SHARP"), name="pane")
    scene.add_instance("pane", quad(scene, "pane", 2.0), matrix(), pane)
    lamp(core, scene, 1000.0)
    below = scene.add_material("below", emission(core, strength=1.0))
    scene.add_instance("below", quad(scene, "below", SIZE), matrix((0, 0, -3)), scene.add_material_list([below]))
    look_down(scene, half=0.01)
    image = picture(core, scene, size=32, samples=1)[..., 0]
    reflected = image > 10.0
    assert 0.4 < reflected.mean() < 0.6
    np.testing.assert_allclose(image[reflected], fresnel * 1000.0 / 0.5, rtol=0.01)
    np.testing.assert_allclose(image[~reflected], (1 - fresnel) / 0.5, rtol=0.01)
