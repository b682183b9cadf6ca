"""Path tracing against what can be said in closed form: furnaces, bounce limits, shadows, passes, determinism."""

import numpy as np
import pytest
from path_scenes import lit_plane, material, picture, uneven_world, veil
from scenes import CUBE_TRIANGLES, CUBE_VERTICES, background, emission, look_down, matrix, quad, sphere_spline


def furnace(core, shape, *closures):
    """A camera in the middle of a closed room that all shines and scatters alike."""
    scene = core.SceneDescription()
    if shape == "cube":
        room = scene.add_mesh("cube", CUBE_VERTICES, CUBE_TRIANGLES)
    else:
        room = scene.add_surface("sphere", [sphere_spline(core)])
    scene.add_instance("room", room, matrix((0.1, 0.2, 0.05)), material(core, scene, *closures))
    look_down(scene, height=0.0)
    return scene


UNLIMITED = dict(
    max_bounces=1000, diffuse_bounces=1000, glossy_bounces=1000, transmission_bounces=1000, clamp_indirect=0.0
)


GLOW = ("emission", 1.0, 1.0, 1.0)
SCATTERERS = {
    "diffuse": ("diffuse", 1.0, 0.5),
    "mirror": ("glossy", 1.0, 0.5, 0.0, "SHARP"),
}


@pytest.mark.slow
@pytest.mark.parametrize("shape", ["cube", "sphere"])
@pytest.mark.parametrize("scatterer", SCATTERERS)
@pytest.mark.parametrize("roulette_start", [0, 3, 1000])
def test_a_closed_room_that_shines_has_the_radiance_of_its_geometric_series(core, shape, scatterer, roulette_start):
    scene = furnace(core, shape, GLOW, SCATTERERS[scatterer])
    image = picture(core, scene, roulette_start=roulette_start, **UNLIMITED)
    # E / (1 - albedo). Every path carries nearly the same, so 4096 of them are within a per cent.
    assert image.mean() == pytest.approx(2.0, rel=0.01)


@pytest.mark.parametrize("scatterer,limit", [("diffuse", "diffuse_bounces"), ("mirror", "glossy_bounces")])
@pytest.mark.parametrize("bounces", [0, 1, 2, 5])
def test_a_bounce_limit_ends_the_geometric_series(core, scatterer, limit, bounces):
    expected = sum(0.5**k for k in range(bounces + 2))  # 0 bounces leave direct light
    scene = furnace(core, "cube", GLOW, SCATTERERS[scatterer])
    for name in (limit, "max_bounces"):
        image = picture(core, scene, **{**UNLIMITED, name: bounces, "roulette_start": 1000})
        assert image.mean() == pytest.approx(expected, rel=0.01), name


LOSSLESS = {
    "diffuse": ("diffuse", 1.0, 1.0),
    "mirror": ("glossy", 1.0, 1.0, 0.0, "SHARP"),
    "glass": ("glass", 1.0, 1.0, 0.0, 1.5, "SHARP"),
    "refraction without an index": ("refraction", 1.0, 1.0, 0.0, 1.0, "SHARP"),
    "transparent": ("transparent", 1.0, 1.0),
    "translucent": ("translucent", 1.0, 1.0),
}


@pytest.mark.parametrize("name", LOSSLESS)
@pytest.mark.parametrize("shape", ["cube", "sphere"])
def test_a_lossless_thing_cannot_be_seen_in_a_world_that_is_the_same_everywhere(core, name, shape):
    scene = core.SceneDescription()
    thing = (
        scene.add_mesh("cube", CUBE_VERTICES, CUBE_TRIANGLES)
        if shape == "cube"
        else scene.add_surface("sphere", [sphere_spline(core)])
    )
    scene.add_instance("thing", thing, matrix((0.1, 0.2, 0.3)), material(core, scene, LOSSLESS[name]))
    scene.set_world(background(core, strength=0.7))
    look_down(scene, half=0.4)
    image = picture(core, scene, transparent_bounces=1000, **UNLIMITED)
    # Single pixels hold 64 paths; only roulette and refused samples at grazing angles can make them differ.
    assert image.mean() == pytest.approx(0.7, rel=0.005)
    assert np.abs(image - 0.7).max() < 0.1


