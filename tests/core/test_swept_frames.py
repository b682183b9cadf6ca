"""Bevelled curves against a dense reference: where the surface lies, how it is turned, its normals and derivatives."""

import numpy as np
import pytest
from core import shapes
from core import swept_support as swept
from rayleaf import _core

CONTROL = swept.segments(swept.BEND_POINTS, swept.BEND_HANDLES)
RAYS = 4000
# Facets lie within 1e-4 of the surface, and parameters of a hit are single precision.
NEAR = 5e-7


def hits_on(shape, seed=1, count=RAYS):
    """Hits of rays that are aimed at the bend's curve."""
    random = np.random.default_rng(seed)
    targets, _ = swept.along(CONTROL, random.uniform(0.02, 0.98, count))
    tracer = _core.trace.Tracer([(shape, np.eye(4), shapes.EVERYTHING)], eye=(0, 0, 5))
    hits = tracer.closest_hits(*swept.rays_at(targets, 3.0, random))
    assert (hits["instance"] == 0).all()
    return hits


def radius_of(mode, values, share):
    """Radius or tilt at shares of the bend, two segments between three values: Blender's key interpolations."""
    number = np.clip((share * 2).astype(int), 0, 1)
    t = share * 2 - number
    extended = np.array([values[0], *values, values[-1]])
    p = [extended[number + i] for i in range(4)]
    if mode == "LINEAR":
        return p[1] + (p[2] - p[1]) * t
    if mode == "EASE":
        return p[1] + (p[2] - p[1]) * (3 * t**2 - 2 * t**3)
    if mode == "BSPLINE":
        return ((1 - t) ** 3 * p[0] + (3 * t**3 - 6 * t**2 + 4) * p[1]) / 6 + (
            (-3 * t**3 + 3 * t**2 + 3 * t + 1) * p[2] + t**3 * p[3]
        ) / 6
    c = 0.71
    return (
        (-c * t**3 + 2 * c * t**2 - c * t) * p[0]
        + ((2 - c) * t**3 + (c - 3) * t**2 + 1) * p[1]
        + ((c - 2) * t**3 + (3 - 2 * c) * t**2 + c * t) * p[2]
        + (c * t**3 - c * t**2) * p[3]
    )


# Where the texture coordinate around begins, in turns: Blender's first point is one of its steps away from the first
# normal, and a bevel resolution of 4 makes 12 of them.
PROFILE_START = 1 / 12


def round_reference(uv, radius, normals, tilt=None):
    """Points of the round tube at texture coordinates."""
    position, tangent = swept.along(CONTROL, uv[:, 0])
    across, up = swept.turned(normals, tangent, np.zeros(len(uv)) if tilt is None else tilt)
    angle = (uv[:, 1:] + PROFILE_START) * 2 * np.pi
    return position + np.reshape(radius, (-1, 1)) * (np.cos(angle) * across + np.sin(angle) * up)


@pytest.mark.parametrize("mode", ["LINEAR", "CARDINAL", "BSPLINE", "EASE"])
def test_an_upright_tube_lies_where_frames_radii_and_tilts_say(mode):
    radii, tilts = np.array([0.5, 1.5, 0.8]), np.array([0.3, -1.0, 2.0])
    shape = swept.bend(
        bevel_depth=0.1,
        twist="Z_UP",
        radii=radii,
        tilts=tilts,
        radius_interpolation=mode,
        tilt_interpolation=mode,
    )
    hits = hits_on(shape)
    inside = hits["uv"][:, 0] < 1  # a B-spline's radius ends in a step, for the last ring has the point's own
    assert inside.mean() > 0.99
    uv = hits["uv"][inside].astype(float)
    share = uv[:, 0]
    _, tangent = swept.along(CONTROL, share)
    expected = round_reference(
        uv, 0.1 * radius_of(mode, radii, share), swept.upright(tangent), radius_of(mode, tilts, share)
    )
    np.testing.assert_allclose(hits["position"][inside], expected, atol=3 * NEAR)


