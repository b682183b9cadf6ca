"""Path tracing against what can be said in closed form: furnaces, bounce limits, shadows, passes, determinism."""

import numpy as np
import pytest
from scenes import CUBE_TRIANGLES, CUBE_VERTICES, background, diffuse, emission, look_down, matrix, quad, sphere_spline

LIGHT_PASSES = [f"{kind}_{part}" for kind in ("diffuse", "glossy", "transmission") for part in ("direct", "indirect")]
COLOR_PASSES = ["diffuse_color", "glossy_color", "transmission_color"]
SURFACE_PASSES = ["depth", "position", "normal", "uv", "object_index", "material_index"]
ALL_PASSES = ["combined", "emission", "environment", *LIGHT_PASSES, *COLOR_PASSES, *SURFACE_PASSES]
UNLIMITED = dict(
    max_bounces=1000, diffuse_bounces=1000, glossy_bounces=1000, transmission_bounces=1000, clamp_indirect=0.0
)


def render(core, scene, size=8, samples=64, **settings):
    values = dict(width=size, height=size, samples=samples, clamp_indirect=0.0, filter="BOX", filter_width=1.0)
    session = core.Session(scene, core.Settings(**{**values, **settings}))
    assert session.render()
    return session


def picture(core, scene, **settings):
    return render(core, scene, **settings).pass_pixels("combined")[..., :3]


def material(core, scene, *closures, name="material"):
    """A material of the sum of closures (operation, arguments…, keyword text), as a list for an instance."""
    program = core.Program(name)
    for operation, *arguments in closures:
        text = arguments.pop() if isinstance(arguments[-1], str) else ""
        operands = [program.constant(*(a if isinstance(a, tuple) else (a,) * 3), 1) for a in arguments]
        program.operation(operation, operands, text=text)
    return scene.add_material_list([scene.add_material(name, program)])


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


GLOW = ("emission", 1.0, 1.0, 1.0)
SCATTERERS = {
    "diffuse": ("diffuse", 1.0, 0.5),
    "mirror": ("glossy", 1.0, 0.5, 0.0, "SHARP"),
}


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


def lit_plane(core, albedo=0.5, size=20.0):
    scene = core.SceneDescription()
    scene.add_instance("plane", quad(scene, "plane", size), matrix(), material(core, scene, ("diffuse", 1.0, albedo)))
    look_down(scene, half=0.05)
    return scene


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
    light = probe.sample(position, (rng.random((20000, 3)) * (1 - 1e-6)).astype(np.float32))
    cosine = np.maximum(light["direction"][:, 2], 0)
    by_light = np.where(light["density"] > 0, light["radiance"][:, 0] * cosine / np.maximum(light["density"], 1e-30), 0)
    r = rng.random((60000, 2))
    directions = np.stack(
        [np.sqrt(r[:, 0]) * f(2 * np.pi * r[:, 1]) for f in (np.cos, np.sin)] + [np.sqrt(1 - r[:, 0])], 1
    )
    by_scattering = np.pi * probe.look(position, directions)[0][:, 0]
    return [(values.mean(), values.std() / np.sqrt(len(values))) for values in (by_light, by_scattering)]


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


def uneven_world(core):
    program = core.Program("world")
    one, scale = program.constant(1, 1, 1, 1), program.constant(*[1.5] * 4)
    bright, dark = program.constant(20, 20, 20, 1), program.constant(0.1, 0.1, 0.1, 1)
    program.operation(
        "background", [one, program.operation("checker", [program.operation("generated"), bright, dark, scale]), one]
    )
    return program


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


def veil(core, scene, transparency, *more, name="veil"):
    return material(core, scene, ("transparent", 1.0, transparency), *more, name=name)


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
    assert np.all(render(core, scene, film_transparent=True).pass_pixels("combined") == 0.0)
    solid = render(core, scene).pass_pixels("combined")
    assert np.all(solid[..., :3] == 0.0) and np.all(solid[..., 3] == 1.0)


@pytest.mark.parametrize("panes", [1, 3])
def test_shadow_rays_take_the_colour_of_transparent_panes_up_to_the_limit(core, panes):
    def scene_with(count):
        scene = lit_plane(core)
        for i in range(count):
            pane = veil(core, scene, (0.9, 0.5, 0.2), name=f"pane {i}")
            scene.add_instance(f"pane {i}", quad(scene, "pane", 2), matrix((0, 0, 0.5 + 0.1 * i)), pane, visibility=30)
        scene.add_lamp("lamp", "POINT", matrix((0, 0, 2)), (100,) * 3, radius=0.1, visibility=30)
        return scene

    settings = dict(max_bounces=0, samples=16)
    bare = picture(core, scene_with(0), **settings).mean((0, 1))
    covered = picture(core, scene_with(panes), transparent_bounces=panes, **settings).mean((0, 1))
    assert covered == pytest.approx(bare * np.array([0.9, 0.5, 0.2]) ** panes, rel=0.02)
    assert np.all(picture(core, scene_with(panes), transparent_bounces=panes - 1, **settings) == 0.0)


def test_a_lamp_that_casts_no_shadow_shines_through_walls(core):
    for casts_shadow in (True, False):
        scene = lit_plane(core)
        scene.add_instance("wall", quad(scene, "wall", 2), matrix((0, 0, 1)), visibility=30)
        scene.add_lamp("lamp", "POINT", matrix((0, 0, 2)), (100,) * 3, casts_shadow=casts_shadow)
        image = picture(core, scene, max_bounces=0)
        assert (image.mean() == 0.0) == casts_shadow


