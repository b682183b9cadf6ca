"""Light of an image around the scene: sampled by its table and found by scattering, the two must add up."""

import numpy as np
import pytest


def sky_image(height=32):
    """Dim, with a small bright box: (height, 2 height, 3), rows from the lower pole up."""
    pixels = np.full((height, 2 * height, 3), 0.1, np.float32)
    pixels[24:28, 10:18] = (20, 10, 5)
    return pixels


def irradiance_from_above(pixels):
    """By the midpoint rule over the image's own pixels."""
    height, width = pixels.shape[:2]
    elevation = ((np.arange(height) + 0.5) / height - 0.5) * np.pi
    weights = np.cos(elevation) * np.maximum(np.sin(elevation), 0) * (np.pi / height) * (2 * np.pi / width)
    return (pixels * weights[:, None, None]).sum((0, 1))


def lit_plane(core, scene, samples):
    """The pixels of a diffuse plane of albedo 1/2 under the scene's world: (256, 3)."""
    program = core.Program("grey")
    program.operation("diffuse", [program.constant(1, 1, 1, 1), program.constant(0.5, 0.5, 0.5, 1)])
    grey = scene.add_material_list([scene.add_material("grey", program)])
    corners = np.array([(-9, -9, 0), (9, -9, 0), (9, 9, 0), (-9, 9, 0)], np.float32)
    plane = scene.add_mesh("plane", corners, np.array([(0, 1, 2), (0, 2, 3)], np.int32))
    scene.add_instance("plane", plane, np.eye(4), grey)
    above = np.eye(4)
    above[2, 3] = 3
    scene.set_camera("ORTHOGRAPHIC", above, (-1, -1), (1, 1), 0.1, 10)
    session = core.Session(scene, core.Settings(width=16, height=16, samples=samples, clamp_indirect=0.0))
    assert session.render()
    return session.pass_pixels("combined")[..., :3].reshape(-1, 3)


def test_a_diffuse_plane_under_an_image_gets_the_images_irradiance(core):
    pixels = sky_image()
    scene = core.SceneDescription()
    texture = scene.add_image_pixels("sky", pixels, "LINEAR")
    world = core.Program("world")
    one = world.constant(1, 1, 1, 1)
    direction = world.operation("position")
    world.operation("background", [one, world.operation("environment", [direction], [texture, 0, 0]), one])
    scene.set_world(world, 256)
    color = lit_plane(core, scene, samples=256).mean(0)
    # 65536 paths leave some 0.3 % of noise. A sky blurred by wide footprints in one of the two ways gave 25 % too much.
    assert color == pytest.approx(0.5 * irradiance_from_above(pixels) / np.pi, rel=0.01)
