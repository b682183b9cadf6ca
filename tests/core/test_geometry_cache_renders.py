"""The geometry cache in whole renders: levels, settings, passes, statistics, messages for wrong settings."""

import numpy as np
import path_scenes
import pytest
from path_scenes import material
from scenes import background, emission, look_down, matrix, quad, sphere_spline

LEVELS = ("coarse", "medium", "fine")
CACHE_PASSES = ["combined", "geometry_level", "geometry_misses", "object_index"]


def render(core, scene, **settings):
    """Nothing is resident: all facets go through the cache."""
    return path_scenes.render(core, scene, resident_megabytes=0.0, **settings)


def balls_scene(core):
    """A mirror and diffuse balls of splines over a mesh, under a lamp and a world."""
    scene = core.SceneDescription()
    ball = scene.add_surface("ball", [sphere_spline(core)])
    grey = material(core, scene, ("diffuse", 1.0, 0.7), name="grey")
    chrome = material(core, scene, ("glossy", 1.0, 0.9, 0.0, "SHARP"), name="chrome")
    scene.add_instance("chrome", ball, matrix((-0.9, 0, 0), 0.8), chrome, object_index=1)
    scene.add_instance("near", ball, matrix((0.9, 0, 0.2), 0.8), grey, object_index=1)
    scene.add_instance("small", ball, matrix((0.1, 1.2, -0.5), 0.3), grey, object_index=1)
    scene.add_instance("floor", quad(scene, "floor", 5.0, -1.0), matrix(), grey, object_index=2)
    scene.add_lamp("key", "POINT", matrix((2, -3, 4)), (300, 280, 250), radius=0.5)
    scene.set_world(background(core, (0.2, 0.3, 0.4)), 0)
    look_down(scene, 6.0, 0.5)
    return scene


def cache_of(session):
    return session.statistics()["geometry_cache"]


def share_of_lookups(session, *levels):
    counters = cache_of(session)["levels"]
    return sum(counters[name]["lookups"] for name in levels) / sum(counters[name]["lookups"] for name in LEVELS)


@pytest.mark.parametrize("integrator", ["PATH", "DISTRIBUTION"])
def test_neither_budget_nor_threads_nor_having_no_cache_change_a_picture(core, integrator):
    scene = balls_scene(core)
    ways = [dict(geometry_cache_megabytes=size) for size in (30.0, 0.3, 1e-6, 0.0, -5.0)]
    ways += [dict(geometry_cache_mode="NONE"), dict(threads=1), dict(threads=3, tile_size=7)]
    for levels in (dict(), dict(stochastic_levels=True, importance_levels=True, least_mirrored_spread=0.05)):
        pictures = [
            render(core, scene, size=20, samples=2, integrator=integrator, **levels, **way).pass_pixels("combined")
            for way in ways
        ]
        for way, picture in zip(ways, pictures):
            np.testing.assert_array_equal(picture, pictures[0], err_msg=f"{integrator}, {levels}, {way}")


def test_a_single_resolution_is_fine_for_all_rays_and_looks_the_same(core):
    scene = balls_scene(core)
    sessions = {
        mode: render(core, scene, size=48, samples=16, geometry_cache_mode=mode, passes=CACHE_PASSES)
        for mode in ("MULTI", "SINGLE")
    }
    assert share_of_lookups(sessions["SINGLE"], "fine") == 1.0
    assert share_of_lookups(sessions["MULTI"], "coarse", "medium") > 0.5
    on_patches = sessions["SINGLE"].pass_pixels("geometry_level")[..., 0] > 0
    assert set(np.unique(sessions["SINGLE"].pass_pixels("geometry_level"))) == {0.0, 3.0} and on_patches.any()
    several, single = (sessions[mode].pass_pixels("combined")[..., :3] for mode in ("MULTI", "SINGLE"))
    # A silhouette may be a tenth of a pixel further inside: a difference below the noise of these samples.
    other_noise = render(core, scene, size=48, samples=16, geometry_cache_mode="SINGLE", seed=1)
    noise = other_noise.pass_pixels("combined")[..., :3] - single
    assert several.mean() == pytest.approx(single.mean(), rel=0.01)
    assert np.sqrt(np.mean((several - single) ** 2)) < np.sqrt(np.mean(noise**2))


