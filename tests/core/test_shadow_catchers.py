"""Shadow catchers: what others cast on them, the same bits however it is rendered, and nothing where nobody asks."""

import numpy as np
import path_scenes
import pytest
import scenes

SEEN, IN_FOOTAGE = 63, 64
PASSES = ["combined", "footage", "shadow_catcher", "footage_light", *path_scenes.LIGHT_PASSES]


def lit_floor(core, lamp=SEEN | IN_FOOTAGE, floor=SEEN | IN_FOOTAGE):
    """A floor with a plate above its middle, under a lamp that is a point, seen from above past the plate."""
    scene = core.SceneDescription()
    grey = path_scenes.material(core, scene, ("diffuse", 1.0, 0.5))
    scene.add_instance("floor", scenes.quad(scene, "floor", 4.0), scenes.matrix(), grey, visibility=floor)
    plate = scenes.quad(scene, "plate", 0.5)
    unseen = SEEN & ~1
    scene.add_instance("plate", plate, scenes.matrix((0, 0, 0.5)), grey, visibility=unseen)
    scene.add_lamp("lamp", "POINT", scenes.matrix((0, 0, 3)), (100,) * 3, visibility=lamp)
    scenes.look_down(scene, half=0.25)
    return scene


def varied(core, floor=SEEN | IN_FOOTAGE):
    """Lamps, an uneven world, glass, and a floor that is a catcher."""
    scene = path_scenes.varied_scene(core)
    more = path_scenes.material(core, scene, ("diffuse", 0.7, (0.5, 0.7, 0.9)), ("transparent", 0.3, 1.0), name="more")
    place = scenes.matrix((-0.3, 0.2, 0.05))
    scene.add_instance("catcher", scenes.quad(scene, "catcher", 3.0), place, more, visibility=floor)
    return scene


def passes_of(core, scene, passes=PASSES, **settings):
    session = path_scenes.render(core, scene, size=12, **{"samples": 7, **settings}, passes=passes)
    return {name: session.pass_pixels(name) for name in passes}


def assert_same(found, wanted):
    for name, pixels in wanted.items():
        np.testing.assert_array_equal(found[name], pixels, err_msg=name)


@pytest.mark.parametrize("transparent", [True, False])
def test_a_sharp_shadow_is_alpha_and_the_light_around_it_is_whole(core, transparent):
    settings = dict(film_transparent=transparent, max_bounces=0)
    found = passes_of(core, lit_floor(core), samples=16, **settings)
    share, picture = found["shadow_catcher"], found["combined"]
    assert share[6, 6] == pytest.approx(0, abs=1e-6) and share[0, 0] == pytest.approx(1)
    assert picture[6, 6] == pytest.approx([0, 0, 0, 1]) and picture[0, 0, 3] == (0 if transparent else 1)
    alone = passes_of(core, lit_floor(core), ["combined", "shadow_catcher"], samples=16, **settings)
    np.testing.assert_array_equal(alone["shadow_catcher"], share)
    assert (alone["combined"] == 0).all()  # a catcher shows nothing but the shadow


def test_a_lamp_that_is_not_in_the_footage_is_light_that_others_bring(core):
    found = passes_of(core, lit_floor(core, lamp=SEEN), samples=4, max_bounces=0)
    assert (found["footage_light"][..., :3] == 0).all() and (found["shadow_catcher"] == 1).all()
    scene = lit_floor(core, lamp=SEEN)
    scene.set_world(scenes.background(core, color=(0.1, 0.1, 0.1)))
    assert passes_of(core, scene, samples=16)["shadow_catcher"][0, 0].min() > 2


@pytest.mark.parametrize("transparent", [True, False])
@pytest.mark.parametrize("changed", [{"stream_paths": 0}, {"stream_paths": 17, "threads": 3}, {"tile_size": 5}])
def test_neither_streams_nor_threads_nor_tiles_show(core, transparent, changed):
    scene = varied(core)
    wanted = passes_of(core, scene, film_transparent=transparent, threads=1)
    assert_same(passes_of(core, scene, film_transparent=transparent, **changed), wanted)
    assert np.ptp(wanted["shadow_catcher"]) > 0 and np.isfinite(wanted["combined"]).all()


def test_parts_put_together_are_the_whole_to_the_bit(core):
    scene = varied(core)
    whole = passes_of(core, scene)
    merged = core.FilmSums(12, 12, PASSES)
    for first, count in ((3, 4), (0, 3)):
        session = path_scenes.render(
            core, scene, size=12, samples=7, passes=PASSES, first_sample=first, sample_count=count, keep_sums=True
        )
        merged.add(0, 0, count, session.sums())
    assert_same({name: merged.pass_pixels(name) for name in PASSES}, whole)


def test_samples_in_rounds_add_up_and_what_is_noisy_goes_on(core):
    scene = varied(core)
    at_once, in_rounds = passes_of(core, scene, samples=40), passes_of(core, scene, samples=40, noise_threshold=1e-9)
    for name, pixels in at_once.items():
        assert in_rounds[name] == pytest.approx(pixels, rel=1e-4, abs=1e-5), name
    shadow = [*PASSES, "sample_count"]
    adaptive = [
        passes_of(core, lit_floor(core), shadow, samples=64, noise_threshold=0.01, threads=threads, least_samples=8)
        for threads in (1, 3)
    ]
    assert_same(adaptive[1], adaptive[0])
    assert adaptive[0]["sample_count"].max() > 8  # at the border of the shadow


def test_without_their_passes_catchers_are_like_any_object(core):
    passes = ["combined", "diffuse_direct"]
    plain, caught = varied(core, floor=SEEN), varied(core)
    assert_same(passes_of(core, caught, passes), passes_of(core, plain, passes))
    for scene, names in ((caught, passes), (plain, PASSES)):
        statistics = path_scenes.render(core, scene, size=12, samples=2, passes=names).statistics()
        assert "catcher_paths" not in statistics["rays"] and "shadow catchers" in statistics["left_out"]
    # And where there are none, the passes change no other.
    assert_same(passes_of(core, plain, ["combined"]), {"combined": passes_of(core, plain)["combined"]})
    counted = path_scenes.render(core, caught, size=12, samples=2, passes=PASSES).statistics()
    assert counted["rays"]["catcher_paths"] > 0 and "shadow catchers" not in counted["left_out"]


def test_catchers_seen_and_shaded_by_way_of_ray_caches_are_as_traced(core):
    """The glass ball and a mirror ball above a catcher, whose rays come from caches that know of no footage."""
    scene = varied(core)
    mirror = path_scenes.material(core, scene, ("glossy", 1.0, 0.9, 0.0, "SHARP"), name="mirror")
    ball = scene.add_surface("mirror ball", [scenes.sphere_spline(core)])
    scene.add_instance("mirror ball", ball, scenes.matrix((-0.3, 0.3, 0.9), 0.4), mirror)
    names = ["combined", "shadow_catcher", "mask"]
    settings = dict(samples=256, film_transparent=True)
    traced = passes_of(core, scene, names, ray_interpolation=core.RayInterpolation("OFF"), **settings)
    asked = passes_of(core, scene, names, ray_interpolation=core.RayInterpolation("ON", error=0.005), **settings)
    assert np.any(np.isin(asked["mask"], [2, 3])) and not np.any(np.isin(traced["mask"], [2, 3]))
    for name in names[:2]:
        assert asked[name].mean() == pytest.approx(traced[name].mean(), rel=0.02)
        assert np.abs(asked[name] - traced[name]).mean() < 0.03 * np.abs(traced[name]).mean() + 0.01
