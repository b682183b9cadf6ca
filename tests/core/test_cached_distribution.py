"""Ray interpolation under distribution ray tracing: what path tracing shows of it, with all mirrors and refractions followed."""

import numpy as np
import pytest
from cached_scenes import INTERPOLATED, NOT_ASKED, TWO_CLASS, ball, ball_scene, picture, share_of, used, world
from cached_scenes import render as render_with
from path_scenes import material
from scenes import background, look_down, matrix, quad, sphere_spline

FEW_RAYS = dict(integrator="DISTRIBUTION", hemisphere_rays=4, glossy_rays=2, light_rays=2)


def render(core, scene, mode="ON", **settings):
    return render_with(core, scene, mode, **{**FEW_RAYS, **settings})


@pytest.mark.parametrize("kind", ["mirror", "simple"])
def test_an_interpolated_picture_is_that_of_tracing_within_the_error(core, kind):
    off, on = render(core, ball_scene(core, kind), "OFF"), render(core, ball_scene(core, kind))
    assert used(off) == [] and share_of(on, INTERPOLATED) > 0.1
    difference = np.abs(picture(on) - picture(off))
    # As for path tracing: tests/core/test_cached_paths_pictures.py.
    assert difference.mean() < 0.01 * picture(off).mean()
    assert np.median(difference) < 0.002


def test_interpolated_glass_is_the_same_body_as_traced_glass(core):
    # Auto uses the model of On; for an error this small no cache is faster, so its rays are traced.
    traced, on = render(core, ball_scene(core, "glass"), "AUTO", error=1e-6), render(core, ball_scene(core, "glass"))
    assert used(traced) == [] and share_of(on, INTERPOLATED, TWO_CLASS) > 0.1
    assert np.abs(picture(on) - picture(traced)).mean() < 0.01 * picture(traced).mean()


def test_a_glass_body_is_the_same_in_both_integrators(core):
    """Without partial reflections on its outside there is one ray in and one out: nothing is left to chance."""
    scene = ball_scene(core, "glass", floor=False)
    paths = render_with(core, scene, samples=64, glossy_bounces=0)
    many = render(core, scene, samples=64, glossy_bounces=0)
    assert share_of(many, INTERPOLATED, TWO_CLASS) > 0.1
    middle = np.s_[:, :100]
    assert np.abs(picture(many)[middle] - picture(paths)[middle]).mean() < 0.01 * picture(paths)[middle].mean()


def test_a_glass_body_in_even_light_disappears_as_energy_is_kept(core):
    scene = core.SceneDescription()
    shape = scene.add_surface("ball", [sphere_spline(core)])
    scene.add_instance("ball", shape, matrix(), material(core, scene, ("glass", 1.0, 1.0, 0.0, 1.45, "SHARP")))
    scene.set_world(background(core, strength=1.0), 0)
    look_down(scene, 6.0, 0.3)
    for mode in ("ON", "AUTO"):
        # Rays dimmer than a hundredth end by chance: they carry what they would have, in the mean.
        shown = picture(render(core, scene, mode))
        assert abs(shown.mean() - 1.0) < 2e-3 and np.median(np.abs(shown - 1.0)) < 2e-3, mode


@pytest.mark.parametrize("kind", ["mirror", "glass", "simple"])
def test_threads_cache_size_and_kept_caches_change_no_bit(core, kind):
    reference = picture(render(core, ball_scene(core, kind), threads=1))
    store = core.RayCacheStore()
    for settings in (dict(threads=4), dict(cache_bytes=200_000), dict(tile_size=8), dict(caches=store)):
        assert np.array_equal(picture(render(core, ball_scene(core, kind), **settings)), reference), settings
    again = render(core, ball_scene(core, kind), caches=store)
    assert np.array_equal(picture(again), reference)
    assert used(again)[0]["samples_taken"] == 0


def test_the_mask_says_how_each_pixel_was_answered(core):
    on = render(core, ball_scene(core, "mirror"), passes=["combined", "mask", "interpolation_error"])
    mask, error = on.pass_pixels("mask"), on.pass_pixels("interpolation_error")
    assert mask[4, 70] == INTERPOLATED and (error[mask == INTERPOLATED] > 0).any()
    assert (error[mask == NOT_ASKED] == 0).all()


def test_rays_from_matte_surfaces_ask_too_and_bring_the_same_light(core):
    """A mirror that only a matte floor sees: its rays all come by way of the floor."""
    made = core.SceneDescription()
    ground = material(core, made, ("diffuse", 1.0, 0.8), name="ground")
    made.add_instance("floor", quad(made, "floor", 1.0, 0.0), matrix(), ground)
    ball(core, made, "ball", "mirror", place=(0, 0, 1.5))
    made.set_world(world(core), 32)
    frame = matrix((0, -2.0, 0.4))
    frame[:3, :3] = [[1, 0, 0], [0, 0.1961, -0.9806], [0, 0.9806, 0.1961]]  # along y, a little down
    made.set_camera("PERSPECTIVE", frame, (-0.2, -0.2), (0.2, 0.2), 0.01, 100.0)
    settings = dict(hemisphere_rays=16, indirect="COLOR_BLEEDING", samples=4)
    off, on = (render(core, made, mode, **settings) for mode in ("OFF", "ON"))
    assert share_of(on, INTERPOLATED) == 0.0 and used(on)[0]["queries"] > 10_000
    assert picture(on).mean() == pytest.approx(picture(off).mean(), rel=0.01)
    cached = render(core, made, irradiance_cache=True, **settings)
    assert picture(cached).mean() == pytest.approx(picture(off).mean(), rel=0.05)
