"""The irradiance cache: gradients against finite differences, error against sampling everywhere, determinism."""

import threading
import time

import numpy as np
import pytest
from path_scenes import ALL_PASSES, lit_plane, render, varied_scene
from rayleaf import _core
from scenes import background, look_down, matrix, quad, small_scene
from test_distribution_agrees import bleeding, glass, mirrors

distribution = _core.distribution
CACHED = dict(integrator="DISTRIBUTION", irradiance_cache=True)


def ceiling(directions, position, height=2.0):
    """Radiance and distance of a ceiling with a pattern, half of it hidden by a dark board below it."""
    z = np.maximum(directions[:, 2], 1e-6)
    t = height / z
    hit = position + directions * t[:, None]
    radiance = 2 + np.sin(1.3 * hit[:, 0]) + 0.5 * np.cos(0.9 * hit[:, 1])
    radiance = np.where(np.abs(hit[:, :2]).max(1) < 8, radiance, 1.0)
    board = position + directions * (0.7 * t)[:, None]
    hidden = (board[:, 0] > 0.3) & (np.abs(board[:, 1]) < 1.5) & (board[:, 0] < 2)
    return np.where(hidden, 0.1, radiance), np.where(hidden, 0.7, 1.0) * t


def irradiance(position, normal=(0, 0, 1), n=300):
    """By a dense regular grid of directions around +z."""
    i, j = np.meshgrid(np.arange(n), np.arange(2 * n), indexing="ij")
    cosine, angle = ((i + 0.5) / n).ravel(), ((j + 0.5) * np.pi / n).ravel()
    sine = np.sqrt(1 - cosine**2)
    directions = np.stack([sine * np.cos(angle), sine * np.sin(angle), cosine], 1)
    weights = np.maximum(directions @ np.asarray(normal), 0) * 2 * np.pi / (2 * n * n)
    return (ceiling(directions, np.asarray(position))[0] * weights).sum()


def sampled(rays, seed=0):
    rings, sectors = distribution.hemisphere_shape(rays)
    random = np.random.default_rng(seed).random((rings * sectors, 2)).astype(np.float32)
    directions = np.float64(distribution.hemisphere_directions(rays, random))
    radiance, distance = ceiling(directions, np.zeros(3))
    limits = (0.0, 1e9)
    return distribution.hemisphere_record(rays, (0, 0, 1), np.float32(radiance), np.float32(distance), limits)


def test_a_grid_of_directions_is_cosine_weighted_and_its_cells_are_about_square():
    rings, sectors = distribution.hemisphere_shape(1000)
    assert 0.9 < rings * sectors / 1000 < 1.1 and sectors / rings == pytest.approx(np.pi, rel=0.1)
    random = np.random.default_rng(0).random((rings * sectors, 2)).astype(np.float32)
    directions = distribution.hemisphere_directions(1000, random)
    assert np.linalg.norm(directions, axis=1) == pytest.approx(1, abs=1e-5)
    assert directions.mean(0) == pytest.approx([0, 0, 2 / 3], abs=5e-3)


def test_irradiance_and_its_gradients_match_finite_differences():
    records = [sampled(2000, seed) for seed in range(16)]
    mean = {key: np.mean([record[key] for record in records], 0) for key in records[0]}
    assert mean["irradiance"] == pytest.approx(irradiance((0, 0, 0)), rel=3e-3)
    h = 0.05
    moving = [(irradiance(step) - irradiance(-step)) / (2 * h) for step in np.eye(3)[:2] * h]
    # Cells are a few degrees wide: walls lie within one of where they are taken to be.
    assert mean["moving"][:2] == pytest.approx(moving, abs=0.05 * np.linalg.norm(moving))
    assert mean["moving"][2] == pytest.approx(0, abs=1e-5)
    # Turning about x lifts y, about y lowers x. The horizon itself brings nothing: the cosine is zero there.
    turns = [lambda a: (0, -np.sin(a), np.cos(a)), lambda a: (np.sin(a), 0, np.cos(a))]
    turning = [(irradiance((0, 0, 0), turn(h)) - irradiance((0, 0, 0), turn(-h))) / (2 * h) for turn in turns]
    # The grid stops a ring's middle short of the horizon, where tangents have no bound.
    assert mean["turning"][:2] == pytest.approx(turning, abs=0.1 * np.linalg.norm(turning))


