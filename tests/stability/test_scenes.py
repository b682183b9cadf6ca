"""Whole renders of extreme scenes: no NaN, no negative light, no bright specks made by arithmetic; and right where a closed
form says what is right."""

import numpy as np
import pytest
import scenes
from path_scenes import ALL_PASSES, material
from stability.measured import check_bound

CENTIMETRE_LIKE = dict(width=16, height=16, samples=16, filter="BOX", filter_width=1.0, clamp_indirect=0.0)


def passes_of(core, scene, **settings):
    """All passes of a render; none may hold NaN, none that is light may be negative."""
    values = {**CENTIMETRE_LIKE, "passes": ALL_PASSES, **settings}
    found = scenes.render(core, scene, **values)
    for name, pixels in found.items():
        assert np.isfinite(pixels).all(), f"{name} holds numbers that are not finite"
        if name not in ("position", "normal", "uv"):
            assert (pixels >= 0).all(), f"{name} holds negative numbers"
    return found


def lamp_over_plane(core, radius, power, height=2.0):
    scene = core.SceneDescription()
    grey = material(core, scene, ("diffuse", 1.0, 0.5))
    scene.add_instance("plane", scenes.quad(scene, "plane", 20.0), scenes.matrix(), grey)
    scene.add_lamp("lamp", "POINT", scenes.matrix((0, 0, height)), (power,) * 3, radius=radius)
    scenes.look_down(scene, height=1.0, half=0.001)  # straight below the lamp, which is behind the camera
    return scene


@pytest.mark.parametrize("radius", [0.0, 1e-12, 1e-9, 1e-6, 1e-3])
@pytest.mark.parametrize("power", [1e-9, 1.0, 1e9])
def test_a_tiny_lamp_of_any_power_lights_as_a_point_does(core, radius, power):
    # Irradiance of a point lamp: intensity P / 4 pi, in W/sr, as radiance pi times smaller; a diffuse grey of 1/2.
    height = 2.0
    expected = 0.5 / np.pi * power / (4 * np.pi) / height**2
    found = passes_of(core, lamp_over_plane(core, radius, power), samples=4)["combined"][..., :3]
    check_bound(
        f"lamp of radius {radius:g}, {power:g} W", "radiance", np.abs(found / expected - 1).max(), 1e-3, "of the value"
    )


def test_a_lamp_that_touches_the_surface_makes_no_specks(core):
    found = passes_of(core, lamp_over_plane(core, 1e-3, 1.0, height=1e-3), samples=64)["combined"]
    assert np.isfinite(found).all()


def inside_glass(core, ior, roughness=0.0):
    """The camera in the middle of a glass ball in a white world: energy is kept, all is white."""
    scene = core.SceneDescription()
    glass = material(core, scene, ("glass", 1.0, 1.0, roughness, ior, "GGX"))
    scene.add_instance("ball", scene.add_surface("ball", [scenes.sphere_spline(core)]), scenes.matrix(), glass)
    scene.set_world(scenes.background(core, (1, 1, 1)))
    scene.set_camera("PERSPECTIVE", scenes.matrix((0.01, 0.02, 0.03)), (-1, -1), (1, 1), 1e-6, 1000.0)
    return scene


@pytest.mark.parametrize("ior", [1.0, 1 + 1e-6, 1 - 1e-6, 1.5, 10.0])
def test_a_camera_inside_glass_sees_a_white_world_white(core, ior):
    """Singular glass loses nothing. From so near the middle no ray is caught by total reflection."""
    found = passes_of(core, inside_glass(core, ior), max_bounces=64, transmission_bounces=64, glossy_bounces=64)
    light = found["combined"][..., :3]
    assert light.max() <= 1 + 1e-4, "more light than the world has"
    lost = 1 - light.mean()
    check_bound(f"camera inside glass of index {ior:g}", "light lost", lost, 1e-3, "of the world's")


@pytest.mark.parametrize("clip", [1e-6, 1e-3])
def test_a_camera_that_close_to_a_wall_sees_it(core, clip):
    scene = core.SceneDescription()
    glow = scene.add_material_list([scene.add_material("glow", scenes.emission(core))])
    scene.add_instance("wall", scenes.quad(scene, "wall", 1.0), scenes.matrix(), glow)
    scene.set_camera("PERSPECTIVE", scenes.matrix((0, 0, 2 * clip)), (-0.1, -0.1), (0.1, 0.1), clip, 10.0)
    found = passes_of(core, scene, samples=1)
    np.testing.assert_allclose(found["combined"][..., :3], 1.0)
    check_bound(f"wall at {2 * clip:g}", "depth", np.abs(found["depth"] / (2 * clip) - 1).max(), 1e-5, "of the value")


@pytest.mark.parametrize("gap", [1e-2, 1e-4, 1e-6])
def test_nested_shells_a_millionth_apart_lose_no_light(core, gap):
    """A clear ball in a clear ball, nearly touching: index 1, so the white world must come through unchanged."""
    scene = core.SceneDescription()
    clear = material(core, scene, ("glass", 1.0, 1.0, 0.0, 1.0, "GGX"))
    ball = scene.add_surface("ball", [scenes.sphere_spline(core)])
    for scale in (1.0, 1.0 - gap):
        scene.add_instance(f"ball {scale}", ball, scenes.matrix((0, 0, 0), scale), clear)
    scene.set_world(scenes.background(core, (1, 1, 1)))
    scenes.look_down(scene, half=0.3)
    light = passes_of(core, scene)["combined"][..., :3]
    check_bound(f"shells {gap:g} apart", "light", np.abs(light - 1).max(), 1e-4, "of the world's")


