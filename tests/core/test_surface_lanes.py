"""Surface points that are found for several hits at once have the bits of those found alone."""

import numpy as np
import pytest
import shapes
import strand_shapes
from core import subdivision_cages as cages
from core import swept_support as swept
from rayleaf import _core

trace = _core.trace
POINT = ("position", "facet_position", "normal", "facet_normal", "start_offset", "uv", "derivatives")


@pytest.fixture(params=trace.simd_targets())
def target(request, any_target):
    assert trace.use_simd_target(request.param)
    return request.param


def cusp():
    """A bicubic patch that is rational, and collapsed along one border."""
    random = np.random.default_rng(5)
    x, y = np.meshgrid(np.linspace(-1, 1, 4), np.linspace(-1, 1, 4))
    points = np.stack([x, y, random.normal(size=x.shape) * 0.3, random.uniform(0.5, 2.0, x.shape)], axis=2)
    points[0, :, :3] = points[0, 0, :3]
    return trace.PatchSurface("cusp", [(points, (4, False, True, True), (4, False, True, True), True, 0)])


def of_degrees(degree_u, degree_v, rational=False):
    """A wavy patch."""
    x, y = np.meshgrid(np.linspace(-1, 1, degree_u + 1), np.linspace(-1, 1, degree_v + 1))
    points = np.stack([x, y, np.sin(x * 3) * np.cos(y * 2) * 0.2, 1 + 0.3 * rational * np.cos(x + y)], axis=2)
    orders = [(degree + 1, False, True, True) for degree in (degree_u, degree_v)]
    return trace.PatchSurface(f"{degree_u} by {degree_v}", [(points, *orders, True, 0)])


def smooth_mesh():
    """A sphere of a few triangles with the normals of the sphere."""
    vertices = shapes.unit(np.asarray(shapes.CUBE_VERTICES, float)).astype(np.float32)
    triangles = np.asarray(shapes.CUBE_TRIANGLES)
    uv = np.random.default_rng(4).uniform(size=(triangles.size, 2)).astype(np.float32)
    return trace.TriangleMesh("ball", vertices, triangles, corner_normals=vertices[triangles.ravel()], uv=uv)


def swept_shapes():
    """Bevelled curves of every kind of piece, profile, radius and turn."""
    points, bend = swept.BEND_POINTS, swept.bend
    taper = swept.splines("BEZIER", [[0, 1, 0], [2, 0.5, 0]], [[[-1, 1, 0], [0.3, 1, 0]], [[1, 0, 0], [3, 1, 0]]])
    square = [swept.polygon([[-0.1, -0.1], [0.2, -0.1], [0.1, 0.1], [-0.1, 0.1]])]
    corners = np.array([[0, 0, 0], [1, 0, 0.2], [1, 1, 0], [0.2, 1, 0.5]])
    weights = np.concatenate([corners, [[1.0], [0.5], [2.0], [1.0]]], axis=1)
    yield bend(bevel_depth=0.1, fill_caps=True)
    yield bend(bevel_depth=0.1, extrude=0.2, tilts=np.array([0, 1.0, -2]), twist="Z_UP")
    yield bend(profile=square, radii=np.array([1, 0, 3.0]), radius_interpolation="CARDINAL", twist="TANGENT")
    yield bend(bevel_depth=0.1, smooth=False)
    for use in ("OVERRIDE", "MULTIPLY", "ADD"):
        yield bend(bevel_depth=0.1, taper=taper, taper_radius=use, radii=np.array([1, 0.5, 2]))
    yield swept.surface("BEZIER", points, swept.BEND_HANDLES, dimensions="2D", bevel_depth=0.1, extrude=0.3)
    yield swept.surface("POLY", corners, bevel_depth=0.1, cyclic=True)
    for order in (2, 3, 4):
        yield swept.surface(
            "NURBS", weights, bevel_depth=0.1, cyclic=True, order=order, tilts=np.array([0, 1.0, -2, 0])
        )
        yield swept.surface("NURBS", corners, bevel_depth=0.1, endpoint=True, order=order)


def other_shapes():
    yield from [shapes.cube(), shapes.lumpy_mesh(), smooth_mesh(), cages.cube().surface()]
    yield strand_shapes.strand([[0, 0, 0], [0.5, 0.3, 0], [1, 0, 0.4], [1.5, 0.2, 0.2]], 0.2)


def placed(shape, random, size=1.0):
    matrix = np.eye(4)
    matrix[:3, :3] = random.normal(size=(3, 3)) * size
    matrix[:3, 3] = random.normal(size=3) * 3
    return shape, matrix


def scenes():
    random = np.random.default_rng(2)
    alone = [shapes.nurbs_sphere(), shapes.nurbs_torus(), shapes.lumpy_torus(), cusp(), of_degrees(4, 4)]
    for shape in alone:
        yield [(shape, np.eye(4))]
    yield [(shapes.nurbs_sphere(smooth=False), np.eye(4))]
    yield [(shapes.lumpy_torus(), shapes.moved(1e6, 1e-3)), (shapes.nurbs_sphere(scale=1e-3), shapes.moved(1e6, 1.0))]
    shared = shapes.lumpy_torus()
    yield [placed(shape, random) for shape in [shared, shared, *alone, shapes.nurbs_sphere(smooth=False)]]
    degrees = [(1, 1), (1, 3), (3, 2), (5, 4), (5, 5), (2, 5)]
    mixed = [of_degrees(*pair, rational) for pair in degrees for rational in (False, True)]
    yield [placed(shape, random) for shape in mixed]
    yield from [[(shape, np.eye(4))] for shape in mixed]
    others = [*swept_shapes(), *other_shapes()]
    yield from [[(shape, np.eye(4))] for shape in others]
    yield [placed(shape, random) for shape in [*others, *alone]]


def rays_at(tracer, random, count):
    """Some of them aimed at poles and along axes, where borders lie."""
    low, high = tracer.bounds()
    center, reach = (np.asarray(low) + high) / 2, np.linalg.norm(np.asarray(high) - low)
    origins = center + shapes.random_directions(random, count) * reach
    targets = center + random.uniform(-0.25, 0.25, size=(count, 3)) * (np.asarray(high) - low)
    targets[: count // 4] = center
    origins[: count // 8, :2] = center[:2]
    return origins, shapes.unit(targets - origins)


@pytest.mark.parametrize("curvature", [True, pytest.param(False, marks=pytest.mark.slow)])
@pytest.mark.parametrize("number", range(len(list(scenes()))))
def test_surface_points_have_the_same_bits_in_lanes(target, number, curvature):
    tracer = trace.Tracer([(*each, shapes.EVERYTHING) for each in list(scenes())[number]])
    origins, directions = rays_at(tracer, np.random.default_rng(number), 1000)
    alone = tracer.closest_hits(origins, directions, curvature=curvature)
    assert np.isfinite(alone["t"]).sum() > 100
    for together in (2, 3, 7, 32):
        found = tracer.closest_hits(origins, directions, together=together, curvature=curvature)
        for name in POINT:
            kind = np.uint64 if found[name].dtype == np.float64 else np.uint32
            np.testing.assert_array_equal(
                np.ascontiguousarray(found[name]).view(kind), np.ascontiguousarray(alone[name]).view(kind), err_msg=name
            )
