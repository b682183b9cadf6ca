"""Light that leaves bodies by a profile of the distance: all of it, and where Christensen and Burley (2015) say."""

import numpy as np
import pytest
from path_scenes import picture
from scenes import CUBE_TRIANGLES, CUBE_VERTICES, background, look_down, matrix, sphere_spline

PROFILE = 3
SETTINGS = dict(max_bounces=8, diffuse_bounces=8)
TRUNCATED = 1 - 0.25 * np.exp(-16) - 0.75 * np.exp(-16 / 3)


def wax(core, color, radius, more=()):
    program = core.Program("wax")
    values = [1.0, color, 1.0, radius, 1.4, 0.0]
    operands = [program.constant(*(v if isinstance(v, tuple) else (v,) * 3), 1) for v in values]
    program.operation("subsurface", operands, ints=[PROFILE, *more])
    return program


def block(core, color, radius):
    """A flat block, seen from above at its middle, its top at z = 0."""
    scene = core.SceneDescription()
    materials = scene.add_material_list([scene.add_material("wax", wax(core, color, radius))])
    vertices = (CUBE_VERTICES - (0, 0, CUBE_VERTICES[:, 2].max())) * (5, 5, 5)
    scene.add_instance("body", scene.add_mesh("body", vertices, CUBE_TRIANGLES), matrix(), materials)
    return scene


@pytest.mark.parametrize("integrator", ["PATH", "DISTRIBUTION"])
def test_all_light_leaves_in_the_colour_that_a_body_is_given(core, integrator):
    color = (0.8, 0.5, 0.2)
    scene = block(core, color, (0.5, 0.3, 0.1))
    scene.set_world(background(core, (1.0, 1.0, 1.0)), 0)
    look_down(scene, half=0.1)
    image = picture(core, scene, samples=1024, size=4, integrator=integrator, **SETTINGS)
    np.testing.assert_allclose(image.mean((0, 1)), color, rtol=0.01)


@pytest.mark.parametrize("integrator", ["PATH", "DISTRIBUTION"])
def test_thin_shells_do_not_multiply_light_from_bounce_to_bounce(core, integrator):
    """Light of diffuse bounces leaves where it entered, also where walks are asked for after them, as since Blender 5.0."""
    images = []
    for more in ((0, 0), (0, 1)):
        scene = core.SceneDescription()
        materials = scene.add_material_list([scene.add_material("wax", wax(core, (0.8,) * 3, (1.2,) * 3, more))])
        shell = scene.add_surface("ball", [sphere_spline(core)])
        for number, size in enumerate((1.0, 0.95)):
            scene.add_instance(f"shell {number}", shell, matrix(scale=size), materials)
        scene.set_world(background(core, (1.0, 1.0, 1.0)), 0)
        look_down(scene, half=0.1)
        images.append(picture(core, scene, samples=64, size=4, integrator=integrator, **SETTINGS))
    np.testing.assert_array_equal(*images)
    assert images[0].max() < 2.0


def lit_share(x, width):
    """Of light on one side of a straight edge, what leaves at `x` from it on that side: the profile, integrated over a half plane
    by distances, of whose circles a part lies beyond the edge."""
    r = (np.arange(400000) + 0.5) * (16 * width / 400000)
    density = (np.exp(-r / width) + np.exp(-r / (3 * width))) / (4 * width * TRUNCATED)
    beyond = np.where(r > abs(x), np.arccos(np.minimum(abs(x) / r, 1.0)) / np.pi, 0.0)
    lost = float(np.sum(density * beyond) * (r[1] - r[0]))
    return 1.0 - lost if x >= 0 else lost


def test_light_spreads_across_the_edge_of_a_shadow_as_the_profile_says(core):
    albedo = np.array((0.8, 0.5, 0.3))
    radius = np.array((3.0, 2.0, 1.0))
    scene = block(core, tuple(albedo), tuple(radius))
    scene.add_lamp("sun", "SUN", matrix((0, 0, 3)), (np.pi,) * 3)
    black = core.Program("black")
    black.operation("diffuse", [black.constant(1, 1, 1, 1), black.constant(0, 0, 0, 1), black.constant(0, 0, 0, 1), -1])
    vertices = np.float64([(-5, -5, 1e-3), (0, -5, 1e-3), (0, 5, 1e-3), (-5, 5, 1e-3)])
    shade = scene.add_mesh("shade", vertices, np.int32([(0, 1, 2), (0, 2, 3)]))
    slots = scene.add_material_list([scene.add_material("black", black)])
    scene.add_instance("shade", shade, matrix(), slots, visibility=16)  # of its shadow alone
    scene.set_world(background(core, (0.0, 0.0, 0.0)), 0)
    look_down(scene, half=0.1)
    image = picture(core, scene, samples=1024, size=8, filter_width=0.01, max_bounces=1, diffuse_bounces=1)
    width = radius / (4 * np.pi)
    places = (np.arange(8) + 0.5) / 8 - 0.5
    expected = np.array([[albedo[c] * lit_share(x, width[c]) for c in range(3)] for x in places])
    np.testing.assert_allclose(image.mean(0), expected, atol=0.015)


@pytest.mark.parametrize("radius", [0.0, 1e-30, 1e-7, 1e10, 1e30, 3e38])
def test_absurd_radii_give_finite_light(core, radius):
    scene = block(core, (0.8, 0.5, 0.2), (radius, 0.1, radius))
    scene.set_world(background(core, (1.0, 1.0, 1.0)), 0)
    look_down(scene, half=0.1)
    image = picture(core, scene, samples=1024, size=4, **SETTINGS)
    assert np.isfinite(image).all() and (image >= 0.0).all()
    if radius < 1.0:
        np.testing.assert_allclose(image.mean((0, 1)), (0.8, 0.5, 0.2), rtol=0.05)