def test_gradients_turn_with_the_normal():
    rings, sectors = distribution.hemisphere_shape(400)
    rng = np.random.default_rng(2)
    radiance = rng.random(rings * sectors).astype(np.float32)
    distance = rng.uniform(1, 3, rings * sectors).astype(np.float32)
    up = distribution.hemisphere_record(400, (0, 0, 1), radiance, distance, (0, 10))
    side = distribution.hemisphere_record(400, (1, 0, 0), radiance, distance, (0, 10))
    for key in ("turning", "moving"):
        assert np.linalg.norm(up[key]) == pytest.approx(np.linalg.norm(side[key]), rel=1e-4)
    assert side["moving"][0] == pytest.approx(0, abs=1e-5)


def test_the_radius_is_the_harmonic_mean_distance_within_its_limits():
    rings, sectors = distribution.hemisphere_shape(400)
    even = np.ones(rings * sectors, np.float32)
    far = np.full(rings * sectors, np.inf, np.float32)
    assert distribution.hemisphere_record(400, (0, 0, 1), even, even * 2, (0, 10))["radius"] == pytest.approx(2)
    assert distribution.hemisphere_record(400, (0, 0, 1), even, even * 2, (3, 10))["radius"] == pytest.approx(3)
    assert distribution.hemisphere_record(400, (0, 0, 1), even, far, (0, 10))["radius"] == pytest.approx(10)
    half = np.where(np.arange(rings * sectors) % sectors < sectors / 2, 5.0, 0.0).astype(np.float32)
    changing = distribution.hemisphere_record(400, (0, 0, 1), half, even * 2, (0, 10))
    assert changing["radius"] == pytest.approx(changing["irradiance"] / np.linalg.norm(changing["moving"]), rel=1e-4)
    # Where the least radius is more than that, the gradient foresees no more than a full change.
    held = distribution.hemisphere_record(400, (0, 0, 1), half, even * 2, (9, 10))
    assert np.linalg.norm(held["moving"]) * 9 == pytest.approx(held["irradiance"], rel=1e-4)


@pytest.mark.slow
@pytest.mark.parametrize("scene", [bleeding, mirrors, glass])
@pytest.mark.parametrize("indirect", ["AMBIENT_OCCLUSION", "COLOR_BLEEDING"])
def test_interpolation_is_close_to_sampling_and_takes_few_hemispheres(core, scene, indirect):
    passes = ["diffuse_color", "diffuse_direct", "diffuse_indirect", "ambient_occlusion"]
    settings = dict(size=32, samples=4, hemisphere_rays=64, light_rays=1, indirect=indirect, passes=passes)
    settings["occlusion_distance"] = 2.0
    full = render(core, scene(core), **{**settings, "integrator": "DISTRIBUTION"})
    cached = render(core, scene(core), **settings, **CACHED)
    counts = cached.statistics()["hemispheres"]
    assert 0 < counts["records"] < full.statistics()["hemispheres"]["sampled"] / 8
    # Behind gloss and curved glass a pixel's rays meet places that no pixel's middle does.
    assert counts["sampled"] < (1.0 if scene is glass else 0.1) * counts["interpolated"]
    for name in passes[1:]:
        a, b = (session.pass_pixels(name).astype(np.float64) for session in (full, cached))
        if name.startswith("diffuse"):
            a, b = (image * session.pass_pixels("diffuse_color") for image, session in ((a, full), (b, cached)))
        # Errors of the means; sampling alone leaves a per cent where lamps are sampled once.
        assert b.mean() == pytest.approx(a.mean(), rel=0.02, abs=0.003), name


def test_a_smaller_error_takes_more_records(core):
    records = []
    for error in (0.4, 0.2, 0.05):
        session = render(core, bleeding(core), size=32, samples=1, irradiance_error=error, **CACHED)
        records.append(session.statistics()["hemispheres"]["records"])
    assert records[0] < records[1] < records[2]