def test_a_plane_below_a_point_lamp_has_its_albedo_times_irradiance_over_pi(core):
    scene = lit_plane(core)
    scene.add_lamp("lamp", "POINT", matrix((0, 0, 2)), (100, 50, 0))
    expected = 0.5 / np.pi * np.array([100, 50, 0]) / (4 * np.pi * 4)
    assert picture(core, scene).mean((0, 1)) == pytest.approx(expected, rel=0.02)


BIG_LAMPS = {
    "sphere": dict(kind="POINT", radius=1.2),
    "rectangle": dict(kind="RECTANGLE", size_x=3.0, size_y=2.0),
    "disk": dict(kind="DISK", size_x=3.0, size_y=3.0),
    "sun": dict(kind="SUN", angle=1.0),
}


def light_alone_and_scattering_alone(core, scene, position):
    """Irradiance with its error, by light sampling and by cosine-weighted directions."""
    probe = core.LightProbe(scene)
    rng = np.random.default_rng(3)
    light = probe.sample(position, (rng.random((20000, 2)) * (1 - 1e-6)).astype(np.float32))
    cosine = np.maximum(light["direction"][:, 2], 0)
    by_light = np.where(light["density"] > 0, light["radiance"][:, 0] * cosine / np.maximum(light["density"], 1e-30), 0)
    r = rng.random((60000, 2))
    directions = np.stack(
        [np.sqrt(r[:, 0]) * f(2 * np.pi * r[:, 1]) for f in (np.cos, np.sin)] + [np.sqrt(1 - r[:, 0])], 1
    )
    by_scattering = np.pi * probe.look(position, directions)[0][:, 0]
    return [(values.mean(), values.std() / np.sqrt(len(values))) for values in (by_light, by_scattering)]


def direction_world(core):
    """Shines with the direction it is seen in, plus 2."""
    program = core.Program("world")
    one, two = program.constant(1, 1, 1, 1), program.constant(2, 2, 2, 1)
    direction = program.operation("vector_math", [program.operation("generated"), two], text="ADD")
    program.operation("background", [one, direction, one])
    return program


@pytest.mark.parametrize("ior", [1.45, 1 / 1.2])
def test_a_clear_ball_of_splines_bends_rays_as_snell_says(core, ior):
    scene = core.SceneDescription()
    clear = material(core, scene, ("refraction", 1.0, 1.0, 0.0, ior, "SHARP"))
    scene.add_instance("ball", scene.add_surface("ball", [sphere_spline(core)]), matrix(), clear)
    scene.set_world(direction_world(core), 0)
    scene.set_camera("ORTHOGRAPHIC", matrix((0, 0, 5)), (-1, -1), (1, 1), 0.01, 100)
    image = picture(core, scene, size=31, samples=1, filter_width=0.0)
    places = (np.arange(31) + 0.5) / 31 * 2 - 1
    x, y = np.meshgrid(places, places)
    radius = np.hypot(x, y)
    inside = (radius > 0) & (radius < 0.95 * min(1, ior))  # beyond, a bubble reflects all
    bend = 2 * (np.arcsin(radius[inside]) - np.arcsin(radius[inside] / ior))
    outward = np.stack([x[inside], y[inside]], 1) / radius[inside][:, None]
    expected = np.concatenate([-np.sin(bend)[:, None] * outward, -np.cos(bend)[:, None]], 1)
    # Normals are exact. The facets move each of the two hits by a tenth of the rays' distance at most, so the bend by
    # that share of its change from pixel to pixel.
    slope = 2 * np.abs(1 / np.sqrt(1 - radius[inside] ** 2) - 1 / np.sqrt(ior**2 - radius[inside] ** 2))
    off = np.linalg.norm(image[inside] - 2 - expected, axis=1)
    assert (off <= 2 * 0.1 * (2 / 31) * slope + 1e-4).all(), (off - 2 * 0.1 * (2 / 31) * slope).max()


