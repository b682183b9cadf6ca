"""What counts as the same picture."""

import numpy as np
import pytest
from golden.golden import PIXELS_OUTSIDE, Comparison

REFERENCE = np.random.default_rng(7).uniform(0, 1.5, (60, 80, 3)).astype(np.float32)


def verdict_of(new):
    return Comparison("a picture", new, REFERENCE).verdict


def test_the_same_picture_passes():
    assert verdict_of(REFERENCE.copy()) == ""


def test_a_few_other_pixels_pass_and_many_do_not():
    for share, passes in ((0.5 * PIXELS_OUTSIDE, True), (2 * PIXELS_OUTSIDE, False)):
        new = REFERENCE.copy()
        flat = new.reshape(-1, 3)
        changed = np.arange(int(share * len(flat))) * 7
        flat[changed] = 1.5 - flat[changed]
        assert (verdict_of(new) == "") == passes, share


@pytest.mark.parametrize("factor", [0.99, 1.01])
def test_a_picture_that_is_a_little_darker_or_brighter_does_not_pass(factor):
    assert "mean" in verdict_of(REFERENCE * np.float32(factor))


def test_a_picture_of_another_size_or_with_nan_does_not_pass():
    broken = REFERENCE.copy()
    broken[3, 4, 1] = np.nan
    assert "no numbers" in verdict_of(broken)
    assert "size" in verdict_of(REFERENCE[1:])
