"""What tracking takes a medium to be within a cell of its bounds: against the slow twin, on all instruction sets."""

import numpy as np
import pytest
from scipy.interpolate import RegularGridInterpolator
from path_scenes import picture
from test_media import in_front_of_the_world, uneven

STEPS = 3


def points(function):
    """Of a cell, x fastest."""
    z, y, x = np.meshgrid(*[np.arange(STEPS + 1.0)] * 3, indexing="ij")
    return function(x, y, z)


def rays(count):
    """From one place of a cell to another, in eight pieces."""
    rng = np.random.default_rng(5)
    for begin, end in rng.uniform(0, STEPS, (count, 2, 3)):
        yield begin, (end - begin) / 8
    yield np.zeros(3), np.full(3, STEPS / 8)
    yield np.full(3, STEPS), np.full(3, -STEPS / 8)


@pytest.mark.parametrize("seed", range(3))
def test_pieces_are_the_trilinear_values_in_their_middles(core, seed, any_target):
    found = np.random.default_rng(seed).uniform(0.5, 3.0, (STEPS + 1,) * 3).astype(np.float32)
    axis = np.arange(STEPS + 1.0)
    twin = RegularGridInterpolator((axis,) * 3, found)
    least_share = 0.5 / 255 * np.ptp(found)
    for begin, step in rays(50):
        middles = begin + step * (np.arange(8) + 0.5)[:, None]
        results = []
        for target in core.trace.simd_targets():
            assert core.trace.use_simd_target(target)
            results.append(core.densities_along(found.ravel(), begin, step))
            np.testing.assert_array_equal(results[-1], results[0], err_msg=target)
        np.testing.assert_allclose(results[0][:, 0], twin(middles[:, ::-1]), rtol=1e-5, atol=least_share * 1.001)


def test_bounds_of_a_piece_hold_the_densities_around_it(core):
    """Of a wave that the points follow."""

    def wave(x, y, z):
        return 1.5 + np.sin(0.9 * x + 0.5 * y) * np.cos(0.7 * z)

    found = points(wave).astype(np.float32).ravel()
    for begin, step in rays(50):
        places = begin + step * np.linspace(0, 8, 65)[:, None]
        mean, majorant, certain, residual = core.densities_along(found, begin, step).repeat(8, axis=0).T
        density = wave(*places[:-1].T)
        assert (density <= majorant + 0.05).all() and (density >= certain - 0.05).all()
        assert (np.abs(density - mean) <= residual + 0.05).all()
        assert (residual < 0.9 * np.ptp(found)).all()


@pytest.mark.parametrize("size", [1e-43, 1e-38, 1e34])
def test_densities_of_any_size_make_numbers(core, size):
    found = (points(lambda x, y, z: x + y + z + 1.0) * size).astype(np.float32).ravel()
    along = core.densities_along(found, np.zeros(3), np.full(3, STEPS / 8))
    assert np.isfinite(along).all() and along.max() > 0.0


def test_what_the_points_hardly_tell_apart_has_no_detail(core):
    assert core.densities_along(np.zeros(64, np.float32), np.zeros(3), np.ones(3)) is None
    assert core.densities_along(np.ones(64, np.float32), np.zeros(3), np.ones(3)) is None


@pytest.mark.slow
@pytest.mark.parametrize("kind, limit", [("slope", 0.03), ("layers", 0.11)])
def test_what_a_medium_absorbs_of_camera_rays_has_little_noise(core, kind, limit):
    """Standard deviation of a pixel of one sample. Layers are as thick as cells: without their detail it is 0.14."""
    program, _ = uneven(core, kind, "volume_absorption", (0.0, 0.0, 0.0))
    scene = in_front_of_the_world(core, program)
    images = [picture(core, scene, samples=1, size=8, seed=seed) for seed in range(40)]
    assert np.std(images, axis=0).mean() < limit


@pytest.mark.slow
def test_light_of_fire_is_sampled_evenly(core):
    """Standard deviation of a pixel of 16 samples: with numbers that are not spread over these it is 0.08."""
    program, _ = uneven(core, "slope", "volume_absorption", (0.3, 0.3, 0.3))
    height = program.operation("component", [program.operation("generated")], [2])
    program.operation("emission", [program.constant(1, 1, 1, 1), program.constant(1.0, 0.5, 0.2, 1), height])
    scene = in_front_of_the_world(core, program, world=(0, 0, 0))
    images = [picture(core, scene, samples=16, size=8, seed=seed) for seed in range(20)]
    assert np.std(images, axis=0).mean() < 0.04