@pytest.mark.parametrize("lamp", BIG_LAMPS.values(), ids=BIG_LAMPS.keys())
def test_both_samplings_together_give_what_each_gives_alone(core, lamp):
    scene = lit_plane(core)
    scene.add_lamp("lamp", matrix=matrix((0.5, 0.3, 2)), strength=(50,) * 3, visibility=30, **lamp)
    image = picture(core, scene, size=16)
    mean, error = image.mean() / 0.5 * np.pi, image.std() / 16 / 0.5 * np.pi
    for value, own_error in light_alone_and_scattering_alone(core, scene, np.array([0, 0, 1e-6])):
        assert abs(mean - value) < 5 * np.hypot(error, own_error) + 0.005 * value


def test_an_emitting_mesh_lights_as_the_rectangle_lamp_of_its_radiance_does(core):
    images = []
    for kind in ("mesh", "lamp"):
        scene = lit_plane(core)
        if kind == "mesh":
            glow = scene.add_material_list([scene.add_material("glow", emission(core, strength=5.0))])
            flip = matrix((0.5, 0.3, 2)) @ np.diag([1.0, -1.0, -1.0, 1.0])
            scene.add_instance("mesh", quad(scene, "mesh", 0.5), flip, glow, visibility=30)
        else:
            scene.add_lamp("lamp", "RECTANGLE", matrix((0.5, 0.3, 2)), (20.0,) * 3, visibility=30)
        images.append(picture(core, scene, size=16, max_bounces=0))
    error = np.hypot(images[0].std(), images[1].std()) / 16
    assert abs(images[0].mean() - images[1].mean()) < 5 * error


def test_sampling_the_world_changes_the_noise_and_not_the_picture(core):
    images = []
    for resolution in (0, 64):
        scene = lit_plane(core)
        scene.set_world(uneven_world(core), resolution)
        images.append(picture(core, scene, size=16, samples=128))
    error = np.hypot(images[0].std(), images[1].std()) / 16
    assert abs(images[0].mean() - images[1].mean()) < 5 * error


def test_light_on_plates_of_every_roughness_from_lamps_of_every_size_stays_calm(core):
    """Veach's plates: sampling only lights, or only lobes, leaves one corner of this table noisy."""
    for roughness in (0.05, 0.2, 0.6):
        for radius in (0.01, 0.1, 0.8):
            scene = core.SceneDescription()
            plate = material(core, scene, ("glossy", 1.0, 1.0, roughness, "GGX"))
            scene.add_instance("plate", quad(scene, "plate", 5), matrix(), plate)
            scene.add_lamp("lamp", "POINT", matrix((0, 0, 3)), (100,) * 3, radius=radius, visibility=30)
            look_down(scene, half=0.0002)  # a spot much smaller than the sharpest highlight
            image = picture(core, scene, samples=64)
            relative = image.std() / image.mean()
            # 64 samples of a good estimator: below 15 % in every pixel; one-sided sampling gives 50 % and more.
            assert relative < 0.15, f"roughness {roughness}, radius {radius}: {relative}"


def test_tiny_bright_lamps_make_no_fireflies(core):
    for lamp in (dict(kind="POINT", radius=1e-4), dict(kind="RECTANGLE", size_x=1e-4, size_y=1e-4)):
        scene = lit_plane(core)
        scene.add_lamp("lamp", matrix=matrix((0.3, 0, 2)), strength=(1e5,) * 3, **lamp)
        image = picture(core, scene, samples=16, max_bounces=0)
        assert image.max() < 1.1 * image.mean() and image.min() > 0.9 * image.mean()


