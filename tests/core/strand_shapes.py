"""Strands for tests, and rays aimed at them, made here without the core."""

from typing import Any

import numpy as np
from numpy.typing import NDArray
from rayleaf import _core

Doubles = NDArray[np.float64]
EVERYTHING = 31


def strand(points: Any, radius: Any, **options: Any) -> Any:
    """One strand; `radius` for all points or one each."""
    points = np.asarray(points, float)
    radii = np.broadcast_to(np.asarray(radius, np.float32), (len(points),)).copy()
    return _core.Strands("hair", points, radii, np.array([0, len(points)], np.int32), **options)


def tracer(shape: Any, offset: Any = (0.0, 0.0, 0.0)) -> Any:
    """A tracer of one shape, moved."""
    matrix = np.eye(4)
    matrix[:3, 3] = offset
    return _core.trace.Tracer([(shape, matrix, EVERYTHING)])


# A gentle S of about unit length, as cubic Bezier.
S_CURVE = np.array([[0, 0, 0], [0.4, 0.3, 0.1], [0.6, -0.3, 0.2], [1, 0, 0]])


def bezier_points(points: Doubles, t: Doubles) -> Doubles:
    """Points of a cubic Bezier curve."""
    s = 1.0 - t
    return np.stack([s**3, 3 * t * s**2, 3 * t * t * s, t**3], 1) @ points


def torus_knot(tube_points: int = 40) -> Doubles:
    """A closed trefoil."""
    t = np.linspace(0.0, 2.0 * np.pi, tube_points + 1)[:-1]
    ring = 2.0 + np.cos(3 * t)
    return np.stack([ring * np.cos(2 * t), ring * np.sin(2 * t), np.sin(3 * t)], 1)


def crossings(shape: Any, rays: int, seed: int) -> dict[str, int]:
    """Random rays through a shape, continued behind every surface from the hit point, as in glass."""
    scene = tracer(shape)
    low, high = (np.array(corner) for corner in scene.bounds())
    random = np.random.default_rng(seed)
    direction = random.normal(size=(rays, 3))
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    origin = low + random.random((rays, 3)) * (high - low) - direction * 10.0 * np.linalg.norm(high - low)
    depth, misplaced, hits = np.zeros(rays, int), 0, 0
    active = np.arange(rays)
    for _ in range(100):
        found = scene.closest_hits(origin[active], direction[active])
        hit = np.isfinite(found["t"])
        active = active[hit]
        if len(active) == 0:
            break
        normal = found["facet_normal"][hit].astype(float)
        enters = np.sum(normal * direction[active], axis=1) < 0.0
        depth[active] += np.where(enters, 1, -1)
        misplaced += int(np.sum((depth[active] < 0) | (depth[active] > 1)))
        hits += len(active)
        side = np.where(enters, -1.0, 1.0) * found["start_offset"][hit]
        origin[active] = found["facet_position"][hit] + normal * side[:, None]
    return {"hits": hits, "unbalanced": int(np.count_nonzero(depth)), "misplaced": misplaced, "endless": len(active)}
