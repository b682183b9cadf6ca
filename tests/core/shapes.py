"""Closed shapes and rays for the tests of tracing, built here without the core."""

from typing import Any

import numpy as np
from numpy.typing import NDArray
from rayleaf import _core

trace = _core.trace
Doubles = NDArray[np.float64]
EVERYTHING = 31
HALF = np.sqrt(0.5)


def unit(vectors: Doubles) -> Doubles:
    """Vectors of length 1."""
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def random_directions(random: np.random.Generator, count: int) -> Doubles:
    """Uniform over the sphere."""
    return unit(random.normal(size=(count, 3)))


def moved(offset: float, scale: float = 1.0) -> Doubles:
    """A matrix that scales by one factor and moves along all axes."""
    matrix = np.diag([scale, scale, scale, 1.0])
    matrix[:3, 3] = offset
    return matrix


# A circle of eight points with weights 1 and sqrt(1/2): exact as a quadratic NURBS.
CIRCLE = np.array([[0, -1], [-1, -1], [-1, 0], [-1, 1], [0, 1], [1, 1], [1, 0], [1, -1]], float)
CIRCLE_WEIGHTS = np.array([1, HALF] * 4)
QUADRATIC_ARC, QUADRATIC_CLOSED = (3, False, True, True), (3, True, True, True)
CUBIC_CLOSED = (4, True, False, False)


def nurbs_sphere(smooth: bool = True, scale: float = 1.0, center: Any = (0, 0, 0)) -> Any:
    """Blender's NURBS sphere: five points along a half circle, turned by eight."""
    half_circle = np.array([[0, -1], [1, -1], [1, 0], [1, 1], [0, 1]], float)
    half_weights = np.array([1, HALF, 1, HALF, 1])
    points = np.empty((8, 5, 4))
    counter_clockwise = np.roll(CIRCLE[::-1], 1, axis=0)
    points[..., :2] = counter_clockwise[:, None, :] * half_circle[None, :, :1]
    points[..., 2] = half_circle[None, :, 1]
    points[..., :3] = scale * points[..., :3] + np.asarray(center, float)
    points[..., 3] = CIRCLE_WEIGHTS[:, None] * half_weights[None, :]
    return trace.PatchSurface("sphere", [(points, QUADRATIC_ARC, QUADRATIC_CLOSED, smooth, 0)])


def nurbs_torus() -> Any:
    """Blender's NURBS torus: ring radius 0.75, tube radius 0.25."""
    points = np.empty((8, 8, 4))
    ring = 0.75 + 0.25 * CIRCLE[None, :, 0]
    points[..., :2] = CIRCLE[:, None, :] * ring[..., None]
    points[..., 2] = 0.25 * CIRCLE[None, :, 1]
    points[..., 3] = CIRCLE_WEIGHTS[:, None] * CIRCLE_WEIGHTS[None, :]
    return trace.PatchSurface("torus", [(points, QUADRATIC_CLOSED, QUADRATIC_CLOSED, True, 0)])


def lumpy_torus() -> Any:
    """A bicubic torus with dents, 24 x 16 patches."""
    u, v = np.meshgrid(np.arange(16) * np.pi / 8, np.arange(24) * np.pi / 12)
    tube = 0.3 + 0.05 * np.sin(5 * v + 1) * np.cos(2 * u) + 0.03 * np.sin(3 * u - 2 * v)
    ring = 0.7 + tube * np.cos(u)
    points = np.stack([ring * np.cos(v), ring * np.sin(v), tube * np.sin(u), np.ones_like(u)], axis=2)
    return trace.PatchSurface("lumpy", [(points, CUBIC_CLOSED, CUBIC_CLOSED, True, 0)])


CUBE_VERTICES = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], np.float32)
CUBE_QUADS = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
CUBE_TRIANGLES = np.array([t for a, b, c, d in CUBE_QUADS for t in ((a, b, c), (a, c, d))], np.int32)


def cube() -> Any:
    """From -1 to 1, wound outwards."""
    return trace.TriangleMesh("cube", CUBE_VERTICES, CUBE_TRIANGLES)


def lumpy_mesh() -> Any:
    """A closed mesh: a dented sphere of 48 x 32 cells with single vertices at the poles."""
    columns, rows = 48, 32
    theta = np.arange(1, rows) * np.pi / rows
    phi = np.arange(columns) * 2 * np.pi / columns
    t, p = np.meshgrid(theta, phi, indexing="ij")
    radius = 1 + 0.1 * np.sin(4 * t) * np.cos(3 * p)
    ring = np.stack([radius * np.sin(t) * np.cos(p), radius * np.sin(t) * np.sin(p), radius * np.cos(t)], axis=2)
    vertices = np.concatenate([ring.reshape(-1, 3), [[0, 0, 1], [0, 0, -1]]]).astype(np.float32)
    top, bottom = len(vertices) - 2, len(vertices) - 1
    triangles = []
    for j in range(columns):
        after = (j + 1) % columns
        triangles.append((top, j, after))
        last = (rows - 2) * columns
        triangles.append((last + j, bottom, last + after))
        for i in range(rows - 2):
            a, b = i * columns + j, i * columns + after
            triangles += [(a, a + columns, b + columns), (a, b + columns, b)]
    return trace.TriangleMesh("lumps", vertices, np.array(triangles, np.int32))


def leaving(hits: dict[str, Any], directions: Doubles) -> Doubles:
    """The origins of rays that leave the hit points: SurfacePoint::ray_origin."""
    normal = hits["facet_normal"].astype(np.float64)
    side = np.where(np.sum(directions * normal, axis=1) < 0, -1.0, 1.0)
    return hits["facet_position"] + normal * (side * hits["start_offset"])[:, None]