def test_under_an_even_sky_the_cache_is_exact(core):
    scene = lit_plane(core, albedo=0.5)
    scene.set_world(background(core, strength=2.0))
    image = render(core, scene, samples=1, **CACHED).pass_pixels("combined")
    np.testing.assert_allclose(image[..., :3], 1.0, rtol=1e-5)


@pytest.mark.parametrize("scene", [small_scene, varied_scene])
def test_the_same_bits_come_from_any_number_of_threads_and_size_of_tiles(core, scene):
    pictures = []
    for threads, tile_size in ((1, 64), (2, 8), (5, 4)):
        settings = dict(size=24, samples=2, threads=threads, tile_size=tile_size, passes=ALL_PASSES)
        session = render(core, scene(core), **settings, **CACHED)
        pictures.append([session.pass_pixels(name).tobytes() for name in ALL_PASSES])
        assert session.statistics()["hemispheres"]["records"] > 0
    assert pictures[0] == pictures[1] == pictures[2]


def test_the_passes_recombine_to_the_picture(core):
    session = render(core, varied_scene(core), size=16, samples=2, passes=ALL_PASSES, **CACHED)
    passes = {name: session.pass_pixels(name)[..., :3].astype(np.float64) for name in ALL_PASSES}
    total = passes["emission"] + passes["environment"]
    for kind in ("diffuse", "glossy", "transmission"):
        total += passes[f"{kind}_color"] * (passes[f"{kind}_direct"] + passes[f"{kind}_indirect"])
    np.testing.assert_allclose(total, passes["combined"], rtol=1e-4, atol=1e-5)


def test_a_surface_at_the_eye_and_a_scene_of_any_size_are_no_trouble(core):
    for scale in (1e-6, 1.0, 1e6):
        scene = core.SceneDescription()
        scene.add_instance("floor", quad(scene, "floor", 1.0), matrix(scale=scale))
        scene.set_world(background(core))
        scene.set_camera("PERSPECTIVE", matrix((0, 0, scale)), (-1, -1), (1, 1), 0.0, 1e9)
        image = render(core, scene, samples=1, **CACHED).pass_pixels("combined")
        np.testing.assert_allclose(image[1:-1, 1:-1, :3], 0.8, rtol=1e-4, err_msg=str(scale))


def test_a_surface_too_rough_to_interpolate_on_keeps_few_hemispheres(core):
    scene = core.SceneDescription()
    program = core.Program("rough")
    one, scale = program.constant(1, 1, 1, 1), program.constant(*[1e4] * 4)
    noise = program.operation("noise", [program.operation("position"), one, scale, one, one, one], [3])
    bent = program.operation("vector_math", [noise, program.constant(-0.5, -0.5, -0.2, 0)], text="ADD")
    program.operation("diffuse", [one, one, program.constant(0, 0, 0, 0), bent])
    rough = scene.add_material_list([scene.add_material("rough", program)])
    scene.add_instance("floor", quad(scene, "floor", 4.0), matrix(), rough)
    scene.set_world(background(core))
    look_down(scene, half=0.5)
    settings = dict(size=64, samples=1, hemisphere_rays=1, irradiance_error=0.02, **CACHED)
    counts = render(core, scene, **settings).statistics()["hemispheres"]
    assert counts["records"] <= 64 * 64 / 4
    assert counts["sampled"] > 64 * 64 / 2


def test_nothing_is_kept_where_path_tracing_or_no_cache_is_wanted(core):
    for settings in (dict(irradiance_cache=True), dict(integrator="DISTRIBUTION")):
        session = render(core, lit_plane(core), samples=1, **settings)
        assert session.statistics()["hemispheres"]["records"] == 0
        assert session.statistics()["memory"]["irradiance"] == 0


def test_a_render_that_is_cancelled_while_the_cache_fills_ends_soon(core):
    settings = dict(width=512, height=512, samples=64, hemisphere_rays=64, **CACHED)
    session = core.Session(varied_scene(core), core.Settings(**settings))
    thread = threading.Thread(target=session.render)
    thread.start()
    while session.progress()[0] != "rendering":
        time.sleep(0.01)
    time.sleep(0.2)
    start = time.monotonic()
    session.cancel()
    thread.join(20)
    assert not thread.is_alive() and time.monotonic() - start < 10
    assert session.progress() == ("cancelled", 0.0)
