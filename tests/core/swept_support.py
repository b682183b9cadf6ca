"""Bevelled curves for the tests, and a dense, slow reference of their surfaces, independent of the core."""

from typing import Any

import numpy as np
from core.shapes import Doubles, unit
from rayleaf import _core

SPLINE_ARGUMENTS = {"radii", "tilts", "straight", "cyclic", "radius_interpolation", "tilt_interpolation"}
SPLINE_ARGUMENTS |= {"resolution", "material_slot", "smooth", "order", "endpoint", "ends_at_seam"}


def weighted(points: Any) -> Doubles:
    """Points with weight 1."""
    points = np.asarray(points, float)
    return np.concatenate([points, np.ones((len(points), 1))], axis=1)


def splines(type_name: str, points: Any, handles: Any = None, counts: Any = None, **arguments: Any) -> Any:
    """A group of splines; one if `counts` is not given."""
    points = np.asarray(points, float)
    counts = np.array([len(points)] if counts is None else counts, np.int32)
    given = points if points.shape[1] == 4 else weighted(points)
    handles = None if handles is None else np.asarray(handles, float)
    return _core.CurveSplines(type_name, counts, given, handles, **arguments)


def curve(type_name: str, points: Any, handles: Any = None, **arguments: Any) -> Any:
    """A curve of one spline."""
    own = {name: arguments.pop(name) for name in list(arguments) if name in SPLINE_ARGUMENTS}
    return _core.SweptCurve("curve", [splines(type_name, points, handles, **own)], **arguments)


def surface(type_name: str, points: Any, handles: Any = None, **arguments: Any) -> Any:
    """The surface of a curve of one spline."""
    return _core.trace.SweptSurface(curve(type_name, points, handles, **arguments))


def polygon(points: Any, cyclic: bool = True) -> Any:
    """A profile of straight lines."""
    points = np.asarray(points, float)
    return splines("POLY", np.concatenate([points, np.zeros((len(points), 1))], axis=1), cyclic=cyclic)


# A curve of three points in space with bends both ways.
BEND_POINTS = np.array([[0.0, 0.0, 0.0], [1.0, 0.4, 0.3], [1.6, -0.3, 0.9]])
BEND_HANDLES = np.array(
    [[[-0.3, 0, 0], [0.4, 0.5, -0.1]], [[0.7, 0.1, 0.5], [1.3, 0.7, 0.1]], [[1.5, 0.2, 1.0], [1.7, -0.8, 0.8]]]
)


def bend(**arguments: Any) -> Any:
    """The surface of that curve."""
    return surface("BEZIER", BEND_POINTS, BEND_HANDLES, **arguments)


def segments(points: Doubles, handles: Doubles) -> Doubles:
    """Control points (n - 1, 4, 3) of an open Bezier spline."""
    return np.stack([points[:-1], handles[:-1, 1], handles[1:, 0], points[1:]], axis=1)


def along(control: Doubles, share: Doubles) -> tuple[Doubles, Doubles]:
    """Position and unit tangent at shares in [0,1] of the spline's parameter."""
    count = len(control)
    number = np.clip((share * count).astype(int), 0, count - 1)
    t = (share * count - number)[:, None]
    p, s = control[number].transpose(1, 0, 2), 1 - t
    position = s**3 * p[0] + 3 * s**2 * t * p[1] + 3 * s * t**2 * p[2] + t**3 * p[3]
    first = s**2 * (p[1] - p[0]) + 2 * s * t * (p[2] - p[1]) + t**2 * (p[3] - p[2])
    return position, unit(first)


def upright(tangent: Doubles) -> Doubles:
    """Horizontal unit vectors across tangents, z x T."""
    return unit(np.cross([0.0, 0.0, 1.0], tangent))


class MinimumTwist:
    """The frame without twist along a smooth open spline, by rotations in very small steps."""

    STEPS = 60_000

    def __init__(self, control: Doubles) -> None:
        share = np.linspace(0, 1, self.STEPS + 1)
        _, self.tangent = along(control, share)
        normal = upright(self.tangent[:1])[0]
        normals = [normal]
        for i in range(self.STEPS):
            # The midpoint rule's rotation: remove the part along the tangent half way, then at the end.
            middle = self.tangent[i] + self.tangent[i + 1]
            normal = normal - 2 * middle * (middle @ normal) / (middle @ middle)
            normal = normal - 2 * self.tangent[i + 1] * (self.tangent[i + 1] @ normal)
            normals.append(normal)
        self.normal = unit(np.array(normals))

    def at(self, share: Doubles) -> Doubles:
        """Normals at shares, from the nearest step."""
        return self.normal[np.round(share * self.STEPS).astype(int)]


def turned(normal: Doubles, tangent: Doubles, angle: Doubles) -> tuple[Doubles, Doubles]:
    """N and B, turned about the tangent."""
    up = np.cross(tangent, normal)
    c, s = np.cos(angle)[:, None], np.sin(angle)[:, None]
    return normal * c + up * s, up * c - normal * s


def rays_at(targets: Doubles, distance: float, random: np.random.Generator) -> tuple[Doubles, Doubles]:
    """Origins and directions of rays from all around that pass through targets."""
    directions = unit(random.normal(size=targets.shape))
    return targets - directions * distance, directions


def balance(tracer: Any, origins: Doubles, directions: Doubles, step: float, most: int = 64) -> tuple[Any, Any]:
    """(entries minus exits, hits) of rays that are followed through all surfaces; each must end."""
    count = len(origins)
    sums, hits, start = np.zeros(count, int), np.zeros(count, int), np.zeros(count)
    alive = np.arange(count)
    for _ in range(most):
        found = tracer.closest_hits(origins[alive], directions[alive], t_min=start[alive])
        got = found["instance"] >= 0
        side = np.sum(found["facet_normal"].astype(float) * directions[alive], axis=1)
        alive = alive[got]
        sums[alive] -= np.sign(side[got]).astype(int)
        hits[alive] += 1
        start[alive] = found["t"][got] + step
        if len(alive) == 0:
            return sums, hits
    raise AssertionError(f"{len(alive)} rays still hit after {most} facets, the first from {origins[alive[0]]!r}")
