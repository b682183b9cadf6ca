"""Stiff and extreme patches against extended precision: hit or miss, position, normal; at every size and distance, and with
every kernel."""

import numpy as np
import pytest
from core import shapes
from stability.kernels import check_same_bits
from stability.measured import check_bound
from stability.patch_cases import REGULAR, PatchCase, extended

trace = shapes.trace
OFFSETS = (0.0, 1e3, 1e6)
SCALES = (1e-6, 1.0, 1e6)
CASES = {case.name: case for case in REGULAR}
DISTANCE = 3.0  # of the eye, in sizes of the patch
PIXEL_ANGLE = 1e-4
FACET_TOLERANCE = 0.1 * PIXEL_ANGLE * DISTANCE  # of facets to surface, in sizes of the patch


def aimed_rays(case: PatchCase, angle: float):
    """Rays at the case's points, tilted from the normal; positions and origins in extended precision, size 1."""
    aims = case.aims()
    position, by_u, _ = case.evaluate(aims[:, 0], aims[:, 1])
    normal = case.normals(aims[:, 0], aims[:, 1])
    tangent = by_u / np.sqrt(np.sum(by_u * by_u, axis=1))[:, None]
    towards = -(np.cos(extended(angle)) * normal + np.sin(extended(angle)) * tangent)
    return position, position - towards * DISTANCE, towards


def hits_of(case: PatchCase, offset: float, scale: float, origins, towards):
    """The core's hits, with the patch scaled and moved."""
    matrix = shapes.moved(offset, scale)
    tracer = trace.Tracer([(case.surface(), matrix, shapes.EVERYTHING)], pixel_angle=PIXEL_ANGLE, eye=(offset,) * 3)
    # The tolerance is a share of the distance: an eye at the patch's own size away.
    placed = np.asarray(origins * scale + offset, np.float64)
    return tracer.closest_hits(placed, np.asarray(towards, np.float64))


def errors(case: PatchCase, offset: float, scale: float, angle: float):
    """Missed rays; worst distances, in sizes of the patch, of the surface's hit from its own parameters and from the
    ray; worst angle of the normal to that of its parameters."""
    _, origins, towards = aimed_rays(case, angle)
    hits = hits_of(case, offset, scale, origins, towards)
    found = hits["instance"] >= 0
    u, v = hits["u"].astype(float)[found], hits["v"].astype(float)[found]
    exact = case.evaluate(u, v)[0]
    position = (extended(hits["position"][found]) - extended(offset)) / extended(scale)
    apart = np.sqrt(np.sum((position - exact) ** 2, axis=1))
    # The ray as the core got it: rounding its origin at 1e6 moves it by more than the patch's facets.
    start = (extended(np.asarray(origins * scale + offset, np.float64)) - extended(offset)) / extended(scale)
    way = exact - start[found]
    off_ray = np.sqrt(np.sum(np.cross(way, towards[found]) ** 2, axis=1))
    normal = case.normals(u, v)
    # Facets as small as single precision's rounding may face any way; the facet that was hit decides the side.
    facing = np.sum(extended(hits["facet_normal"][found]) * normal, axis=1) < 0
    normal[facing] *= -1
    turned = np.sqrt(np.sum((extended(hits["normal"][found]) - normal) ** 2, axis=1))
    return int(np.sum(~found)), apart, off_ray, turned


