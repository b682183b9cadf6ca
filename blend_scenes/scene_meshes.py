"""Meshes of the scenes that are compared with Cycles: fine enough that neither engine shows facets."""

from collections.abc import Sequence
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray
from scene_tools import Triple, link


def _add(name: str, vertices: Any, faces: Any, look: Any, location: Triple) -> Any:
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(vertices, [], faces)
    mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))
    if look is not None:
        mesh.materials.append(look)
    return link(name, mesh, location)


def rounded(profile: Sequence[Sequence[float]], per_piece: int = 5) -> NDArray[np.float64]:
    """Points of the uniform cubic B-spline of a profile, which begins and ends at the profile's ends."""
    points = np.array(profile, float)
    points = np.concatenate([[2 * points[0] - points[1]], points, [2 * points[-1] - points[-2]]])
    t = np.arange(per_piece)[:, None] / per_piece
    weights = np.stack([(1 - t) ** 3, 3 * t**3 - 6 * t**2 + 4, -3 * t**3 + 3 * t**2 + 3 * t + 1, t**3]) / 6
    pieces = [sum(weights[k] * points[i + k] for k in range(4)) for i in range(len(points) - 3)]
    return np.concatenate([*pieces, np.array(profile[-1:], float)])


def add_turned(name: str, profile: Any, look: Any, location: Triple = (0, 0, 0), segments: int = 64) -> Any:
    """A profile (n, 2: radius, height), from the axis below round the outside to the axis above, turned about z: closed."""
    angle = np.arange(segments) * 2 * np.pi / segments
    inner = np.array(profile, float)[1:-1]
    x, y = (inner[:, :1] * turn[None] for turn in (np.cos(angle), np.sin(angle)))
    rings = np.stack([x, y, np.broadcast_to(inner[:, 1:], x.shape)], axis=2)
    ends = [(0.0, 0.0, profile[0][1]), (0.0, 0.0, profile[-1][1])]
    vertices = [*ends, *map(tuple, rings.reshape(-1, 3))]

    def at(ring: int, segment: int) -> int:
        return 2 + ring * segments + segment % segments

    last = len(inner) - 1
    faces = [(0, at(0, s + 1), at(0, s)) for s in range(segments)] + [
        (1, at(last, s), at(last, s + 1)) for s in range(segments)
    ]
    faces += [(at(r, s), at(r, s + 1), at(r + 1, s + 1), at(r + 1, s)) for r in range(last) for s in range(segments)]
    return _add(name, vertices, faces, look, location)


def add_ball(name: str, radius: float, look: Any, location: Triple, scale: Triple = (1, 1, 1)) -> Any:
    """A sphere, whose object may be stretched."""
    turn = np.linspace(0, np.pi, 33)
    ball = add_turned(name, radius * np.stack([np.sin(turn), -np.cos(turn)], 1), look, location)
    ball.scale = scale
    return ball


def add_box(name: str, size: Triple, look: Any, location: Triple) -> Any:
    """A box around its location, flat."""
    corners = [[(i >> axis & 1) * size[axis] - size[axis] / 2 for axis in range(3)] for i in range(8)]
    faces = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    box = _add(name, corners, faces, look, location)
    box.data.polygons.foreach_set("use_smooth", [False] * 6)
    return box
