"""Distribution ray tracing against closed forms, its limits, its passes, its counters."""

import numpy as np
import pytest
from path_scenes import ALL_PASSES, lit_plane, material, nasty_scene, picture, render, uneven_world, varied_scene, veil
from scenes import CUBE_TRIANGLES, CUBE_VERTICES, background, look_down, matrix, quad, sphere_spline

DISTRIBUTION = dict(integrator="DISTRIBUTION")
UNLIMITED = dict(max_bounces=1000, glossy_bounces=1000, transmission_bounces=1000, transparent_bounces=1000)
LOSSLESS = {
    "mirror": ("glossy", 1.0, 1.0, 0.0, "SHARP"),
    "glass": ("glass", 1.0, 1.0, 0.0, 1.5, "SHARP"),
    "refraction without an index": ("refraction", 1.0, 1.0, 0.0, 1.0, "SHARP"),
    "transparent": ("transparent", 1.0, 1.0),
    "translucent": ("translucent", 1.0, 1.0),
}


@pytest.mark.parametrize("name", LOSSLESS)
def test_a_lossless_ball_cannot_be_seen_in_a_world_that_is_the_same_everywhere(core, name):
    scene = core.SceneDescription()
    ball = scene.add_surface("ball", [sphere_spline(core)])
    scene.add_instance("ball", ball, matrix((0.1, 0.2, 0.3)), material(core, scene, LOSSLESS[name]))
    scene.set_world(background(core, strength=0.7))
    look_down(scene, half=0.4)
    # A translucent ball sends light back and forth inside, which one diffuse bounce does not follow.
    if name == "translucent":
        assert picture(core, scene, samples=4, **DISTRIBUTION).max() <= 0.7 * 1.001
        return
    image = picture(core, scene, samples=4, **DISTRIBUTION, **UNLIMITED)
    # All that is not exact is what ends by chance, a hundredth of a ray at a time.
    assert image.mean() == pytest.approx(0.7, rel=0.003)
    assert np.abs(image - 0.7).max() < 0.07


@pytest.mark.parametrize("bounces", [0, 1, 2, 5, 1000])
def test_a_bounce_limit_ends_the_series_of_a_room_of_mirrors(core, bounces):
    scene = core.SceneDescription()
    room = material(core, scene, ("emission", 1.0, 1.0, 1.0), ("glossy", 1.0, 0.5, 0.0, "SHARP"))
    scene.add_instance("room", scene.add_mesh("cube", CUBE_VERTICES, CUBE_TRIANGLES), matrix((0.1, 0.2, 0.05)), room)
    look_down(scene, height=0.0)
    image = picture(core, scene, samples=64, **DISTRIBUTION, **{**UNLIMITED, "max_bounces": bounces})
    assert image.mean() == pytest.approx(sum(0.5**k for k in range(min(bounces, 60) + 2)), rel=0.003)


def test_mirrors_and_glass_are_without_noise(core):
    """What path tracing leaves to chance: which way a ray goes at glass."""
    scene = core.SceneDescription()
    pane = material(core, scene, ("glass", 1.0, 1.0, 0.0, 1.5, "SHARP"))
    scene.add_instance("pane", quad(scene, "pane", 50), matrix((0, 0, 2)), pane)
    glow = material(core, scene, ("emission", 1.0, (0.0, 1.0, 0.0), 1.0))
    scene.add_instance("glow", quad(scene, "glow", 50), matrix(), glow)
    scene.set_world(background(core, (1, 0, 0)))
    look_down(scene, half=1e-3)
    image = picture(core, scene, samples=1, **DISTRIBUTION)
    reflected = (0.5 / 2.5) ** 2
    np.testing.assert_allclose(image[..., 1], 1 - reflected, rtol=1e-5)
    np.testing.assert_allclose(image[..., 0], reflected, rtol=1e-3)


def test_more_light_rays_make_soft_shadows_calmer(core):
    scene = lit_plane(core)
    scene.add_instance("shade", quad(scene, "shade", 0.6), matrix((0.85, 0, 1)), visibility=30)
    scene.add_lamp("lamp", "POINT", matrix((0.5, 0, 2)), (50,) * 3, radius=0.5, visibility=30)
    look_down(scene, half=0.01)
    noise = [
        picture(core, scene, samples=1, size=16, light_rays=n, indirect="NONE", **DISTRIBUTION).std() for n in (1, 16)
    ]
    assert noise[1] < noise[0] / 3


def occluded_plane(core, sky=1.0):
    scene = lit_plane(core, albedo=0.5)
    scene.add_instance("roof", quad(scene, "roof", 1.0), matrix((0, 0, 1)), visibility=30)
    scene.set_world(background(core, strength=sky))
    look_down(scene, half=0.002)
    return scene


@pytest.mark.parametrize("sampled_world", [False, True])
def test_ambient_occlusion_takes_from_the_world_what_is_hidden_nearby(core, sampled_world):
    scene = occluded_plane(core)
    if sampled_world:  # hemisphere rays find the world where sampling lights would do so as well
        program = core.Program("world")
        one = program.constant(1, 1, 1, 1)
        two = program.constant(2, 2, 2, 2)
        light = program.operation("vector_math", [program.operation("generated"), two], text="ADD")
        program.operation("background", [one, light, program.constant(*[0.5] * 4)])  # 1 in x's mean
        scene.set_world(program, 32)
    a = 1.0
    hidden = 4 / np.pi * a / np.hypot(1, a) * np.arctan(a / np.hypot(1, a))
    settings = dict(DISTRIBUTION, samples=16, hemisphere_rays=64, indirect="AMBIENT_OCCLUSION")
    for distance, expected in ((0.0, 1 - hidden), (0.9, 1.0), (1.2, 1 - 0.44 / 1.44)):
        image = picture(core, scene, occlusion_distance=distance, **settings)
        assert image[..., 0].mean() == pytest.approx(0.5 * expected, abs=0.004), distance