@pytest.mark.parametrize("scale", SCALES)
@pytest.mark.parametrize("offset", OFFSETS)
@pytest.mark.parametrize("name", CASES)
def test_rays_meet_stiff_patches_where_extended_precision_says(name, offset, scale):
    if offset >= 1e9 * scale:
        pytest.skip("a world position has too few digits for an object that small so far away")
    case = CASES[name]
    place = f"{name}, offset {offset:g}, scale {scale:g}"
    for angle in (0.0, case.steepest):
        missed, apart, off_ray, turned = errors(case, offset, scale, angle)
        rounding = 4 * np.spacing(offset + scale) / scale  # of world positions, in sizes of the patch
        check_bound(place, f"rays lost at {angle:g} rad", missed, 0, "rays")
        check_bound(place, f"position at {angle:g} rad", apart.max(), case.position_bound + rounding, "sizes")
        # A facet stands off by its tolerance, seen at the angle; float parameters of the hit add their own.
        allowed = 2 * FACET_TOLERANCE / np.cos(angle) + 4e-6 + rounding
        check_bound(place, f"distance from the ray at {angle:g} rad", off_ray.max(), allowed, "sizes")
        check_bound(place, f"normal at {angle:g} rad", turned.max(), 2e-6, "rad")


@pytest.mark.parametrize("scale", SCALES)
@pytest.mark.parametrize("offset", OFFSETS)
@pytest.mark.parametrize("name", CASES)
def test_every_kernel_gives_the_same_bits(name, offset, scale, any_target):
    case = CASES[name]
    _, origins, towards = aimed_rays(case, 0.5 * case.steepest)
    place = f"{name}, offset {offset:g}, scale {scale:g}"
    check_same_bits(place, lambda: hits_of(case, offset, scale, origins, towards))


SHARP_PLACES = {
    "corners of a cube": (shapes.cube, shapes.CUBE_VERTICES),
    "edges of a cube": (shapes.cube, [(0.3, 1, 1), (1, -0.2, 1), (-1, 1, 0.6), (1e-6, -1, -1)]),
    "diagonals of a cube's faces": (shapes.cube, [(0.25, 0.25, 1), (0, 0, 1), (1, 0.5, 0.5), (-0.7, 0.7, -1)]),
    "poles of a sphere": (shapes.nurbs_sphere, [(0, 0, 1), (0, 0, -1)]),
    "seams of a sphere": (shapes.nurbs_sphere, [(1, 0, 0), (0, 1, 0), (np.sqrt(0.5), np.sqrt(0.5), 0), (0, -0.6, 0.8)]),
}


@pytest.mark.parametrize("scale", SCALES)
@pytest.mark.parametrize("offset", OFFSETS)
@pytest.mark.parametrize("name", SHARP_PLACES)
def test_no_ray_slips_through_a_corner_an_edge_or_a_pole(name, offset, scale):
    """Rays from inside, aimed exactly at where facets meet."""
    if offset >= 1e9 * scale:
        pytest.skip("a world position has too few digits for an object that small so far away")
    make, places = SHARP_PLACES[name]
    tracer = trace.Tracer([(make(), shapes.moved(offset, scale), shapes.EVERYTHING)], eye=(offset,) * 3)
    random = np.random.default_rng(17)
    targets = np.repeat(np.asarray(places, float), 500, axis=0)
    origins = 0.4 * shapes.random_directions(random, len(targets))
    hits = tracer.closest_hits(origins * scale + offset, shapes.unit(targets - origins))
    place = f"{name}, offset {offset:g}, scale {scale:g}"
    check_bound(place, "rays lost", int(np.sum(hits["instance"] < 0)), 0, "rays")
    off = np.linalg.norm((hits["position"] - offset) / scale - targets, axis=1).max()
    # The corner of a cube is met where rounding says; a sphere's facets stand off by a pixel's tenth.
    check_bound(place, "position", off, 1e-3 + 8 * np.spacing(offset + scale) / scale, "sizes")


def test_rays_that_run_within_a_face_or_along_an_edge_make_no_nonsense():
    tracer = trace.Tracer([(shapes.cube(), np.eye(4), shapes.EVERYTHING)])
    origins = np.array([[-3, 1, 1], [-3, 0.2, 1], [-3, -1, 0.5], [-3, -3, 1], [-2, 1, 1]], float)
    directions = shapes.unit(np.array([[1, 0, 0], [1, 0, 0], [1, 0, 0], [1, 1, 0], [1, 0, 0]], float))
    hits = tracer.closest_hits(origins, directions)
    on = hits["instance"] >= 0
    for key in ("position", "normal", "facet_normal"):
        assert np.isfinite(hits[key]).all(), key
    np.testing.assert_allclose(np.abs(hits["position"][on]).max(axis=1), 1.0, atol=1e-6)
    np.testing.assert_allclose(np.linalg.norm(hits["normal"][on], axis=1), 1.0, atol=1e-5)


