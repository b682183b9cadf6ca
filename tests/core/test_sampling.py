"""Random numbers and the pixel filter."""

import itertools

import pair_matrices
import numpy as np
import pytest
from rayleaf._core import trace as core_trace


@pytest.mark.parametrize("pixel,dimension", [(0, 0), (12345, 17), (2**31, 400)])
def test_every_elementary_interval_holds_one_sample(core, pixel, dimension):
    """A (0, 2)-sequence in base 2: 64 points, one in each box of 2^-a by 2^-(6-a), for every a."""
    pairs = core.sampler_pairs(pixel, 64, dimension)
    for a in range(7):
        cells = np.floor(pairs * [2**a, 2 ** (6 - a)]).astype(int)
        index = cells[:, 0] * 2 ** (6 - a) + cells[:, 1]
        assert sorted(index) == list(range(64)), f"pixel {pixel} dimension {dimension} split {a}"


def is_even(numbers, digits):
    """Whether elementary intervals of so many digits in each number hold as many samples each."""
    cells = np.floor(numbers * np.exp2(digits)).astype(int)
    index = np.ravel_multi_index(cells.T, [2**d for d in digits])
    return len(set(np.bincount(index, minlength=2 ** sum(digits)))) == 1


def are_even_together(core, pixel, dimensions):
    """Whether two pairs are spread evenly together, in all intervals of up to five digits."""
    numbers = np.hstack([core.sampler_pairs(pixel, 512, dimension) for dimension in dimensions])
    shapes = [shape for digits in range(2, 6) for shape in pair_matrices.intervals(digits, 4)]
    return all(is_even(numbers, shape) for shape in shapes)


def test_the_first_pairs_are_spread_evenly_together(core):
    for pixel in (0, 12345):
        for first, second in itertools.combinations(range(len(pair_matrices.ORDER)), 2):
            assert are_even_together(core, pixel, (first, second)), (first, second)


def test_later_pairs_meet_at_random(core):
    first_apart = len(pair_matrices.ORDER)
    assert not any(
        are_even_together(core, pixel, (first, first_apart)) for pixel in (0, 12345) for first in range(first_apart)
    )


def test_numbers_lie_in_the_half_open_unit_square(core):
    pairs = np.concatenate([core.sampler_pairs(p, 256, d) for p in range(20) for d in range(20)])
    assert pairs.min() >= 0.0 and pairs.max() < 1.0


def test_dimensions_and_pixels_are_uncorrelated(core):
    columns = [core.sampler_pairs(p, 4096, d)[:, k] for p in (1, 2) for d in (0, 1, 2) for k in (0, 1)]
    correlation = np.corrcoef(columns) - np.eye(len(columns))
    # Of 4096 independent pairs the correlation has a standard deviation of 1/64; 66 pairs stay below 5 of them.
    assert np.abs(correlation).max() < 5 / 64


def test_a_seed_changes_the_numbers_and_equal_arguments_give_equal_numbers(core):
    assert np.array_equal(core.sampler_pairs(7, 32, 3, 1), core.sampler_pairs(7, 32, 3, 1))
    assert not np.array_equal(core.sampler_pairs(7, 32, 3, 1), core.sampler_pairs(7, 32, 3, 2))


def blackman_harris(x):
    phase = np.pi * (x + 1)
    return 0.35875 - 0.48829 * np.cos(phase) + 0.14128 * np.cos(2 * phase) - 0.01168 * np.cos(3 * phase)


def gaussian(x):
    return np.exp(-18 * x * x)


@pytest.mark.parametrize(
    "name,shape,support", [("BOX", np.ones_like, 1), ("BLACKMAN_HARRIS", blackman_harris, 2), ("GAUSSIAN", gaussian, 3)]
)
def test_offsets_follow_the_filter(core, name, shape, support):
    width, bins = 3.0, 20
    random = (np.arange(20000) + 0.5)[:, None] / 20000 * np.ones(2)
    offsets = core.filter_offsets(getattr(core.PixelFilterKind, name), width, random.astype(np.float32))[:, 0]
    counts = np.histogram(offsets, bins, (-support * width / 2, support * width / 2))[0] / 20000
    fine = shape(np.linspace(-1, 1, bins * 100 + 1)[:-1] + 1 / (bins * 100)).reshape(bins, 100).mean(1)
    # The table has 256 entries, so a bin's share is right to about a table step.
    assert np.abs(counts - fine / fine.sum()).max() < 1.5 / 256


def test_a_filter_of_no_width_puts_samples_at_the_centre(core):
    offsets = core.filter_offsets(core.PixelFilterKind.BLACKMAN_HARRIS, 0.0, np.random.rand(10, 2).astype(np.float32))
    assert np.all(offsets == 0.0)


@pytest.mark.parametrize("target", core_trace.simd_targets())
def test_numbers_that_are_computed_together_have_the_bits_of_single_ones(core, target, any_target):
    assert core_trace.use_simd_target(target)
    for pixel, dimension, seed in ((0, 0, 0), (7, 5, 1), (12345, 17, 3), (2**31 + 5, 0x40000011, 2**32 - 1)):
        alone = core.sampler_pairs(pixel, 300, dimension, seed)
        for together in (2, 15, 16, 17, 128):
            np.testing.assert_array_equal(core.sampler_pairs(pixel, 300, dimension, seed, together=together), alone)
