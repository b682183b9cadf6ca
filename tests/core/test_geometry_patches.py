"""Surfaces of patches: exact positions, normals and derivatives at hits, and invalid input."""

import numpy as np
import pytest
from core import shapes
from rayleaf import _core

trace = shapes.trace


def hits_from(origin, shape, count=5000, matrix=None):
    directions = shapes.random_directions(np.random.default_rng(51), count)
    tracer = trace.Tracer([(shape, np.eye(4) if matrix is None else matrix, 31)])
    origins = np.broadcast_to(np.asarray(origin, float), directions.shape)
    return tracer.closest_hits(origins, directions)


def test_hits_on_a_nurbs_sphere_lie_exactly_on_the_sphere():
    hits = hits_from([0.1, 0.2, -0.1], shapes.nurbs_sphere())
    assert (hits["instance"] == 0).all()
    # The weights are sqrt(1/2) in double; conversion and evaluation round a few times.
    np.testing.assert_allclose(np.linalg.norm(hits["position"], axis=1), 1.0, atol=1e-13)
    np.testing.assert_allclose(hits["normal"], hits["position"], atol=2e-6)  # 1e-7 in float, more next to the poles


def test_curvature_of_a_sphere_is_one_in_every_direction():
    hits = hits_from([0, 0, 0], shapes.nurbs_sphere())
    away = np.abs(hits["position"][:, 2]) < 0.99
    dp, dn = hits["derivatives"][away, :2], hits["derivatives"][away, 2:]
    np.testing.assert_allclose(dn, dp, rtol=1e-4, atol=1e-4 * np.abs(dp).max())


def test_normals_at_the_pole_are_those_of_the_sphere():
    tracer = trace.Tracer([(shapes.nurbs_sphere(), np.eye(4), 31)])
    angle = np.linspace(0, 2 * np.pi, 40)
    directions = shapes.unit(np.column_stack([1e-9 * np.cos(angle), 1e-9 * np.sin(angle), np.ones(40)]))
    for sign in (1.0, -1.0):
        hits = tracer.closest_hits(np.zeros((40, 3)), directions * [1, 1, sign])
        np.testing.assert_allclose(hits["normal"], np.broadcast_to([0, 0, sign], (40, 3)), atol=1e-3)
        assert np.isfinite(hits["derivatives"]).all()


def test_a_torus_faces_outwards_as_blenders_does():
    hits = hits_from([0.75, 0, 0], shapes.nurbs_torus())
    ring = np.column_stack([0.75 * shapes.unit(hits["position"][:, :2]), np.zeros(len(hits["t"]))])
    np.testing.assert_allclose(hits["normal"], shapes.unit(hits["position"] - ring), atol=2e-6)


def test_texture_coordinates_run_over_the_whole_spline():
    hits = hits_from([0.75, 0, 0], shapes.nurbs_torus(), 20000)
    uv = hits["uv"]
    assert uv.min() >= 0 and uv.max() <= 1 and uv.max(axis=0).min() > 0.9 and uv.min(axis=0).max() < 0.1
    # The second coordinate starts at -y and runs against the clock; a quarter of it is a quarter turn.
    angle = np.arctan2(hits["position"][:, 1], hits["position"][:, 0])
    turns = ((-np.pi / 2 - angle) % (2 * np.pi)) / (np.pi / 2)
    inside = np.abs(turns - np.round(turns)) > 1e-3
    np.testing.assert_array_equal(np.floor(4 * uv[inside, 1]), np.floor(turns[inside]))


def test_flat_shaded_splines_have_the_normals_of_their_facets():
    hits = hits_from([0, 0, 0], shapes.nurbs_sphere(smooth=False))
    np.testing.assert_allclose(hits["normal"], hits["facet_normal"], atol=1e-6)
    np.testing.assert_array_equal(hits["derivatives"][:, 2:], 0.0)


@pytest.mark.parametrize(
    "value,column,words", [(np.nan, 0, "points"), (np.inf, 2, "points"), (0.0, 3, "weight"), (-1.0, 3, "weight")]
)
def test_bad_control_points_are_refused_with_the_objects_name(value, column, words):
    points = np.random.default_rng(52).uniform(0.1, 1, (4, 4, 4))
    points[1, 2, column] = value
    with pytest.raises(_core.InputError) as error:
        trace.PatchSurface("Hull", [(points, (4, False, True, False), (4, False, True, False), True, 0)])
    assert "'Hull'" in str(error.value) and words in str(error.value)


def test_a_spline_that_blender_draws_nothing_for_leaves_the_others():
    points = np.random.default_rng(53).uniform(0.1, 1, (4, 4, 4))
    clamped = (4, False, True, False)
    short = (points[:, :2].copy(), clamped, clamped, True, 0)  # two points cannot make a cubic
    surface = trace.PatchSurface("Hull", [short, (points, clamped, clamped, True, 0)])
    assert surface.element_count == 1
    assert trace.PatchSurface("Hull", [short]).element_count == 0


def two_sheets(turned):
    """Two splines of one object that share the control points of a border; the second bends far more along it."""
    net = np.ones((4, 7, 4))
    net[..., 0], net[..., 1] = np.meshgrid(np.linspace(-1, 1, 7), np.linspace(-1, 1, 4))
    wave = 0.3 * np.array([[0], [1], [-1], [0]])
    net[..., 0] += 2 * wave
    net[..., 2] = wave
    first, second = net[:, :4].copy(), net[:, 3:].copy()
    second[1:3, 1:, 2] += 4 * np.array([[1], [-1]])
    direction = (4, False, True, False)
    if turned:  # the shared border runs along u of the second, from its other end
        second = second.transpose(1, 0, 2)[:, ::-1].copy()
    splines = [(first, direction, direction, True, 0), (second, direction, direction, True, 0)]
    return shapes.trace.PatchSurface("sheets", splines), first[:, 3, :3]


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("resident", [0.0, 1000.0])
@pytest.mark.parametrize("pixel", [1e-2, 1e-3, 1e-4])
def test_splines_that_share_control_points_leave_no_gap(pixel, resident, turned):
    surface, border = two_sheets(turned)
    eye = (0.0, 0.0, 9.0)
    cache = shapes.trace.GeometryCacheSettings(resident_megabytes=resident)
    tracer = shapes.trace.Tracer([(surface, np.eye(4), shapes.EVERYTHING)], pixel_angle=pixel, eye=eye, cache=cache)
    t = np.random.default_rng(5).uniform(0.01, 0.99, 20_000)[:, None]
    bernstein = np.concatenate([(1 - t) ** 3, 3 * t * (1 - t) ** 2, 3 * t**2 * (1 - t), t**3], axis=1)
    origins = np.tile(eye, (len(t), 1))
    hits = tracer.closest_hits(origins, bernstein @ border - origins)
    fell = np.flatnonzero(hits["instance"] < 0)
    assert len(fell) == 0, f"{len(fell)} rays fell through, the first at {t[fell[0], 0]!r}"
