"""Alpha and passes of path tracing: they add up, describe the first surface, and never hold NaN."""

import numpy as np
import pytest
from path_scenes import ALL_PASSES, lit_plane, material, nasty_scene, render, uneven_world, varied_scene, veil
from scenes import background, look_down, matrix, quad, sphere_spline


def test_film_transparency_takes_the_world_out_and_leaves_alpha(core):
    scene = core.SceneDescription()
    half = veil(core, scene, 0.3, ("diffuse", 0.7, 1.0))
    scene.add_instance("veil", quad(scene, "veil", 20), matrix(), half)
    scene.set_world(background(core, strength=1.0))
    look_down(scene)
    pixels = render(core, scene, film_transparent=True, samples=256).pass_pixels("combined")
    assert pixels[..., 3].mean() == pytest.approx(0.7, abs=0.005)
    assert pixels[..., :3].mean() == pytest.approx(0.7, abs=0.005)
    solid = render(core, scene, samples=256).pass_pixels("combined")
    assert np.all(solid[..., 3] == 1.0)
    assert solid[..., :3].mean() == pytest.approx(1.0, abs=0.005)


def test_a_holdout_is_black_and_empties_the_film(core):
    scene = core.SceneDescription()
    scene.add_instance("hole", quad(scene, "hole", 20), matrix(), material(core, scene, ("holdout", 1.0)))
    scene.set_world(background(core, strength=1.0))
    look_down(scene)
    for transparent in (True, False):  # as in Cycles, over an opaque film too
        assert np.all(render(core, scene, film_transparent=transparent).pass_pixels("combined") == 0.0)


@pytest.mark.parametrize("integrator", ["PATH", "DISTRIBUTION"])
def test_nothing_is_seen_of_what_is_added_to_a_holdout(core, integrator):
    scene = core.SceneDescription()
    surface = material(core, scene, ("holdout", 1.0), ("diffuse", 1.0, 0.8), ("emission", 1.0, 1.0, 1.0))
    scene.add_instance("hole", quad(scene, "hole", 20), matrix(), surface)
    scene.set_world(background(core, strength=1.0))
    look_down(scene)
    assert np.all(render(core, scene, integrator=integrator).pass_pixels("combined") == 0.0)


def test_the_passes_recombine_to_the_picture(core):
    session = render(core, varied_scene(core), size=16, samples=16, passes=ALL_PASSES)
    passes = {name: session.pass_pixels(name)[..., :3].astype(np.float64) for name in ALL_PASSES}
    sum_of_passes = passes["emission"] + passes["environment"]
    for kind in ("diffuse", "glossy", "transmission"):
        sum_of_passes += passes[f"{kind}_color"] * (passes[f"{kind}_direct"] + passes[f"{kind}_indirect"])
        assert passes[f"{kind}_direct"].max() > 0 or kind == "transmission"
        assert passes[f"{kind}_indirect"].max() > 0
    # Sums of floats in another order.
    np.testing.assert_allclose(sum_of_passes, passes["combined"], rtol=1e-4, atol=1e-5)


def test_passes_do_not_change_the_picture(core):
    alone = render(core, varied_scene(core), samples=8).pass_pixels("combined")
    among_all = render(core, varied_scene(core), samples=8, passes=ALL_PASSES).pass_pixels("combined")
    # Lobes are evaluated kind by kind there: sums of floats in another order.
    np.testing.assert_allclose(alone, among_all, rtol=1e-4, atol=1e-5)


def test_the_same_bits_come_from_any_number_of_threads(core):
    pictures = []
    for threads in (1, 2, 7):
        session = render(core, varied_scene(core), size=24, samples=4, threads=threads, tile_size=8, passes=ALL_PASSES)
        pictures.append([session.pass_pixels(name).tobytes() for name in ALL_PASSES])
    assert pictures[0] == pictures[1] == pictures[2]


def test_the_surface_passes_describe_the_first_opaque_surface(core):
    scene = core.SceneDescription()
    plane = material(core, scene, ("diffuse", 1.0, 0.5))
    scene.add_instance("plane", quad(scene, "plane", 20), matrix((0, 0, 1)), plane, object_index=7)
    clear = veil(core, scene, 0.9, ("diffuse", 0.1, 0.5), name="clear")
    scene.add_instance("clear", quad(scene, "clear", 20), matrix((0, 0, 2)), clear, object_index=8)
    look_down(scene, height=5)
    session = render(core, scene, samples=1, transparent_bounces=100, passes=ALL_PASSES)
    index = session.pass_pixels("object_index")
    # One sample: where it was scattered by the veil, no surface is recorded.
    through = index == 7
    assert through.mean() > 0.5 and np.all(through | (index == 0))
    through = through[..., 0]
    assert session.pass_pixels("depth")[through] == pytest.approx(4.0, rel=1e-6)
    assert session.pass_pixels("position")[through][:, 2] == pytest.approx(1.0, rel=1e-6)
    assert session.pass_pixels("normal")[through] == pytest.approx(np.tile([0, 0, 1.0], (through.sum(), 1)))
    assert np.all(session.pass_pixels("depth")[~through] == np.float32(1e10))


def test_colour_passes_hold_the_albedo_and_exposure_scales_light_only(core):
    scene = lit_plane(core, albedo=0.3)
    scene.set_world(background(core, strength=2.0))
    for exposure in (1.0, 4.0):
        session = render(core, scene, exposure=exposure, passes=ALL_PASSES)
        assert session.pass_pixels("diffuse_color").mean() == pytest.approx(0.3, rel=1e-5)
        light = session.pass_pixels("diffuse_direct").mean()
        assert light == pytest.approx(2.0 * exposure, rel=0.01)
        assert session.pass_pixels("combined")[..., 3].mean() == 1.0


@pytest.mark.parametrize("seed", range(6))
def test_no_pass_is_ever_nan_or_infinite_under_nasty_parameters(core, seed):
    scene = nasty_scene(core, np.random.default_rng(seed))
    session = render(core, scene, samples=8, passes=ALL_PASSES, clamp_indirect=10.0)
    for name in ALL_PASSES:
        assert np.isfinite(session.pass_pixels(name)).all(), f"{name}, seed {seed}"