def test_the_pass_of_levels_tells_patches_from_the_rest_and_wide_pixels_from_narrow(core):
    means = []
    for size in (8, 64):
        session = render(core, balls_scene(core), size=size, samples=1, passes=CACHE_PASSES)
        level, index = session.pass_pixels("geometry_level"), session.pass_pixels("object_index")
        assert ((level > 0) == (index == 1)).all()
        assert set(np.unique(level)) <= {0, 1, 2, 3, 4, 5, 6}
        means.append(level[index == 1].mean())
    assert means[0] <= means[1]


@pytest.mark.parametrize("integrator", ["PATH", "DISTRIBUTION"])
def test_the_pass_of_misses_adds_up_to_all_tessellations(core, integrator):
    settings = dict(size=24, samples=4, integrator=integrator, passes=CACHE_PASSES)
    for megabytes in (30.0, 0.3, 0.0):
        session = render(core, balls_scene(core), geometry_cache_megabytes=megabytes, **settings)
        statistics = cache_of(session)
        all_diced = sum(statistics["levels"][name]["diced"] for name in LEVELS) + statistics["parts"]["diced"]
        assert 4 * session.pass_pixels("geometry_misses").sum(dtype=np.float64) == pytest.approx(all_diced, rel=1e-6)


def test_the_statistics_count_rays_by_kind_and_tell_each_level(core):
    for integrator in ("PATH", "DISTRIBUTION"):
        session = render(
            core, balls_scene(core), size=16, samples=4, integrator=integrator, geometry_cache_megabytes=0.35
        )
        statistics = session.statistics()
        rays = statistics["rays"]
        assert rays["camera"] >= rays["paths"] == 4 * 256 and min(rays[kind] for kind in ("specular", "shadow")) > 0
        assert rays["hemisphere"] > 0, integrator
        cache, vertices = statistics["geometry_cache"], {"coarse": 4, "medium": 25, "fine": 289}
        assert cache["bytes"] > sum(cache["levels"][name]["bytes"] for name in LEVELS) >= 0
        levels = cache["levels"] | {"parts": cache["parts"]}
        vertices["parts"] = vertices["fine"]
        assert cache["vertices_recomputed"] == sum(level["vertices_recomputed"] for level in levels.values())
        for name, level in levels.items():
            assert level["misses"] == level["diced"] - level["cold"] >= 0 and level["bypassed"] <= level["diced"]
            assert level["vertices_recomputed"] == vertices[name] * level["misses"]
            found = level["lookups"] - level["diced"]
            assert level["hit_rate"] == pytest.approx(found / max(level["lookups"] - level["cold"], 1)) or found == 0


def test_dim_rays_see_coarser_facets_on_demand(core):
    sessions = [
        render(core, balls_scene(core), size=32, samples=4, importance_levels=on, tessellation_factor=0.1)
        for on in (False, True)
    ]
    assert share_of_lookups(sessions[1], "coarse") > share_of_lookups(sessions[0], "coarse")
    bright, dim = (session.pass_pixels("combined")[..., :3].mean() for session in sessions)
    assert dim == pytest.approx(bright, rel=0.01)


def test_mirrored_rays_widen_on_demand(core):
    """The disco ball: many flat mirrors, whose rays are narrow and go everywhere."""
    random = np.random.default_rng(1)
    facets = random.normal(size=(400, 3, 3)) * 0.03 + random.normal(size=(400, 1, 3)) * 0.4
    scene = core.SceneDescription()
    chrome = material(core, scene, ("glossy", 1.0, 1.0, 0.0, "SHARP"), name="chrome")
    triangles = np.arange(1200, dtype=np.int32).reshape(-1, 3)
    disco = scene.add_mesh("disco", facets.reshape(-1, 3).astype(np.float32), triangles)
    scene.add_instance("disco", disco, matrix(), chrome)
    matte = material(core, scene, ("diffuse", 1.0, 0.8), name="matte")
    scene.set_world(background(core))
    ball = scene.add_surface("ball", [sphere_spline(core)])
    for x, y in ((-3, 0), (3, 0), (0, 3), (0, -3)):
        scene.add_instance(f"ball {x} {y}", ball, matrix((x, y, 1)), matte)
    look_down(scene, 6.0, 0.25)
    narrow, wide = (
        render(core, scene, size=96, samples=16, least_mirrored_spread=spread) for spread in (0.0, np.radians(10.0))
    )
    assert share_of_lookups(wide, "coarse") > share_of_lookups(narrow, "coarse") + 0.2
    means = [session.pass_pixels("combined")[..., :3].mean() for session in (narrow, wide)]
    assert means[1] == pytest.approx(means[0], rel=0.05)