@pytest.mark.parametrize("angle", [1e-3, 1e-5, 1e-7])
def test_grazing_rays_meet_a_flat_patch_to_a_ten_millionth_of_a_radian(angle):
    """A flat square hit at its middle by rays that rise by 1e-7: the closed form is the plane."""
    flat = PatchCase("flat", np.array([[[-1, -1, 0, 1], [1, -1, 0, 1]], [[-1, 1, 0, 1], [1, 1, 0, 1.0]]]))
    tracer = trace.Tracer([(flat.surface(), np.eye(4), shapes.EVERYTHING)])
    place = np.random.default_rng(5).uniform(-0.5, 0.5, (1000, 2))
    directions = np.column_stack([np.full(1000, np.cos(angle)), np.zeros(1000), np.full(1000, -np.sin(angle))])
    target = np.column_stack([place, np.zeros(1000)])
    origins = target - 0.4 * directions
    hits = tracer.closest_hits(origins, directions)
    check_bound(f"grazing by {angle:g}", "rays lost", int(np.sum(hits["instance"] < 0)), 0, "rays")
    # The height of the origin is known to one rounding of its coordinates: 1e-17, over the angle.
    off = np.linalg.norm(hits["facet_position"] - target, axis=1).max()
    check_bound(f"grazing by {angle:g}", "position on the facet", off, 1e-15 + 1e-15 / angle, "sizes")
    # The surface's point comes from parameters in single precision, of a patch of size 2.
    off = np.linalg.norm(hits["position"] - target, axis=1).max()
    check_bound(f"grazing by {angle:g}", "position on the surface", off, 2.0**-23 + 1e-15 / angle, "sizes")


def test_needles_and_sheets_of_aspect_a_million_are_hit():
    for name, factors in {"needle": (1, 1e-6, 1e-6), "sheet": (1, 1e-6, 1)}.items():
        case = PatchCase(name, CASES["bicubic"].points * [*factors, 1])
        aims = case.aims()
        position = np.asarray(case.evaluate(aims[:, 0], aims[:, 1])[0], float)
        normal = np.asarray(case.normals(aims[:, 0], aims[:, 1]), float)
        tracer = trace.Tracer([(case.surface(), np.eye(4), shapes.EVERYTHING)], pixel_angle=1e-8)
        hits = tracer.closest_hits(position + normal * 1e-3, -normal)
        check_bound(f"{name} of aspect 1e6", "rays lost", int(np.sum(hits["instance"] < 0)), 0, "rays")
        off = np.linalg.norm(hits["position"] - position, axis=1).max()
        # 64 x 16 cells at most along a side: chords are 1.2 (2 / 1024)^2 / 8 off at that curvature, seen at an angle.
        check_bound(f"{name} of aspect 1e6", "position", off, 4e-6, "sizes")


def test_a_patch_of_one_point_is_refused_or_missed_and_never_crashes():
    points = np.zeros((4, 4, 4))
    points[..., 3] = 1.0
    case = PatchCase("one point", points)
    tracer = trace.Tracer([(case.surface(), np.eye(4), shapes.EVERYTHING)])
    origins = np.array([[0, 0, 1], [1e-9, 0, 1], [0.5, 0, 1.0]])
    hits = tracer.closest_hits(origins, np.array([[0, 0, -1.0]] * 3))
    assert np.isfinite(hits["position"]).all() and np.isfinite(hits["normal"]).all()
    assert hits["instance"][2] < 0