def test_minimum_twist_does_not_turn_about_the_curve():
    hits = hits_on(swept.bend(bevel_depth=0.1, twist="MINIMUM"))
    uv = hits["uv"].astype(float)
    expected = round_reference(uv, np.full(len(uv), 0.1), swept.MinimumTwist(CONTROL).at(uv[:, 0]))
    # The reference's own steps: a turn by 1e-4 of a radius of 0.1.
    np.testing.assert_allclose(hits["position"], expected, atol=1e-5)


def test_tangent_twist_follows_the_curvature():
    hits = hits_on(swept.bend(bevel_depth=0.1, twist="TANGENT"))
    uv = hits["uv"].astype(float)
    step = 1e-5
    inside = np.abs(uv[:, 0] * 2 - np.round(uv[:, 0] * 2)) > 0.1  # the frame jumps at the points
    uv = uv[inside]
    _, before = swept.along(CONTROL, uv[:, 0] - step)
    _, after = swept.along(CONTROL, uv[:, 0] + step)
    binormal = shapes.unit(np.cross(before, after))
    either = [round_reference(uv, np.full(len(uv), 0.1), side * binormal) for side in (1, -1)]
    position = hits["position"][inside]
    distance = np.minimum(*(np.linalg.norm(position - expected, axis=1) for expected in either))
    assert distance.max() < 1e-5


def test_normals_and_derivatives_are_those_of_the_surface():
    shape = swept.bend(bevel_depth=0.2, radii=np.array([0.5, 1.5, 0.8]), radius_interpolation="EASE", twist="Z_UP")
    hits = hits_on(shape)
    uv = hits["uv"].astype(float)
    # Second derivatives jump between the segments, and the reference's steps must stay inside.
    places = np.stack([uv[:, 0] * 2 % 1, uv[:, 1]])
    inside = np.all((places > 2e-3) & (places < 1 - 2e-3), axis=0)
    uv = uv[inside]

    def point(du, dv):
        moved = uv + [du, dv]
        _, tangent = swept.along(CONTROL, moved[:, 0])
        radius = 0.2 * radius_of("EASE", [0.5, 1.5, 0.8], moved[:, 0])
        return round_reference(moved, radius, swept.upright(tangent))

    e = 1e-4
    du, dv = (point(e, 0) - point(-e, 0)) / (2 * e), (point(0, e) - point(0, -e)) / (2 * e)
    normal = shapes.unit(np.cross(dv, du))
    assert np.sum(normal * hits["normal"][inside], axis=1).min() > 1 - 1e-6
    scale = np.linalg.norm(du, axis=1).max()
    np.testing.assert_allclose(hits["derivatives"][inside, 0], du, atol=1e-4 * scale)
    np.testing.assert_allclose(hits["derivatives"][inside, 1], dv, atol=1e-4 * scale)

    def unit_normal(u, v):
        h = 1e-5
        along = (point(u + h, v) - point(u - h, v)) / (2 * h)
        around = (point(u, v + h) - point(u, v - h)) / (2 * h)
        return shapes.unit(np.cross(around, along))

    for index, (u, v) in ((2, (e, 0)), (3, (0, e))):
        change = (unit_normal(u, v) - unit_normal(-u, -v)) / (2 * e)
        difference = np.linalg.norm(hits["derivatives"][inside, index] - change, axis=1)
        assert difference.max() < 1e-3 * np.linalg.norm(change, axis=1).max()


def test_normals_point_outwards_and_rays_meet_the_tube_where_it_is_round():
    hits = hits_on(swept.bend(bevel_depth=0.05))
    share = hits["uv"][:, 0].astype(float)
    center, _ = swept.along(CONTROL, share)
    outwards = hits["position"] - center
    np.testing.assert_allclose(np.linalg.norm(outwards, axis=1), 0.05, atol=NEAR)
    assert np.sum(shapes.unit(outwards) * hits["normal"], axis=1).min() > 0.999


