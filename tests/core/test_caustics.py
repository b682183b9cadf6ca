"""What becomes of mirrors and glass that are seen by way of matte surfaces: Filter Glossy, and light left out."""

import numpy as np
import path_scenes
import pytest
from scenes import background, look_down, matrix, quad, sphere_spline

GLOW, ALBEDO = 0.25, 0.5


def between_planes(core, distribution, scatters="glossy"):
    """A glowing matte floor, large enough to be all that the mirror over it shows. The camera is between them."""
    scene = core.SceneDescription()
    floor = path_scenes.material(core, scene, ("diffuse", 1.0, ALBEDO), ("emission", 1.0, 1.0, GLOW), name="floor")
    scene.add_instance("floor", quad(scene, "floor", 1000.0), matrix(), floor)
    more = (1.0,) if scatters == "glass" else ()
    above = path_scenes.material(core, scene, (scatters, 1.0, 1.0, 0.0, *more, distribution), name="above")
    scene.add_instance("above", quad(scene, "above", 1000.0), matrix((0, 0, 1)), above)
    look_down(scene, height=0.5, half=0.05)
    return scene


def mean(core, scene, **settings):
    return path_scenes.picture(core, scene, diffuse_bounces=1, roulette_start=100, **settings).mean()


def test_light_over_mirrors_is_there_or_left_out(core):
    scene = between_planes(core, "GGX")
    assert mean(core, scene) == pytest.approx(GLOW * (1 + ALBEDO), rel=1e-3)
    assert mean(core, scene, refractive_caustics=False) == pytest.approx(GLOW * (1 + ALBEDO), rel=1e-3)
    assert mean(core, scene, reflective_caustics=False) == pytest.approx(GLOW, rel=1e-6)


def test_light_through_glass_is_there_or_left_out(core):
    """Glass of index 1 reflects nothing; beyond it is a white world."""
    scene = between_planes(core, "GGX", "glass")
    scene.set_world(background(core), 16)
    assert mean(core, scene) == pytest.approx(GLOW + ALBEDO, rel=1e-3)
    assert mean(core, scene, reflective_caustics=False) == pytest.approx(GLOW + ALBEDO, rel=1e-3)
    assert mean(core, scene, refractive_caustics=False) == pytest.approx(GLOW, rel=1e-6)


def test_what_the_camera_sees_in_mirrors_stays_sharp(core):
    """A clear ball above a mirror that shows it."""
    scene = core.SceneDescription()
    for name, shape, place, lobe in (
        ("floor", quad(scene, "floor", 4), matrix(), ("glossy", 1.0, 0.9, 0.0, "GGX")),
        (
            "ball",
            scene.add_surface("ball", [sphere_spline(core)]),
            matrix((0, 0, 1), 0.5),
            ("glass", 1.0, 1.0, 0.0, 1.5, "GGX"),
        ),
    ):
        scene.add_instance(name, shape, place, path_scenes.material(core, scene, lobe, name=name))
    scene.set_world(path_scenes.uneven_world(core), 32)
    look_down(scene, height=4, half=0.35)
    pictures = [path_scenes.picture(core, scene, filter_glossy=filtered) for filtered in (0.0, 1.0)]
    np.testing.assert_array_equal(*pictures)
    assert np.ptp(pictures[0]) > 1


def test_mirrors_behind_matte_surfaces_are_blurred_but_for_those_that_are_sharp_by_name(core):
    plain, blurred = (mean(core, between_planes(core, "GGX"), filter_glossy=filtered) for filtered in (0.0, 10.0))
    # A rough mirror of single scattering loses some light between its facets.
    assert GLOW * (1 + 0.6 * ALBEDO) < blurred < 0.99 * plain
    sharp, kept = (mean(core, between_planes(core, "SHARP"), filter_glossy=filtered) for filtered in (0.0, 10.0))
    assert sharp == kept


@pytest.mark.parametrize("value", [-1.0, float("nan"), float("inf")])
def test_a_filter_that_is_no_density_is_named(core, value):
    with pytest.raises(ValueError, match="filter glossy"):
        core.Session(path_scenes.lit_plane(core), core.Settings(width=2, height=2, filter_glossy=value))
