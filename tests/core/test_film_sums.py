"""Parts of a picture, other pixels or other samples, put together: the same bits as all at once."""

from fractions import Fraction

import numpy as np
import pytest
import scenes
from hypothesis import given
from hypothesis import strategies as st
from test_session import ALL_PASSES

WIDTH, HEIGHT, SAMPLES = 19, 13, 21
LARGEST = float(np.finfo(np.float32).max)


def settings(core, **more):
    return core.Settings(**(dict(width=WIDTH, height=HEIGHT, samples=SAMPLES, passes=ALL_PASSES) | more))


def rendered(core, scene, **more):
    session = core.Session(scene, settings(core, **more))
    assert session.render()
    return session


def assert_same(whole, merged, passes=ALL_PASSES):
    for name in passes:
        assert np.array_equal(merged.pass_pixels(name), whole.pass_pixels(name)), name


@pytest.mark.parametrize("stream_paths", [512, 0])
def test_ranges_of_samples_put_together_in_any_order_are_the_whole_to_the_bit(core, stream_paths):
    scene = scenes.small_scene(core)
    whole = rendered(core, scene, stream_paths=stream_paths)
    merged = core.FilmSums(WIDTH, HEIGHT, ALL_PASSES)
    for first, count in ((8, 12), (20, 1), (0, 1), (1, 7)):
        part = rendered(
            core, scene, stream_paths=stream_paths, first_sample=first, sample_count=count, keep_sums=True, threads=2
        )
        merged.add(0, 0, count, part.sums())
    assert merged.samples() == (SAMPLES, SAMPLES)
    assert_same(whole, merged)


def test_parts_of_the_picture_and_of_its_samples_together_are_the_whole(core):
    scene = scenes.small_scene(core)
    whole = rendered(core, scene)
    merged = core.FilmSums(WIDTH, HEIGHT, ALL_PASSES)
    for x, y, width, height in ((0, 0, 19, 4), (0, 4, 7, 9), (7, 4, 12, 9)):
        for first, count in ((0, 9), (9, 0)):  # 0: all from there on
            part = rendered(
                core, scene, part_x=x, part_y=y, part_width=width, part_height=height,
                first_sample=first, sample_count=count, keep_sums=True, tile_size=5,
            )  # fmt: skip
            assert part.pass_pixels("combined").shape == (height, width, 4)
            merged.add(x, y, count or SAMPLES - first, part.sums())
    assert merged.samples() == (SAMPLES, SAMPLES)
    assert_same(whole, merged)


def test_a_part_uses_the_irradiance_cache_of_the_whole_picture(core):
    scene = scenes.small_scene(core)
    more = dict(integrator="DISTRIBUTION", irradiance_cache=True, samples=2, hemisphere_rays=4)
    whole = rendered(core, scene, **more)
    part = rendered(core, scene, part_x=3, part_y=5, part_width=8, part_height=6, **more)
    assert whole.statistics()["hemispheres"]["records"] > 10
    for name in ALL_PASSES:
        assert np.array_equal(part.pass_pixels(name), whole.pass_pixels(name)[5:11, 3:11]), name


def test_a_part_lies_inside_the_crop(core):
    scene = scenes.small_scene(core)
    crop = dict(crop_x=4, crop_y=2, crop_width=10, crop_height=8)
    whole = rendered(core, scene, **crop).pass_pixels("combined")
    part = rendered(core, scene, part_x=6, part_y=3, part_width=5, part_height=4, **crop).pass_pixels("combined")
    assert np.array_equal(part, whole[1:5, 2:7])
    with pytest.raises(core.InputError, match="part x is 3"):
        core.Session(scene, settings(core, part_x=3, part_y=3, part_width=5, part_height=4, **crop))
    with pytest.raises(core.InputError, match="part width is 9"):
        core.Session(scene, settings(core, part_x=6, part_y=3, part_width=9, part_height=4, **crop))