def test_what_a_magnifying_glass_shows_is_split_beyond_the_finest_level(core):
    def picture(is_magnified, **settings):
        scene = core.SceneDescription()
        ball = scene.add_surface("ball", [sphere_spline(core)])
        glow = scene.add_material_list([scene.add_material("glow", emission(core))])
        lens = material(core, scene, ("refraction", 1.0, 1.0, 0.0, 1.5, "SHARP"), name="lens")
        if is_magnified:
            scene.add_instance("lens", ball, matrix(), lens)
        # At the ball's focus, three halves of its radius from its middle; tiny, and not in the picture's middle.
        scene.add_instance("speck", ball, matrix((0.005, 0.002, -1.53), 0.02), glow)
        look_down(scene, 20.0, 0.04)
        session = render(core, scene, size=32, samples=4, **settings)
        return session.pass_pixels("combined")[..., 0].astype(float), cache_of(session)

    image, counters = picture(True)
    assert counters["splits"] > 0 and counters["parts"]["diced"] > 0
    assert picture(False)[1]["splits"] == 0
    finest = picture(True, tessellation_factor=0.1)[0]
    # Silhouettes are off by at most a tenth of a pixel, and one of four samples may be on the other side.
    assert 0.02 < finest.mean() < 0.98
    assert np.abs(image - finest).max() <= 0.25 and image.mean() == pytest.approx(finest.mean(), abs=0.01)


@pytest.mark.slow
def test_parts_of_split_subpatches_are_kept_and_no_budget_changes_the_picture(core):
    scene = core.SceneDescription()
    ball = scene.add_surface("ball", [sphere_spline(core)])
    glow = scene.add_material_list([scene.add_material("glow", emission(core))])
    scene.add_instance("ball", ball, matrix(), glow)
    look_down(scene, 1.02, 1.0)

    def picture(**settings):
        session = render(core, scene, size=16, samples=2, tessellation_factor=0.02, **settings)
        return session.pass_pixels("combined"), cache_of(session)["parts"], cache_of(session)["bytes"]

    image, kept, _ = picture(geometry_cache_megabytes=30.0)
    assert kept["lookups"] > 2 * kept["diced"] > 0 and kept["bypassed"] == 0 and kept["misses"] < 0.05 * kept["cold"]
    for settings in (dict(geometry_cache_megabytes=0.5), dict(geometry_cache_mode="NONE")):
        other, parts, held = picture(threads=1, **settings)
        assert np.array_equal(image, other), settings
        assert parts["diced"] > kept["diced"] and parts["lookups"] == kept["lookups"], settings
        assert "geometry_cache_megabytes" not in settings or held <= 0.5 * 2**20


@pytest.mark.slow
@pytest.mark.parametrize("integrator, rays", [("PATH", 1), ("DISTRIBUTION", 64)])
def test_the_error_of_occlusion_is_at_most_two_thousandths(core, integrator, rays):
    scene = balls_scene(core)
    settings = dict(size=32, samples=256 // rays, integrator=integrator, hemisphere_rays=rays, filter_width=0.01)
    several, single = (
        render(core, scene, geometry_cache_mode=mode, passes=["ambient_occlusion"], **settings)
        .pass_pixels("ambient_occlusion")[..., 0]
        .astype(float)
        for mode in ("MULTI", "SINGLE")
    )
    # With equal random numbers, and all samples of a pixel at one place, the noise is the same.
    assert 0.3 < several.mean() < 0.95
    assert np.sqrt(np.mean((several - single) ** 2)) <= 0.002


@pytest.mark.parametrize(
    "name, value",
    [
        ("geometry_cache_megabytes", float("nan")),
        ("geometry_cache_megabytes", float("inf")),
        ("tessellation_factor", 0.0),
        ("tessellation_factor", float("nan")),
        ("least_mirrored_spread", -0.1),
        ("least_mirrored_spread", float("nan")),
    ],
)
def test_a_setting_out_of_its_range_is_named(core, name, value):
    with pytest.raises(core.InputError, match=name.replace("_", " ")):
        render(core, balls_scene(core), **{name: value})


def test_an_unknown_cache_is_refused_with_those_there_are(core):
    with pytest.raises(core.InputError, match="MULTI, SINGLE, NONE"):
        core.Settings(geometry_cache_mode="HUGE")