def test_a_closed_curve_spreads_its_twist_or_has_a_seam():
    """Eight points around a bent ring: minimum twist comes back turned by some angle."""
    angle = np.arange(8) * np.pi / 4
    points = np.stack([np.cos(angle), 1.3 * np.sin(angle), 0.6 * np.sin(2 * angle + 0.4) + angle**2 / 20], axis=1)
    for closed_twist in ("SPREAD", "JUMP"):
        shape = swept.surface("NURBS", points, cyclic=True, bevel_depth=0.1, closed_twist=closed_twist, twist="MINIMUM")
        ends = shape.rings(np.array([0.0, shape.element_count - 1e-12]))
        np.testing.assert_allclose(ends[1, 0], ends[0, 0], atol=1e-6)
        np.testing.assert_allclose(ends[1, 1], ends[0, 1], atol=1e-5)
    spread = swept.surface("NURBS", points, cyclic=True, bevel_depth=0.1, closed_twist="SPREAD")
    jump = swept.surface("NURBS", points, cyclic=True, bevel_depth=0.1, closed_twist="JUMP")
    assert jump.element_count == spread.element_count + 1  # the ring that jumps back
    half_way = spread.element_count / 2
    turn = np.sum(spread.rings(np.array([half_way]))[0, 1] * jump.rings(np.array([half_way]))[0, 1])
    assert turn < 0.999


def test_a_closed_polygon_spreads_its_twist_over_its_corners_as_blender_does():
    points = np.array(
        [[1.3847, 0.1766, -0.8529], [-0.5257, 1.2171, 0.4711], [-1.2534, 0.5809, 0.3404], [0.2988, -0.9144, -0.2021]]
    )
    # Of Blender 4.5's mesh of this curve with nothing but Extrude.
    extruded = [
        [0.0307, -0.1192, 0.9924],
        [0.2915, -0.4759, 0.8298],
        [0.6288, -0.2342, 0.7415],
        [0.4214, 0.1647, 0.8918],
    ]
    shape = swept.surface("POLY", points, cyclic=True, bevel_depth=0.1, closed_twist="SPREAD", twist="MINIMUM")
    ends = [4 - 1e-9, 1 - 1e-9, 2 - 1e-9, 3 - 1e-9]
    normals, ring = shape.rings(np.array(ends))[:, 1], np.roll(points, 1, axis=0)
    directions = shapes.unit(shapes.unit(np.roll(points, -1, 0) - points) + shapes.unit(points - ring))
    np.testing.assert_allclose(np.cross(directions, shapes.unit(normals)), extruded, atol=2e-3)


def test_a_curve_that_closes_at_a_corner_meets_its_first_ring():
    points = np.array([[0.0, 0, 0], [1, 0, 0.3], [1, 1, -0.4]])
    handles = points[:, None] + np.array([[[0.1, -0.3, 0.5], [0.3, 0.2, 0.4]]])
    for closed_twist in ("SPREAD", "JUMP"):
        shape = swept.surface(
            "BEZIER", points, handles, cyclic=True, bevel_depth=0.1, closed_twist=closed_twist, twist="MINIMUM"
        )
        first, last = shape.rings(np.array([0.0, shape.element_count - 1e-9]))
        np.testing.assert_allclose(last[:3], first[:3], atol=1e-6)
        if closed_twist == "SPREAD":  # and where it arrives, the frame is upright, as in Blender since 3.5
            (arriving,) = shape.rings(np.array([shape.element_count - 1 - 1e-9]))
            assert abs(arriving[1, 2]) < 1e-6
            assert abs(first[1, 2]) > 0.1


def test_walls_of_a_mitred_polygon_keep_their_distance_in_the_plane_and_not_in_space():
    points = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0]])
    corner = {}
    for dimensions in ("2D", "3D"):
        shape = swept.surface("POLY", points, dimensions=dimensions, bevel_depth=0.1)
        assert shape.element_count == 2
        ring = shape.rings(np.array([1.0]))[0]
        np.testing.assert_allclose(shapes.unit(ring[1:2])[0], [-np.sqrt(0.5), np.sqrt(0.5), 0], atol=1e-12)
        corner[dimensions] = np.linalg.norm(ring[1]) / np.linalg.norm(ring[2])
    assert corner["2D"] == pytest.approx(np.sqrt(2), abs=1e-12)
    assert corner["3D"] == pytest.approx(1.0, abs=1e-12)


