"""Caches, rays and closed forms for the tests of the ray cache."""

from typing import Any

import numpy as np
import rayleaf_rivals
from core import shapes
from numpy.typing import NDArray
from rayleaf import _core

ri_tree = _core.ri_tree
ANSWERS: list[str] = ri_tree.ANSWERS
NOT_A_RAY, BOX_MISSED, CELL_MISSED, INTERPOLATED, TWO_CLASSES, TWO_CLASS_MISSED, FOLLOWED_MISSED = range(7)
FOLLOWED, MANY_CLASSES, FEW_CORNERS, ANGLE, ORIGIN, LARGE_CELL, NOT_WORTH_IT, ERROR = range(7, 15)
# Every array of an answer that describes the output ray.
OUTPUTS = ("hit", "first_class", "exit_class", "interior_hits", "total_reflections", "ending")
OUTPUTS += ("position", "normal", "uv", "exit_position", "exit_direction", "length")
ANY_ANGLE = 4.0  # radians: larger than any angle between directions
Doubles = NDArray[np.float64]


TREES = {"ReferenceTree": rayleaf_rivals.ReferenceTree, "FastTree": ri_tree.FastTree}


def tree_of(shape: Any, kind: str, tree: str = "ReferenceTree", **settings: Any) -> Any:
    """The published tree, with facets so fine that they do not matter."""
    return TREES[tree](shape, kind, **{"facet_tolerance": 2.0**-20, **settings})


def rays_towards(target: Doubles, radius: float, count: int, seed: int = 1, eye: Any = (0.5, -4.0, 1.5)) -> Any:
    """Rays from one eye point towards a ball around a point."""
    random = np.random.default_rng(seed)
    points = target + radius * shapes.random_directions(random, count) * random.uniform(0, 1, (count, 1))
    origins = np.broadcast_to(np.asarray(eye, float), (count, 3)).copy()
    return origins, shapes.unit(points - origins)


def rays_with_steps(scale: float, center: Any) -> Any:
    """Rays towards a body of a size and place, and for each ray two steps of its origin and two of its direction."""
    origins, directions = rays_towards(np.array([0.1, -0.2, 0.1]), 0.6, 300)
    origins = scale * origins + np.asarray(center, float)
    across = np.random.default_rng(5).normal(size=(2, len(origins), 2, 3))
    across -= np.sum(across * directions[:, None], axis=-1)[..., None] * directions[:, None]
    by_origin, by_direction = across * np.array([scale, 1.0]).reshape(2, 1, 1, 1)
    return origins, directions, by_origin, by_direction


def scattered_rays(count: int, seed: int = 1, spread: float = 0.9, distance: float = 4.0) -> Any:
    """Rays from all around towards a ball around the origin."""
    random = np.random.default_rng(seed)
    origins = distance * shapes.random_directions(random, count)
    return origins, shapes.unit(spread * shapes.random_directions(random, count) - origins)


def cuboid(half: Any, center: Any = (0, 0, 0)) -> Any:
    """A box wound outwards."""
    vertices = shapes.CUBE_VERTICES * np.asarray(half, float) + np.asarray(center, float)
    return shapes.trace.TriangleMesh("cuboid", vertices.astype(np.float32), shapes.CUBE_TRIANGLES)


def wedge(angle: float) -> tuple[Any, float]:
    """A prism with a level face at z = 0 and, below it, one tilted by about `angle`; and the angle that its floats have."""
    fall = -2 * np.tan(angle)
    vertices = np.array([[x, y, z] for y in (-1, 1) for x, z in ((-1, 0), (1, 0), (1, fall))]).astype(np.float32)
    triangles = [[0, 2, 1], [3, 4, 5], [0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4], [0, 3, 5], [0, 5, 2]]
    mesh = shapes.trace.TriangleMesh("prism", vertices, np.array(triangles, np.int32))
    return mesh, float(np.arctan2(-vertices[2, 2].astype(float), 2.0))


def square(size: float = 1.0) -> Any:
    """In the xy-plane, facing up."""
    vertices = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], np.float32) * np.float32(size)
    return shapes.trace.TriangleMesh("square", vertices, np.array([[0, 1, 2], [0, 2, 3]], np.int32))


def reflected(directions: Doubles, normals: Doubles) -> Doubles:
    """Mirror directions."""
    return directions - 2 * np.sum(directions * normals, axis=1)[:, None] * normals


def sphere_hit(origins: Doubles, directions: Doubles) -> tuple[Doubles, Doubles]:
    """First hit with the unit sphere, and whether there is one."""
    b = np.sum(origins * directions, axis=1)
    discriminant = b * b - np.sum(origins * origins, axis=1) + 1
    t = -b - np.sqrt(np.maximum(discriminant, 0))
    return origins + t[:, None] * directions, discriminant > 0


def snell(directions: Doubles, normals: Doubles, eta: float) -> Doubles:
    """Refracted directions; normals face the incoming side, eta is its index over the other's."""
    cosine = -np.sum(directions * normals, axis=1)
    beyond = np.sqrt(1 - eta * eta * (1 - cosine * cosine))
    return eta * directions + (eta * cosine - beyond)[:, None] * normals


def through_glass_ball(origins: Doubles, directions: Doubles, ior: float) -> tuple[Doubles, Doubles]:
    """Where and how a ray leaves a unit ball of glass."""
    entry, _ = sphere_hit(origins, directions)
    inside = snell(directions, entry, 1 / ior)
    leaving = entry - 2 * np.sum(entry * inside, axis=1)[:, None] * inside
    return leaving, snell(inside, -leaving, ior)


def cuboid_length(origins: Doubles, directions: Doubles, half: Any) -> Doubles:
    """Length of lines inside a box around the origin, by slabs."""
    half = np.asarray(half, float)
    a, b = (-half - origins) / directions, (half - origins) / directions
    begin, end = np.minimum(a, b).max(axis=1), np.maximum(a, b).min(axis=1)
    return np.maximum(end - begin, 0)


def angles(a: Doubles, b: Doubles) -> Doubles:
    """Angles between unit vectors, radians; accurate for small ones."""
    return 2 * np.arcsin(np.clip(np.linalg.norm(a - b, axis=1) / 2, 0, 1))


def check_same_answers(a: dict[str, Any], b: dict[str, Any]) -> None:
    """Answers are equal bit by bit."""
    for name in (*OUTPUTS, "answered_by", "error"):
        np.testing.assert_array_equal(a[name], b[name], err_msg=name)


def counts(answers: dict[str, Any]) -> dict[str, int]:
    """How often each kind of answer was given, for messages."""
    kinds, numbers = np.unique(answers["answered_by"], return_counts=True)
    return {ANSWERS[kind]: int(number) for kind, number in zip(kinds, numbers)}
