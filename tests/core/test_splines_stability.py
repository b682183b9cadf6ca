"""The Bernstein form and de Casteljau's algorithm, at degrees 1 to 40, against exact arithmetic."""

import mpmath
import numpy as np
import pytest

EPSILON = float(np.finfo(float).eps)


def exact_value(points, t):
    """The curve's point to 50 digits."""
    degree = len(points) - 1
    s = mpmath.mpf(1) - mpmath.mpf(t)
    basis = [mpmath.binomial(degree, i) * s ** (degree - i) * mpmath.mpf(t) ** i for i in range(degree + 1)]
    return [mpmath.fsum(b * mpmath.mpf(p[axis]) for b, p in zip(basis, points, strict=True)) for axis in range(3)]


@pytest.mark.parametrize("degree", [1, 2, 3, 5, 8, 13, 21, 30, 40])
def test_both_ways_to_evaluate_are_stable(core, degree):
    random = np.random.default_rng(degree)
    points = np.hstack([random.uniform(-1, 1, (degree + 1, 3)), np.ones((degree + 1, 1))])
    places = np.concatenate([[0.0, 1.0, 0.5, 1e-9, 1 - 1e-9], random.random(8)])
    curve = core.BezierCurve(points)
    # Each level of either triangle rounds three times; sums of non-negative terms lose no more than this.
    bound = 3 * (degree + 1) * EPSILON
    with mpmath.workdps(50):
        for t, one, other in zip(places, curve.evaluate(places)[:, 0], curve.de_casteljau(places), strict=True):
            exact = exact_value(points, t)
            for values in (one, other):
                assert max(float(abs(mpmath.mpf(v) - e)) for v, e in zip(values, exact, strict=True)) <= bound, t


@pytest.mark.parametrize("degree", [3, 40])
def test_both_ways_agree_for_rational_curves(core, degree):
    random = np.random.default_rng(degree)
    points = np.hstack([random.uniform(-1, 1, (degree + 1, 3)), random.uniform(0.1, 10, (degree + 1, 1))])
    places = np.linspace(0, 1, 33)
    curve = core.BezierCurve(points)
    assert np.allclose(curve.evaluate(places)[:, 0], curve.de_casteljau(places), atol=1e-13)


def test_the_power_form_would_not_be_stable(core):
    # The reason for these algorithms: at degree 30, coefficients of t^k lose 12 digits.
    degree = 30
    points = np.hstack([np.random.default_rng(0).uniform(-1, 1, (degree + 1, 3)), np.ones((degree + 1, 1))])
    with mpmath.workdps(50):
        coefficients = [
            float(
                mpmath.fsum(
                    (-1) ** (k - i) * mpmath.binomial(degree, k) * mpmath.binomial(k, i) * mpmath.mpf(points[i, 0])
                    for i in range(k + 1)
                )
            )
            for k in range(degree + 1)
        ]
        exact = float(exact_value(points, 0.95)[0])
    power = abs(np.polynomial.polynomial.polyval(0.95, coefficients) - exact)
    assert power > 1e4 * abs(core.BezierCurve(points).de_casteljau(np.array([0.95]))[0, 0] - exact) and power > 1e-8