@pytest.mark.parametrize("type_name", ["BEZIER", "NURBS", "POLY"])
def test_a_straight_tube_is_a_cylinder_with_any_type_of_spline(type_name):
    points = np.array([[0.0, 0, 0], [1, 0, 0], [2, 0, 0], [3, 0, 0]])
    handles = points[:, None] + np.array([[[-0.3, 0, 0], [0.3, 0, 0]]]) if type_name == "BEZIER" else None
    shape = swept.surface(type_name, points, handles, endpoint=True, bevel_depth=0.25, fill_caps=True)
    tracer = _core.trace.Tracer([(shape, np.eye(4), shapes.EVERYTHING)], eye=(0, 0, 5))
    random = np.random.default_rng(5)
    targets = np.column_stack([random.uniform(0.01, 2.99, 2000), np.zeros((2000, 2))])
    hits = tracer.closest_hits(*swept.rays_at(targets, 6.0, random))
    walls = hits["primitive"] < shape.element_count - 2
    position = hits["position"]
    np.testing.assert_allclose(np.hypot(position[walls, 1], position[walls, 2]), 0.25, atol=1e-7)
    ends = position[~walls, 0]
    np.testing.assert_allclose(np.minimum(np.abs(ends), np.abs(ends - 3)), 0, atol=1e-7)


@pytest.mark.parametrize("mapping", ["RESOLUTION", "SEGMENTS", "SPLINE"])
def test_the_bevel_covers_its_part_by_each_mapping(mapping):
    points = np.array([[0.0, 0, 0], [1, 0, 0], [4, 0, 0]])
    shape = swept.surface(
        "POLY", points, bevel_depth=0.1, bevel_start=0.1, bevel_end=0.7, start_mapping=mapping, end_mapping=mapping
    )
    # Of two pieces of lengths 1 and 3: by pieces 0.2 to 1 + 0.4 * 3, by length 0.4 to 2.8.
    tracer = _core.trace.Tracer([(shape, np.eye(4), shapes.EVERYTHING)])
    x = np.linspace(0.0033, 3.9933, 799)
    origins = np.column_stack([x, np.full((len(x), 2), [0.0, 5.0])])
    hit = tracer.closest_hits(origins, np.tile([0.0, 0, -1], (len(x), 1)))["instance"] >= 0
    low, high = (0.2, 2.2) if mapping == "RESOLUTION" else (0.4, 2.8)
    np.testing.assert_array_equal(hit, (x > low) & (x < high))


@pytest.mark.parametrize("use", ["OVERRIDE", "MULTIPLY", "ADD"])
def test_a_taper_sets_multiplies_or_adds_to_the_radius(use):
    points = np.array([[0.0, 0, 0], [1, 0, 0], [2, 0, 0]])
    handles = points[:, None] + np.array([[[-0.3, 0, 0], [0.3, 0, 0]]])
    taper = swept.splines("POLY", [[5, 1, 0], [6, 0.5, 0], [9, 2, 0]])
    shape = swept.surface(
        "BEZIER", points, handles, radii=np.array([2.0, 2, 2]), bevel_depth=0.1, taper=taper, taper_radius=use
    )
    tracer = _core.trace.Tracer([(shape, np.eye(4), shapes.EVERYTHING)], eye=(1, 0, 1))
    x = np.linspace(0.01, 1.99, 100)
    origins = np.column_stack([x, np.full((len(x), 2), [0.0, 5.0])])
    hits = tracer.closest_hits(origins, np.tile([0.0, 0, -1], (len(x), 1)))
    share = hits["uv"][:, 0].astype(float)
    factor = np.interp(share, [0, 0.25, 1], [1, 0.5, 2])
    radius = {"OVERRIDE": factor, "MULTIPLY": 2 * factor, "ADD": 2 + factor}[use]
    np.testing.assert_allclose(np.hypot(hits["position"][:, 1], hits["position"][:, 2]), 0.1 * radius, atol=1e-6)
