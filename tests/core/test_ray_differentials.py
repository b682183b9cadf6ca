"""Ray differentials against finite differences of neighbouring rays at a sphere."""

import numpy as np
import pytest
from core import shapes
from rayleaf._core import distribution

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


@pytest.mark.parametrize("kind", ["mirror", "glass"])
def test_differentials_at_traced_splines_match_neighbouring_rays_by_the_surface_s_own_curvature(core, kind):
    eta = 1.0 if kind == "mirror" else ETA
    tracer = shapes.trace.Tracer([(shapes.lumpy_torus(), np.eye(4), shapes.EVERYTHING)])
    eye, step = np.array([0.0, -2.0, 3.0]), 5e-4
    forward = unit(-eye)
    right = np.array([1.0, 0.0, 0.0])
    up = np.cross(right, forward)
    random = np.random.default_rng(6)
    places = random.uniform(-0.3, 0.3, (60, 2))

    def seen(at):
        rays = forward + at[:, :1] * right + at[:, 1:] * up
        rays /= np.linalg.norm(rays, axis=1)[:, None]
        hits = tracer.closest_hits(np.broadcast_to(eye, rays.shape).copy(), rays)
        normal = hits["normal"].astype(float)
        normal *= -np.sign(np.sum(normal * rays, axis=1))[:, None]
        after = np.array([reflect(d, n) if kind == "mirror" else refract(d, n) for d, n in zip(rays, normal)])
        return hits, rays, normal, after

    hits, rays, normal, after = seen(places)
    beside = [[seen(places + side * step * np.eye(2)[axis]) for side in (1, -1)] for axis in (0, 1)]
    facing = np.sum(normal * rays, axis=1) < -0.3  # silhouettes have no neighbours
    compared = 0
    for i in np.flatnonzero((hits["instance"] >= 0) & facing):
        around = [
            each[0]["instance"][i] >= 0 and abs(each[0]["t"][i] - hits["t"][i]) < 0.01
            for pair in beside
            for each in pair
        ]
        if not all(around):
            continue
        change = lambda k: [(plus[k][i] - minus[k][i]) / (2 * step) for plus, minus in beside]
        at_hit = core.transferred_differential([np.zeros(3)] * 2 + change(1), rays[i], hits["t"][i], normal[i])
        by_parameters = hits["derivatives"][i].reshape(4, 3).astype(float)
        by_parameters[2:] *= np.sign(hits["normal"][i] @ normal[i])
        rows = distribution.glossy_differential(at_hit, rays[i], [normal[i], *by_parameters], after[i], 0.0, eta, 1)
        # Neighbours' normals are in single precision, a thousandth apart; second differences of lumps remain.
        scale = np.abs(change(3)).max()
        np.testing.assert_allclose(rows[2:], change(3), rtol=0.02, atol=0.01 * scale, err_msg=f"{places[i]!r}")
        compared += 1
    assert compared > 25
