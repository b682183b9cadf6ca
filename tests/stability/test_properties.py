"""Properties of whatever hypothesis draws: patches, places, rays, materials. What it finds is kept as an example here."""

import numpy as np
import path_scenes
import scenes
from core import shapes
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

QUIET = settings(max_examples=60, deadline=None, suppress_health_check=list(HealthCheck))
coordinate = st.floats(-1e3, 1e3, allow_nan=False, width=32)
weight = st.floats(1e-6, 1e6, allow_nan=False)
order = st.integers(2, 6)


@st.composite
def drawn_patch(draw):
    """Control points of one patch, degenerate ones too: coordinates are drawn from a few values."""
    count_u, count_v = draw(order), draw(order)
    few = draw(st.lists(coordinate, min_size=1, max_size=4))
    number = count_u * count_v * 3
    places = draw(st.lists(st.sampled_from(few) | coordinate, min_size=number, max_size=number))
    points = np.ones((count_v, count_u, 4))
    points[..., :3] = np.reshape(places, (count_v, count_u, 3))
    if draw(st.booleans()):
        drawn = draw(st.lists(weight, min_size=count_u * count_v, max_size=count_u * count_v))
        points[..., 3] = np.reshape(drawn, (count_v, count_u))
    return points


def surface_of(points):
    count_v, count_u, _ = points.shape
    clamped = (False, True, False)
    return shapes.trace.PatchSurface("drawn", [(points, (count_u, *clamped), (count_v, *clamped), True, 0)])


def rays_at(points, seed):
    """Rays from outside towards points of the patch's hull."""
    random = np.random.default_rng(seed)
    flat = points[..., :3].reshape(-1, 3)
    size = max(float(np.ptp(flat, axis=0).max()), 1e-3)
    shares = random.dirichlet(np.ones(len(flat)), 64)
    origins = flat.mean(axis=0) + 3 * size * shapes.random_directions(random, 64)
    return origins, shapes.unit(shares @ flat - origins)


def one_corner_pulled_out():
    """A patch on a line."""
    points = np.zeros((2, 2, 4))
    points[..., 3] = 1.0
    points[1, 1, :3] = 0, 1, 3
    return points


@QUIET
@given(
    points=drawn_patch(),
    seed=st.integers(0, 2**31),
    exponent=st.integers(-6, 6),
    offset=st.sampled_from([0, 1e3, 1e6]),
)
@example(points=np.ones((2, 2, 4)), seed=0, exponent=0, offset=0.0)
@example(points=one_corner_pulled_out(), seed=0, exponent=0, offset=0.0)  # facets without area were hit: normal NaN
def test_a_hit_is_finite_lies_on_the_ray_and_its_normal_is_unit(points, seed, exponent, offset):
    origins, directions = rays_at(points, seed)
    scale = 10.0**exponent
    tracer = shapes.trace.Tracer([(surface_of(points), shapes.moved(offset, scale), shapes.EVERYTHING)])
    origins = origins * scale + offset
    hits = tracer.closest_hits(origins, directions)
    on = hits["instance"] >= 0
    for name in ("position", "normal", "facet_normal", "start_offset", "facet_position", "derivatives"):
        assert np.isfinite(hits[name]).all(), name
    length = np.linalg.norm(hits["normal"][on], axis=1)
    np.testing.assert_allclose(length, 1.0, atol=1e-5)
    # Where facets are slivers, as thin as single precision's rounding, which of them along the sliver is met has no
    # answer: hits there may lie along it by its length.
    by_u, by_v = hits["derivatives"][:, 0].astype(float), hits["derivatives"][:, 1].astype(float)
    longest = np.maximum(np.linalg.norm(by_u, axis=1), np.linalg.norm(by_v, axis=1))
    on &= np.linalg.norm(np.cross(by_u, by_v), axis=1) > 1e-3 * longest**2
    # The facet's point is where the ray is at t, to the rounding of both.
    ahead = origins[on] + hits["t"][on, None] * directions[on]
    size = np.abs(origins).max() + np.abs(hits["t"][on]).max(initial=0.0)
    assert np.abs(ahead - hits["facet_position"][on]).max(initial=0.0) <= 1e-6 * size
    same = tracer.closest_hits(origins, directions)
    np.testing.assert_array_equal(hits["t"], same["t"])
    np.testing.assert_array_equal(hits["instance"] >= 0, tracer.occluded(origins, directions))


share = st.floats(0.0, 1.0, width=32)
strange = st.sampled_from([0.0, 1e-30, 1e-6, 0.5, 1.0, 1.5, 10.0, 1e6, -1.0])


@QUIET
@given(
    color=st.tuples(share, share, share),
    roughness=st.sampled_from([0.0, 1e-7, 1e-3, 0.3, 1.0]),
    ior=strange,
    kind=st.sampled_from(["diffuse", "glossy", "glass", "refraction", "translucent"]),
    size=st.sampled_from([1e-6, 1.0, 1e6]),
    power=st.sampled_from([0.0, 1e-9, 1.0, 1e9]),
    seed=st.integers(0, 1000),
)
def test_no_material_and_no_lamp_makes_nan_or_negative_light(core, color, roughness, ior, kind, size, power, seed):
    closures = {
        "diffuse": ("diffuse", 1.0, color),
        "translucent": ("translucent", 1.0, color),
        "glossy": ("glossy", 1.0, color, roughness, "GGX"),
        "glass": ("glass", 1.0, color, roughness, ior, "GGX"),
        "refraction": ("refraction", 1.0, color, roughness, ior, "GGX"),
    }
    scene = core.SceneDescription()
    drawn = path_scenes.material(core, scene, closures[kind])
    ball = scene.add_surface("ball", [scenes.sphere_spline(core)])
    scene.add_instance("ball", ball, scenes.matrix((0, 0, 0), size), drawn)
    scene.add_lamp("lamp", "POINT", scenes.matrix((2 * size, size, 3 * size)), (power,) * 3, radius=0.01 * size)
    scene.set_world(scenes.background(core, (0.5, 0.6, 0.7)))
    scene.set_camera("PERSPECTIVE", scenes.matrix((0, 0, 4 * size)), (-0.4, -0.4), (0.4, 0.4), 0.01 * size, 100 * size)
    light = scenes.render(core, scene, width=6, height=6, samples=4, seed=seed, clamp_indirect=0.0)["combined"]
    assert np.isfinite(light).all()
    assert (light >= 0).all()
    # Nothing shines of itself: no more than the lamp's irradiance or the world, over any lobe, could have brought but
    # for a mirrored lamp, whose radiance is P / (4 pi^2 r^2).
    brightest = 1.0 + power / (4 * np.pi**2 * (0.01 * size) ** 2)
    assert light[..., :3].max() <= 2 * brightest
