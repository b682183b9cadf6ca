"""A target in place of a number of samples: reached on scenes of few and of many calm parts, the same for any threads."""

import functools
import time

import numpy as np
import pytest
from core import scenes
from test_adaptive_sampling import half_lit, rendered

MOST = 1 << 14


def shown(session):
    return np.clip(session.pass_pixels("combined")[..., :3].astype(np.float64), 0, 1)


@functools.cache
def converged(core, make=half_lit):
    """Two pictures of other random numbers."""
    return [shown(rendered(core, make(core), samples=2048, seed=seed)) for seed in (11, 12)]


def error_of(core, picture, make=half_lit):
    """The mean product of differences to two pictures: their own noise drops out."""
    others = converged(core, make)
    return float(np.mean((picture - others[0]) * (picture - others[1]))) ** 0.5


@pytest.mark.slow
@pytest.mark.parametrize("target", [0.01, 0.004])
def test_the_error_is_between_half_the_target_and_the_target(core, target):
    session = rendered(core, samples=MOST, target_error=target)
    assert target / 2 < error_of(core, shown(session)) < target
    statistics = session.statistics()
    assert target / 2 < statistics["error"]["noise"] <= target and "target error" not in statistics["left_out"]
    counts = session.pass_pixels("sample_count")
    assert counts[:, 40:].mean() < counts[:, :24].mean()  # where nothing is noisy


def equally_bright(core):
    """A sky of squares much smaller than pixels, red and green ones as bright as each other."""
    program = core.Program("world")
    one, red, green = (program.constant(*color, 1) for color in ((1, 1, 1), (0.8, 0.1, 0.2), (0.1, 0.8, 0.2)))
    checker = program.operation(
        "checker", [program.operation("generated"), red, green, program.constant(*[1234.5] * 4)]
    )
    program.operation("background", [one, checker, one])
    scene = core.SceneDescription()
    scene.set_world(program, 16)
    scenes.look_down(scene)
    return scene


@pytest.mark.slow
def test_colours_are_noise_where_brightness_is_not(core):
    session = rendered(core, equally_bright(core), samples=MOST, target_error=0.02)
    assert session.pass_pixels("sample_count").mean() > 32
    assert 0.01 < error_of(core, shown(session), equally_bright) < 0.02


@pytest.mark.parametrize("changed", [{"threads": 3}, {"tile_size": 7}, {"stream_paths": 33}, {"stream_paths": 0}])
def test_neither_threads_nor_tiles_show(core, changed):
    usual = {"samples": MOST, "target_error": 0.02, "threads": 1, "passes": ["combined", "sample_count", "depth"]}
    one, other = rendered(core, **usual), rendered(core, **{**usual, **changed})
    for name in usual["passes"]:
        assert (one.pass_pixels(name) == other.pass_pixels(name)).all()


def test_each_pixel_is_that_of_a_fixed_number_which_is_a_power_of_two(core):
    session = rendered(core, samples=MOST, target_error=0.004)
    counts = session.pass_pixels("sample_count")[..., 0].astype(int)
    numbers = np.unique(counts)
    assert len(numbers) > 2 and (numbers & (numbers - 1) == 0).all()
    for number in numbers:
        fixed = rendered(core, samples=int(number)).pass_pixels("combined")
        assert fixed[counts == number] == pytest.approx(session.pass_pixels("combined")[counts == number], rel=1e-6)


def test_what_is_brighter_than_a_screen_takes_few_samples(core):
    counts = rendered(core, samples=MOST, target_error=0.005, exposure=1e4).pass_pixels("sample_count")
    assert counts.max() <= 64


def test_a_time_limit_ends_it_too(core):
    began = time.perf_counter()
    counts = rendered(core, samples=1 << 20, target_error=1e-7, time_limit=0.5).pass_pixels("sample_count")
    assert time.perf_counter() - began < 5 and 4 <= counts.min() and counts.max() < 1 << 20


def test_samples_are_the_most_that_are_taken(core):
    counts = rendered(core, samples=20, target_error=1e-6).pass_pixels("sample_count")
    assert counts.max() == 20 and (counts[:, :16] == 20).all()
    assert rendered(core, samples=13, target_error=1e-6).pass_pixels("sample_count").max() == 13


def test_without_a_target_nothing_is_estimated(core):
    statistics = rendered(core, half_lit(core), samples=2).statistics()
    assert statistics["error"] == {} and "target error" in statistics["left_out"]