def test_the_number_of_rays_is_as_set_and_grows_no_further_behind_gloss(core):
    scene = core.SceneDescription()
    both = material(core, scene, ("glossy", 0.5, 1.0, 0.3, "GGX"), ("diffuse", 0.5, 0.5))
    scene.add_instance("floor", quad(scene, "floor", 50), matrix(), both)
    scene.add_instance("roof", quad(scene, "roof", 50), matrix((0, 0, 9)), both)
    scene.add_lamp("lamp", "POINT", matrix((0, 0, 4)), (100,) * 3)
    look_down(scene, half=0.001)
    settings = dict(DISTRIBUTION, samples=2, glossy_rays=4, light_rays=2, hemisphere_rays=8, glossy_bounces=1)
    rays = render(core, scene, **settings).statistics()["rays"]
    assert rays["camera"] == 128 == rays["paths"]
    # The floor sends 4 of gloss; each meets the roof, which sends one of each kind, and the last of those sends none.
    # Rays that the normal's side refuses are missing, few here.
    assert 0.9 * 128 * 8 < rays["glossy"] <= 128 * 8
    assert 0.9 * 128 * (8 + 4 * 2) < rays["hemisphere"] <= 128 * (8 + 4 * 2)
    # Lights: 2 at the floor, one at the other end of each ray, and one more where hemisphere rays go on by gloss.
    assert rays["shadow"] <= 128 * (2 + 4 + 2 * (8 + 4 * 2))


def test_the_passes_recombine_to_the_picture(core):
    session = render(core, varied_scene(core), size=16, samples=4, passes=ALL_PASSES, **DISTRIBUTION)
    passes = {name: session.pass_pixels(name)[..., :3].astype(np.float64) for name in ALL_PASSES}
    total = passes["emission"] + passes["environment"]
    for kind in ("diffuse", "glossy", "transmission"):
        total += passes[f"{kind}_color"] * (passes[f"{kind}_direct"] + passes[f"{kind}_indirect"])
    # Sums of floats in another order.
    np.testing.assert_allclose(total, passes["combined"], rtol=1e-4, atol=1e-5)


@pytest.mark.parametrize("indirect", ["NONE", "AMBIENT_OCCLUSION", "COLOR_BLEEDING"])
def test_the_same_bits_come_from_any_number_of_threads(core, indirect):
    pictures = []
    for threads in (1, 2, 5):
        settings = dict(DISTRIBUTION, size=16, samples=2, tile_size=4, indirect=indirect, passes=ALL_PASSES)
        session = render(core, varied_scene(core), threads=threads, **settings)
        pictures.append([session.pass_pixels(name).tobytes() for name in ALL_PASSES])
    assert pictures[0] == pictures[1] == pictures[2]


def test_alpha_and_holdouts_are_as_in_path_tracing(core):
    scene = core.SceneDescription()
    scene.add_instance("veil", quad(scene, "veil", 20), matrix(), veil(core, scene, 0.3, ("diffuse", 0.7, 1.0)))
    scene.set_world(background(core))
    look_down(scene)
    pixels = render(core, scene, film_transparent=True, samples=4, **DISTRIBUTION).pass_pixels("combined")
    np.testing.assert_allclose(pixels[..., 3], 0.7, rtol=1e-5)
    assert pixels[..., :3].mean() == pytest.approx(0.7, abs=0.005)
    hole = core.SceneDescription()
    hole.add_instance("hole", quad(hole, "hole", 20), matrix(), material(core, hole, ("holdout", 1.0)))
    hole.set_world(background(core))
    look_down(hole)
    assert np.all(render(core, hole, film_transparent=True, **DISTRIBUTION).pass_pixels("combined") == 0.0)


@pytest.mark.parametrize("name", ["glossy_rays", "light_rays", "hemisphere_rays"])
@pytest.mark.parametrize("value", [0, -1, 5000])
def test_a_number_of_rays_out_of_range_is_refused_by_name(core, name, value):
    with pytest.raises(core.InputError, match=name.replace("_", " ")):
        core.Session(lit_plane(core), core.Settings(width=4, height=4, **{name: value}))


def test_unknown_choices_are_refused_with_those_there_are(core):
    with pytest.raises(core.InputError, match="PATH, DISTRIBUTION"):
        core.Settings(integrator="RADIOSITY")
    with pytest.raises(core.InputError, match="AMBIENT_OCCLUSION"):
        core.Settings(indirect="ALL")
    for name, value in (("occlusion_distance", -1.0), ("occlusion_distance", float("nan")), ("irradiance_error", 0.0)):
        with pytest.raises(core.InputError, match=name.replace("_", " ")):
            core.Session(lit_plane(core), core.Settings(width=4, height=4, **{name: value}))


@pytest.mark.parametrize("seed", range(4))
def test_no_pass_is_ever_nan_or_infinite_under_nasty_parameters(core, seed):
    scene = nasty_scene(core, np.random.default_rng(seed))
    session = render(core, scene, samples=2, passes=ALL_PASSES, **DISTRIBUTION)
    for name in ALL_PASSES:
        assert np.isfinite(session.pass_pixels(name)).all(), f"{name}, seed {seed}"