def test_clamping_limits_each_contribution_of_its_kind(core):
    scene = furnace(core, "cube", GLOW, SCATTERERS["diffuse"])
    unclamped = picture(core, scene, max_bounces=1, diffuse_bounces=1)
    assert unclamped.mean() == pytest.approx(1.75, rel=0.01)
    # Emission seen (1) and direct light come in contributions of at most 1; each is cut to 0.1.
    direct = picture(core, scene, max_bounces=1, diffuse_bounces=1, clamp_direct=0.1)
    assert 0.1 < direct.mean() < 0.1 * 3 + 0.26
    indirect = picture(core, scene, max_bounces=1, diffuse_bounces=1, clamp_indirect=0.01)
    assert 1.5 * 0.99 < indirect.mean() < 1.5 * 1.01 + 0.02


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_clamping_goes_by_the_mean_of_the_channels(core, sign):
    """As in Cycles: of light that is taken away as well."""
    scene = lit_plane(core)
    scene.add_lamp("lamp", "POINT", matrix((0, 0, 2)), strength=(sign * 9000, sign * 900, 0))
    image = picture(core, scene, samples=4, clamp_direct=1.0).mean((0, 1))[:3]
    np.testing.assert_allclose(image, sign * np.array([3 / 1.1, 0.3 / 1.1, 0.0]), rtol=1e-4, atol=1e-6)


@pytest.mark.parametrize("panes", [1, 3])
def test_shadow_rays_take_the_colour_of_transparent_panes_up_to_the_limit(core, panes):
    def scene_with(count, radius=0.1):
        scene = lit_plane(core)
        for i in range(count):
            pane = veil(core, scene, (0.9, 0.5, 0.2), name=f"pane {i}")
            scene.add_instance(f"pane {i}", quad(scene, "pane", 2), matrix((0, 0, 0.5 + 0.1 * i)), pane, visibility=30)
        scene.add_lamp("lamp", "POINT", matrix((0, 0, 2)), (100,) * 3, radius=radius, visibility=30)
        return scene

    settings = dict(max_bounces=0, samples=16)
    bare = picture(core, scene_with(0), **settings).mean((0, 1))
    covered = picture(core, scene_with(panes), transparent_bounces=panes, **settings).mean((0, 1))
    assert covered == pytest.approx(bare * np.array([0.9, 0.5, 0.2]) ** panes, rel=0.02)
    # Scattered rays see a light behind one surface more, as in Cycles; they cannot find a lamp without size.
    assert np.all(picture(core, scene_with(panes, 0.0), transparent_bounces=panes - 1, **settings) == 0.0)


def test_a_lamp_that_casts_no_shadow_shines_through_walls(core):
    for casts_shadow in (True, False):
        scene = lit_plane(core)
        scene.add_instance("wall", quad(scene, "wall", 2), matrix((0, 0, 1)), visibility=30)
        scene.add_lamp("lamp", "POINT", matrix((0, 0, 2)), (100,) * 3, casts_shadow=casts_shadow)
        image = picture(core, scene, max_bounces=0)
        assert (image.mean() == 0.0) == casts_shadow


def test_rays_see_lamps_and_objects_of_their_visibility_only(core):
    scene = lit_plane(core)
    scene.add_lamp("lamp", "RECTANGLE", matrix((0, 0, 4)), (100,) * 3, visibility=29)
    assert picture(core, scene).max() == 0.0, "a lamp that diffuse rays do not see lights no diffuse surface"
    seen = []
    for visibility in (31, 30):
        scene = lit_plane(core)
        turned = matrix((0, 0, 2)) @ np.diag([1.0, -1.0, -1.0, 1.0])
        scene.add_lamp("lamp", "RECTANGLE", turned, (100,) * 3, visibility=visibility)
        seen.append(picture(core, scene).max())
    assert seen[0] == pytest.approx(25.0, rel=1e-5) and seen[1] == 0.0


def test_the_clip_range_of_the_camera_cuts_what_the_camera_sees_only(core):
    scene = lit_plane(core)
    scene.set_world(background(core, strength=1.0))
    scene.set_camera("PERSPECTIVE", matrix((0, 0, 5)), (-0.1, -0.1), (0.1, 0.1), 0.1, 4.0)
    assert picture(core, scene) == pytest.approx(np.ones((8, 8, 3)))
    scene.set_camera("PERSPECTIVE", matrix((0, 0, 5)), (-0.1, -0.1), (0.1, 0.1), 0.1, 6.0)
    assert picture(core, scene).mean() == pytest.approx(0.5, rel=0.01)
