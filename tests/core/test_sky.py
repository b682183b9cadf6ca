"""The sky that a table tells: what it shows, and that its sun is sampled as the small bright disc that it is."""

import numpy as np
import pytest
from test_integrators_world_image import lit_plane

SUN, HALF = np.array([0.6, 0.0, 0.8]), 0.005
LOW, HIGH = (1000.0, 500.0, 100.0), (3000.0, 2500.0, 1100.0)
WIDTH, HEIGHT = 16, 8
BEGIN = 0.4


def sky_colors():
    return np.random.default_rng(1).random((HEIGHT, WIDTH, 3)).astype(np.float32)


def table(colors, half=HALF, sun=SUN, is_whole=False, horizon=0.0):
    elevation = np.arcsin(sun[2])
    height, width = colors.shape[:2]
    header = [*sun, half, *LOW, elevation - half, *HIGH, elevation + half, BEGIN, width, height, 0.0]
    header += [is_whole, horizon, 0.0, 0.0]
    return np.concatenate([np.array(header, np.float32), np.ravel(colors)])


def directions_at(rows, columns):
    """Of places in the table, in rows and columns from 0."""
    elevation = 0.5 * np.pi * (np.asarray(rows) / HEIGHT) ** 2
    azimuth = BEGIN + 2.0 * np.pi * np.asarray(columns) / WIDTH
    return np.stack([np.cos(elevation) * np.sin(azimuth), np.cos(elevation) * np.cos(azimuth), np.sin(elevation)], -1)


def seen(core, numbers, directions, together=1):
    """What a world shows along directions of different lengths."""
    program = core.Program("world")
    register = program.operation("sky", [program.operation("position")], floats=numbers)
    lengths = np.linspace(0.5, 2.0, len(directions))[:, None]
    up = np.broadcast_to(np.array([0.0, 0.0, 1.0], np.float32), (len(directions), 3))
    points = core.shading.surface_points(np.asarray(directions) * lengths, up, up)
    return points.values(program, register, together)[:, :3]


def test_the_table_is_shown_where_it_says(core):
    colors = sky_colors()
    rows, columns = np.meshgrid(np.arange(HEIGHT) + 0.5, np.arange(WIDTH) + 0.5, indexing="ij")
    found = seen(core, table(colors, half=0.0), directions_at(rows.ravel(), columns.ravel()), 17)
    np.testing.assert_allclose(found.reshape(colors.shape), colors, atol=2e-4)
    middle = seen(core, table(colors, half=0.0), directions_at([3.0], [5.0]))[0]
    wanted = colors[2:4, 4:6].mean((0, 1))
    np.testing.assert_allclose(middle, wanted, atol=2e-4)


def test_below_the_horizon_the_lowest_row_fades(core):
    colors = np.broadcast_to(np.array([1.0, 2.0, 4.0], np.float32), (HEIGHT, WIDTH, 3))
    heights = np.array([0.0, -0.1, -0.2, -0.4, -0.9])
    directions = np.stack([np.sqrt(1.0 - heights**2), 0.0 * heights, heights], -1)
    found = seen(core, table(colors, half=0.0), directions)
    wanted = np.clip(1.0 + heights / 0.4, 0.0, 1.0) ** 3
    np.testing.assert_allclose(found, wanted[:, None] * colors[0, 0], atol=1e-5)


def test_a_whole_table_is_shown_below_the_horizon_too(core):
    colors = np.random.default_rng(5).random((2 * HEIGHT, WIDTH, 3)).astype(np.float32)
    rows, columns = np.meshgrid(np.arange(HEIGHT) + 0.5, np.arange(WIDTH) + 0.5, indexing="ij")
    above = directions_at(rows.ravel(), columns.ravel())
    numbers = table(colors, half=0.0, is_whole=True)
    found = seen(core, numbers, above)
    np.testing.assert_allclose(found.reshape(HEIGHT, WIDTH, 3), colors[HEIGHT:], atol=2e-4)
    found = seen(core, numbers, above * (1, 1, -1))
    np.testing.assert_allclose(found.reshape(HEIGHT, WIDTH, 3), colors[HEIGHT - 1 :: -1], atol=2e-4)


def test_the_disc_of_a_whole_table_adds_to_the_sky_down_to_the_earth(core):
    even = np.ones((2 * HEIGHT, WIDTH, 3))
    sun = np.array([1.0, 0.0, 0.0])
    directions = [[np.cos(e), 0.0, np.sin(e)] for e in (0.002, -0.0005, -0.002)]
    found = seen(core, table(even, sun=sun, is_whole=True, horizon=-0.001), directions)
    for color, angle in zip(found, (0.002, -0.0005)):
        mixed = np.array(LOW) + (np.array(HIGH) - LOW) * (1.0 + angle / HALF) / 2.0
        limb = 0.4 + 0.6 * np.sqrt(1.0 - (angle / HALF) ** 2)
        np.testing.assert_allclose(color, mixed * limb + 1.0, rtol=3e-3)
    np.testing.assert_allclose(found[2], 1.0)