def test_rays_see_lamps_and_objects_of_their_visibility_only(core):
    scene = lit_plane(core)
    scene.add_lamp("lamp", "RECTANGLE", matrix((0, 0, 4)) , (100,) * 3, visibility=29)
    assert picture(core, scene).max() == 0.0, "a lamp that diffuse rays do not see lights no diffuse surface"
    seen = []
    for visibility in (31, 30):
        scene = lit_plane(core)
        turned = matrix((0, 0, 2)) @ np.diag([1.0, -1.0, -1.0, 1.0])
        scene.add_lamp("lamp", "RECTANGLE", turned, (100,) * 3, visibility=visibility)
        seen.append(picture(core, scene).max())
    assert seen[0] == pytest.approx(25.0, rel=1e-5) and seen[1] == 0.0


def varied_scene(core):
    """Every kind of lobe, a veil, an emitter, lamps of two kinds and an uneven world."""
    scene = core.SceneDescription()
    floor = material(core, scene, ("diffuse", 0.6, (0.8, 0.5, 0.3)), ("glossy", 0.4, 0.9, 0.3, "GGX"), name="floor")
    scene.add_instance("floor", quad(scene, "floor", 4), matrix(), floor, object_index=3)
    glass = material(core, scene, ("glass", 1.0, (0.9, 1.0, 0.9), 0.0, 1.45, "SHARP"), name="glass")
    scene.add_instance("ball", scene.add_surface("ball", [sphere_spline(core)]), matrix((0.4, 0.1, 1), 0.5), glass)
    hazy = veil(core, scene, 0.4, ("translucent", 0.3, 0.8), ("diffuse", 0.3, (0.2, 0.4, 0.8)))
    scene.add_instance("veil", quad(scene, "veil", 0.5), matrix((-0.5, -0.3, 0.8)), hazy)
    glow = scene.add_material_list([scene.add_material("glow", emission(core, color=(1, 0.6, 0.3), strength=4.0))])
    scene.add_instance("glow", scene.add_mesh("cube", CUBE_VERTICES, CUBE_TRIANGLES), matrix((-0.4, 0.6, 0.4), 0.2), glow)
    scene.add_lamp("key", "RECTANGLE", matrix((1, 1, 3)), (60, 60, 50))
    scene.add_lamp("fill", "POINT", matrix((-1, -1, 2)), (10, 10, 20), radius=0.2)
    scene.set_world(uneven_world(core), 32)
    look_down(scene, height=4, half=0.35)
    return scene


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


def test_the_clip_range_of_the_camera_cuts_what_the_camera_sees_only(core):
    scene = lit_plane(core)
    scene.set_world(background(core, strength=1.0))
    scene.set_camera("PERSPECTIVE", matrix((0, 0, 5)), (-0.1, -0.1), (0.1, 0.1), 0.1, 4.0)
    assert picture(core, scene) == pytest.approx(np.ones((8, 8, 3)))
    scene.set_camera("PERSPECTIVE", matrix((0, 0, 5)), (-0.1, -0.1), (0.1, 0.1), 0.1, 6.0)
    assert picture(core, scene).mean() == pytest.approx(0.5, rel=0.01)


@pytest.mark.parametrize("seed", range(6))
def test_no_pass_is_ever_nan_or_infinite_under_nasty_parameters(core, seed):
    rng = np.random.default_rng(seed)

    def nasty():
        return float(rng.choice([0.0, 1e-30, 1e-9, 1e-3, 0.5, 1.0, 3.0, 1e6, 1e20, 1e30]))

    scene = core.SceneDescription()
    closures = [
        ("diffuse", nasty(), nasty(), nasty()),
        ("glossy", nasty(), nasty(), nasty(), "GGX"),
        ("glass", nasty(), nasty(), nasty(), nasty(), "BECKMANN"),
        ("transparent", nasty(), nasty()),
        ("emission", nasty(), nasty(), nasty()),
    ]
    for i in range(4):
        chosen = [closures[j] for j in rng.choice(len(closures), 2, replace=False)]
        slots = material(core, scene, *chosen, name=f"material {i}")
        place = matrix(rng.uniform(-1, 1, 3), float(rng.choice([1e-6, 0.5, 1.0])))
        shape = scene.add_surface("ball", [sphere_spline(core)]) if i % 2 else quad(scene, "quad", 1.0)
        scene.add_instance(f"thing {i}", shape, place, slots)
    for kind in ("POINT", "SUN", "SPOT", "RECTANGLE", "DISK"):
        scene.add_lamp(
            kind,
            kind,
            matrix(rng.uniform(-1, 1, 3)),
            (nasty(), nasty(), nasty()),
            radius=nasty(),
            angle=min(nasty(), 3.0),
            size_x=nasty(),
            size_y=nasty(),
            spread=min(nasty(), 3.0),
            spot_size=min(nasty(), 3.0),
        )
    scene.set_world(uneven_world(core), 16)
    look_down(scene, height=3)
    session = render(core, scene, samples=8, passes=ALL_PASSES, clamp_indirect=10.0)
    for name in ALL_PASSES:
        assert np.isfinite(session.pass_pixels(name)).all(), f"{name}, seed {seed}"