@pytest.mark.parametrize("gap", [0.0, 1e-6])
def test_bodies_of_glass_that_touch_lose_no_light(core, gap):
    """Two clear cubes, face against face or a millionth apart, seen through both."""
    scene = core.SceneDescription()
    clear = material(core, scene, ("glass", 1.0, 1.0, 0.0, 1.0, "GGX"))
    cube = scene.add_mesh("cube", scenes.CUBE_VERTICES, scenes.CUBE_TRIANGLES)
    scene.add_instance("upper", cube, scenes.matrix((0, 0, 1 + gap / 2)), clear)
    scene.add_instance("lower", cube, scenes.matrix((0, 0, -1 - gap / 2)), clear)
    scene.set_world(scenes.background(core, (1, 1, 1)))
    scenes.look_down(scene, height=8.0, half=0.3)
    light = passes_of(core, scene)["combined"][..., :3]
    check_bound(f"cubes of glass {gap:g} apart", "light", np.abs(light - 1).max(), 1e-4, "of the world's")


# Facets keep a tenth of a pixel from the surface, 4e-3 here: of thinner walls the facets of one side would lie before
# those of the other, were a ray to see these coarser; and some of its paths would never come out.
# Distribution ray tracing ends dim rays by chance, at a hundredth of the light of a pixel, and others count for them.
@pytest.mark.parametrize("integrator, excess", [("PATH", 1e-4), ("DISTRIBUTION", 1e-2)])
@pytest.mark.parametrize("thickness", [1e-2, 1e-3, 1e-4, 1e-6])
def test_a_hollow_ball_of_dense_glass_is_invisible_in_an_even_world(core, thickness, integrator, excess):
    scene = core.SceneDescription()
    glass = material(core, scene, ("glass", 1.0, 1.0, 0.0, 1.5, "GGX"))
    ball = scene.add_surface("ball", [scenes.sphere_spline(core)])
    scene.add_instance("outside", ball, scenes.matrix(), glass)
    inside = scenes.matrix((0, 0, 0), 1 - thickness)
    inside[:3, 0] *= -1  # mirrored: its outside is the hollow's inside
    scene.add_instance("inside", ball, inside, glass)
    scene.set_world(scenes.background(core, (1, 1, 1)))
    scenes.look_down(scene, half=0.3)
    deep = dict(max_bounces=64, transmission_bounces=64, glossy_bounces=64, roulette_start=64)
    light = passes_of(core, scene, integrator=integrator, **deep)["combined"][..., :3]
    place = f"glass shell, {thickness:g} thick, {integrator.lower()}"
    check_bound(place, "light above the world's", light.max() - 1, excess, "of the world's")
    # At the rim a ray crosses the wall too many times for 64 bounces: one path in some thousands.
    check_bound(place, "light lost", 1 - light.mean(), 1e-3, "of the world's")


def test_a_shell_that_touches_itself_lets_no_light_in(core):
    """Two closed boxes that share a wall, with a lamp outside: a camera inside sees black."""
    scene = core.SceneDescription()
    grey = material(core, scene, ("diffuse", 1.0, 0.9))
    cube = scene.add_mesh("cube", scenes.CUBE_VERTICES, scenes.CUBE_TRIANGLES)
    scene.add_instance("left", cube, scenes.matrix((-1, 0, 0)), grey)
    scene.add_instance("right", cube, scenes.matrix((1, 0, 0)), grey)
    scene.set_world(scenes.background(core, (1, 1, 1), 1e6))
    scene.set_camera("PERSPECTIVE", scenes.matrix((-1, 0, 0.5)), (-2, -2), (2, 2), 1e-3, 100.0)
    light = passes_of(core, scene, samples=64)["combined"][..., :3]
    check_bound("box in a bright world", "light that leaked in", light.max(), 0.0, "")


def test_a_bright_lamp_seen_in_a_rough_mirror_makes_no_infinite_speck(core):
    scene = core.SceneDescription()
    for number, roughness in enumerate((0.0, 1e-6, 1e-3, 0.05)):
        glossy = material(core, scene, ("glossy", 1.0, 1.0, roughness, "GGX"))
        tile = scenes.quad(scene, f"tile {number}", 0.5)
        scene.add_instance(f"tile {number}", tile, scenes.matrix((number - 1.5, 0, 0)), glossy)
    scene.add_lamp("lamp", "POINT", scenes.matrix((0, 0, 3)), (1e9,) * 3, radius=1e-9)
    scene.add_lamp("sun", "SUN", scenes.matrix((0, 0, 3)), (1e9,) * 3, angle=1e-9)
    scenes.look_down(scene, half=0.5)
    assert passes_of(core, scene, samples=64)["combined"].max() > 0
