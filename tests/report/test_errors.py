"""The report's error measures, against numbers that can be worked out by hand."""

import numpy as np
import pytest
from rayleaf.report.errors import compare, silhouette_error
from rayleaf.report.frontier import Cost, cheapest_within, dominated


def flat(value, size=16):
    return np.full((size, size, 4), value, dtype=np.float32)


def test_equal_pictures_have_no_error():
    random = np.random.default_rng(1).random((20, 30, 4))
    error = compare(random, random)
    assert (error.mean_rgb, error.rmse, error.p99, error.maximum) == (0.0, 0.0, 0.0, 0.0)
    assert error.ssim == pytest.approx(1.0)


def test_black_against_white_is_the_largest_error_there_is():
    error = compare(flat(0.0), flat(1.0))
    assert error.mean_rgb == pytest.approx(np.sqrt(3.0))
    assert error.rmse == pytest.approx(1.0)
    assert error.ssim < 0.01


def test_one_wrong_pixel_shows_in_the_maximum_and_not_in_the_percentile():
    wrong = flat(0.5)
    wrong[3, 4, 0] = 1.0
    error = compare(wrong, flat(0.5))
    assert error.maximum == pytest.approx(0.5)
    assert error.p99 == 0.0
    assert error.mean_rgb == pytest.approx(0.5 / 256)


def test_what_no_screen_shows_does_not_count():
    assert compare(flat(7.0), flat(1.0)).rmse == 0.0
    assert compare(flat(-2.0), flat(0.0)).rmse == 0.0


def test_a_picture_with_nan_is_refused():
    broken = flat(0.5)
    broken[0, 0, 1] = np.nan
    with pytest.raises(ValueError, match="NaN"):
        compare(broken, flat(0.5))
    with pytest.raises(ValueError, match="shapes"):
        compare(flat(0.5, 8), flat(0.5, 16))


def disk(radius, size=200, oversampling=4):
    place = (np.arange(size * oversampling) + 0.5) / oversampling - size / 2
    inside = (place[:, None] ** 2 + place[None, :] ** 2 < radius**2).astype(float)
    return inside.reshape(size, oversampling, size, oversampling).mean(axis=(1, 3))


@pytest.mark.parametrize("shift", [0.25, 1.0, 3.0])
def test_a_disk_that_is_too_large_is_off_by_its_excess_of_radius(shift):
    # The area of the ring over the outline of the inner disk is shift * (1 + shift / 2r); the outline of a sampled disk
    # is measured some per cent too long or short.
    expected = shift * (1 + shift / 120)
    assert silhouette_error(disk(60 + shift), disk(60)) == pytest.approx(expected, rel=0.1)


def test_a_mask_without_an_outline_has_no_silhouette_error():
    with pytest.raises(ValueError, match="no outline"):
        silhouette_error(np.ones((8, 8)), np.ones((8, 8)))


def test_a_setting_is_beaten_by_one_that_is_surely_faster_and_not_farther_off():
    points = [Cost(1.0, 1.1, 0.5), Cost(2.0, 2.1, 0.6), Cost(3.0, 3.1, 0.1), Cost(1.05, 1.2, 0.5)]
    assert dominated(points) == [None, 0, None, None]


def test_the_cheapest_setting_within_an_error_is_found_or_none_is():
    points = [Cost(1.0, 1.1, 0.5), Cost(2.0, 2.1, 0.2), Cost(3.0, 3.1, 0.1)]
    assert cheapest_within(points, 0.3) == 1
    assert cheapest_within(points, 0.01) is None
