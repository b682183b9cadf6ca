"""Ray differentials against finite differences of neighbouring rays at a sphere."""

import numpy as np
import pytest

CENTRE, RADIUS, ETA = np.array([0.1, -0.2, -4.0]), 1.5, 1 / 1.45


def unit(v):
    return v / np.linalg.norm(v)


def camera_direction(x, y):
    return unit(np.array([x, y, -1.0]))


def sphere_hit(direction):
    b = direction @ CENTRE
    t = b - np.sqrt(b * b - CENTRE @ CENTRE + RADIUS**2)
    return t, direction * t, (direction * t - CENTRE) / RADIUS


def reflect(d, n):
    return d - 2 * (d @ n) * n


def refract(d, n):
    cosine = d @ n
    return ETA * d - (ETA * cosine + np.sqrt(1 - ETA**2 * (1 - cosine**2))) * n


def difference(function, x, y, axis, h=1e-5):
    step = np.array([h, 0.0]) if axis == 0 else np.array([0.0, h])
    return (function(x + step[0], y + step[1]) - function(x - step[0], y - step[1])) / (2 * h)


@pytest.mark.parametrize("x,y", [(0.0, 0.0), (0.1, 0.2), (-0.25, 0.1), (0.3, -0.3)])
@pytest.mark.parametrize("kind", ["mirror", "glass"])
def test_differentials_match_neighbouring_rays_at_a_sphere(core, x, y, kind):
    d = camera_direction(x, y)
    t, position, n = sphere_hit(d)
    dd = [difference(camera_direction, x, y, axis) for axis in (0, 1)]
    start = [np.zeros(3), np.zeros(3), *dd]
    at_hit = core.transferred_differential(start, d, t, n)
    dp = [difference(lambda a, b: sphere_hit(camera_direction(a, b))[1], x, y, axis) for axis in (0, 1)]
    # Single precision, and central differences of step 1e-5: three to four figures agree.
    np.testing.assert_allclose(at_hit[:2], dp, rtol=2e-3, atol=1e-3)

    dn = [np.asarray(at_hit[axis]) / RADIUS for axis in (0, 1)]
    if kind == "mirror":
        after = core.reflected_differential(at_hit, d, n, *dn)
        bend = reflect
    else:
        after = core.refracted_differential(at_hit, d, n, *dn, ETA)
        bend = refract

    def direction_after(a, b):
        incoming = camera_direction(a, b)
        return bend(incoming, sphere_hit(incoming)[2])

    expected = [difference(direction_after, x, y, axis) for axis in (0, 1)]
    np.testing.assert_allclose(after[2:], expected, rtol=2e-3, atol=2e-3)