@pytest.mark.parametrize(("name", "value"), [("first_sample", SAMPLES), ("sample_count", SAMPLES + 1)])
def test_samples_beyond_the_last_are_refused(core, name, value):
    with pytest.raises(core.InputError, match=name.replace("_", " ")):
        core.Session(scenes.small_scene(core), settings(core, **{name: value}))


def test_sums_are_kept_where_they_are_asked_for(core):
    session = rendered(core, scenes.small_scene(core), samples=1)
    with pytest.raises(core.InputError, match="keep_sums"):
        session.sums()


FLOATS = st.floats(width=32, allow_nan=False, allow_infinity=False)


@given(st.lists(FLOATS, min_size=1, max_size=40), st.integers(1, 7))
def test_sums_are_exact_whatever_is_added_in_whatever_parts(core, values, size):
    """By rational numbers."""
    film = core.FilmSums(1, 1, ["emission"])
    for start in range(0, len(values), size):
        part = np.zeros((1, 1, 3, 8))
        chosen = values[start : start + size]
        part[0, 0, 1, : len(chosen)] = chosen
        film.add(0, 0, len(chosen), {"emission": part})
    total = sum(map(Fraction, values)) / len(values)
    found = film.pass_pixels("emission")[0, 0]
    assert found[0] == found[2] == 0.0
    # Rounded to a double, divided, and rounded to a float: within a bit of the true mean.
    assert abs(Fraction(float(found[1])) - total) <= abs(total) * Fraction(1, 2**23) + Fraction(1, 2**149)


def test_what_cancels_leaves_the_small_rest(core):
    film = core.FilmSums(1, 1, ["emission"])
    for value in (LARGEST, 1e-45, LARGEST, -LARGEST, 2.5, -LARGEST):
        film.add(0, 0, 1, {"emission": np.full((1, 1, 3, 1), np.float32(value), np.float64)})
    assert film.pass_pixels("emission")[0, 0, 0] == np.float32(2.5 / 6)
    film = core.FilmSums(1, 1, ["emission"])
    terms = np.array([LARGEST, np.float32(1e-45), -LARGEST, 0.0])
    film.add(0, 0, 1, {"emission": np.tile(terms, (1, 1, 3, 1))})
    assert film.pass_pixels("emission")[0, 0, 0] == np.float32(1e-45) > 0.0


@pytest.mark.parametrize(
    ("change", "complaint"),
    [
        (dict(sums={}), "without emission"),
        (dict(samples=0), "samples is 0"),
        (dict(x=2), "2 x 3 pixels at 2, 0"),
        (dict(x=2**31 - 1), "pixels at 2147483647, 0"),
        (dict(sums={"emission": np.zeros((3, 2, 4, 1))}), r"shape \(3, 2, 4, 1\)"),
        (dict(sums={"emission": np.zeros((3, 2, 3, 9))}), "9 terms"),
        (dict(sums={"emission": np.full((3, 2, 3, 1), np.nan)}), "nan"),
        (dict(sums={"emission": np.full((3, 2, 3, 1), 1e300)}), "1e\\+300"),
        (dict(sums={"emission": np.full((3, 2, 3, 1), 1e-300)}), "1e-300"),
    ],
)
def test_sums_that_cannot_be_are_refused(core, change, complaint):
    film = core.FilmSums(3, 3, ["emission"])
    with pytest.raises(core.InputError, match=complaint):
        film.add(**(dict(x=0, y=0, samples=1, sums={"emission": np.zeros((3, 2, 3, 1))}) | change))


def test_a_film_without_pixels_or_with_unknown_passes_is_refused(core):
    with pytest.raises(core.InputError, match="size is 0 x 4"):
        core.FilmSums(0, 4, [])
    with pytest.raises(core.InputError, match="'light'"):
        core.FilmSums(4, 4, ["light"])
    with pytest.raises(core.InputError, match="'depth'"):
        core.FilmSums(4, 4, ["combined"]).pass_pixels("depth")