def test_the_disc_covers_the_sky_and_is_darker_towards_its_edge(core):
    up = np.array([-0.8, 0.0, 0.6])  # along the great circle over the sun
    for share in (-0.9, -0.3, 0.0, 0.5, 0.99, 1.01):
        angle = share * HALF
        found = seen(core, table(np.ones((HEIGHT, WIDTH, 3))), [SUN * np.cos(angle) + up * np.sin(angle)])[0]
        mixed = np.array(LOW) + (np.array(HIGH) - LOW) * (1.0 + share) / 2.0
        limb = 0.4 + 0.6 * np.sqrt(max(1.0 - share**2, 0.0))
        np.testing.assert_allclose(found, mixed * limb if share < 1.0 else 1.0, rtol=3e-3)


def test_points_together_have_the_same_bits(core):
    directions = np.random.default_rng(2).normal(size=(50, 3))
    numbers = table(sky_colors(), half=0.3)
    np.testing.assert_array_equal(seen(core, numbers, directions, 1), seen(core, numbers, directions, 32))


@pytest.mark.parametrize(
    "change",
    [
        lambda t: t[:12],
        lambda t: t[:-4],
        lambda t: np.where(np.arange(len(t)) == 13, 2.5, t),
        lambda t: np.where(np.arange(len(t)) == 3, -1.0, t),
        lambda t: np.where(np.arange(len(t)) == 0, 3.0, t),
        lambda t: np.where(np.arange(len(t)) == 11, 0.0, t),
    ],
    ids=["no header", "too few colours", "half a column", "a negative disc", "no unit vector", "no height"],
)
def test_what_is_no_table_is_refused(core, change):
    program = core.Program("world")
    with pytest.raises(core.InputError, match="world.*table of 'sky'.*sky.h"):
        program.operation("sky", [program.operation("position")], floats=change(table(sky_colors())))


def plane_under_sky(core, sky_brightness, samples, visible_sun=True):
    """Pixels of a diffuse plane of albedo 1/2."""
    scene, world = core.SceneDescription(), core.Program("world")
    colors = np.full((HEIGHT, WIDTH, 3), sky_brightness, np.float32)
    one = world.constant(1, 1, 1, 1)
    numbers = table(colors, half=HALF if visible_sun else 0.0)
    world.operation("background", [one, world.operation("sky", [world.operation("generated")], floats=numbers), one])
    scene.set_world(world, 64)
    return lit_plane(core, scene, samples)


def test_a_plane_has_all_light_of_a_sun_that_is_smaller_than_a_cell_of_the_worlds_table(core):
    pixels = plane_under_sky(core, sky_brightness=0.0, samples=16)
    # The mean of 0.4 + 0.6 sqrt(1 - r²) over a disc is 0.8.
    wanted = 0.5 * (np.array(LOW) + HIGH) / 2.0 * 0.8 * np.pi * HALF**2 * SUN[2] / np.pi
    np.testing.assert_allclose(pixels.mean(0), wanted, rtol=2e-3)
    assert pixels.std(0).max() < 0.1 * wanted.max(), "the disc alone makes noise"


def test_the_sky_and_its_sun_add_up(core):
    sky = plane_under_sky(core, sky_brightness=0.05, samples=64, visible_sun=False)
    sun = plane_under_sky(core, sky_brightness=0.0, samples=64)
    both = plane_under_sky(core, sky_brightness=0.05, samples=64)
    np.testing.assert_allclose(both.mean(0), sky.mean(0) + sun.mean(0), rtol=5e-3)
    assert sky.mean() > 0.2 * sun.mean(), "the sky counts"


def test_what_is_sampled_of_a_sky_adds_up_to_all_light(core):
    scene, world = core.SceneDescription(), core.Program("world")
    one = world.constant(1, 1, 1, 1)
    numbers = table(np.full((HEIGHT, WIDTH, 3), 0.05))
    world.operation("background", [one, world.operation("sky", [world.operation("generated")], floats=numbers), one])
    scene.set_world(world, 64)
    scene.set_camera("PERSPECTIVE", np.eye(4), (-1, -1), (1, 1), 0.1, 10)
    probe = core.LightProbe(scene)
    random = np.random.default_rng(3).random((20_000, 2)).astype(np.float32).clip(0, np.float32(1 - 2**-24))
    samples = probe.sample(np.zeros(3), random)
    radiance, density = probe.look(np.zeros(3), samples["direction"].astype(float))
    is_sampled = samples["density"] > 0.0  # not where it is black
    assert is_sampled.mean() > 0.98 and np.isclose(samples["density"], density, rtol=1e-3)[is_sampled].mean() > 0.999
    in_disc = radiance[:, 0] > 1.0
    sun = 3000.0 / 2.0 + 500.0  # the mean of the brightest channel at both edges
    light_of_sun = sun * 0.8 * np.pi * HALF**2
    shares = radiance[:, 0] / density
    assert shares[in_disc].sum() / len(shares) == pytest.approx(light_of_sun, rel=0.02)
    assert 0.05 < in_disc.mean() < 0.95
