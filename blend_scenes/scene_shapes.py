"""Control points of the scenes for ray caches, by NumPy alone: the scripts here and the benchmarks build from them.

A part is a grid of points (count_v, count_u, 4: x, y, z, weight) and how u and v run. Surfaces face away from their
axis: v runs upwards along a profile, u clockwise seen from above.
"""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

Doubles = NDArray[np.float64]

# Order, cyclic, endpoint, bezier.
BEZIER, CLOSED_BEZIER = (4, False, True, True), (4, True, True, True)
OPEN_SPLINE, CLOSED_SPLINE = (4, False, False, False), (4, True, False, False)
# Where the inner points of a cubic arc lie that is a quarter of a circle to 3 parts in 10 000.
QUARTER = 4 / 3 * (np.sqrt(2) - 1)


@dataclass
class Part:
    """A NURBS grid."""

    points: Doubles
    u: tuple[int, bool, bool, bool] = CLOSED_BEZIER
    v: tuple[int, bool, bool, bool] = BEZIER

    def moved(self, matrix: Doubles, offset: Doubles) -> "Part":
        """The same grid after a linear map and a translation."""
        points = self.points.copy()
        points[..., :3] = points[..., :3] @ matrix.T + offset
        return Part(points, self.u, self.v)

    def turned_inside_out(self) -> "Part":
        """The same surface that faces the other way."""
        return Part(self.points[::-1].copy(), self.u, self.v)


def with_weights(points: Doubles) -> Doubles:
    """Points (..., 3) with weight 1."""
    return np.concatenate([points, np.ones((*points.shape[:-1], 1))], axis=-1)


def bezier_from_cubic_b_spline(points: Doubles, axis: int) -> Doubles:
    """Bezier points of a uniform cubic B-spline along an axis: n + 3 points become 3 n + 1, the curve stays.

    The Bezier points of a span are thirds and the mean of thirds of its neighbours (Böhm's knot insertion).
    """
    p = np.moveaxis(points, axis, 0)
    spans = len(p) - 3
    result = np.empty((3 * spans + 1, *p.shape[1:]))
    result[0::3] = (p[:-2] + 4 * p[1:-1] + p[2:]) / 6
    result[1::3] = (2 * p[1:-2] + p[2:-1]) / 3
    result[2::3] = (p[1:-2] + 2 * p[2:-1]) / 3
    return np.moveaxis(result, 0, axis)


def turned(profile: Doubles) -> Part:
    """Bezier points of a profile (3 n + 1, 2: radius, height) turned about z in four cubic arcs."""
    k = QUARTER
    around = np.array([(1, 0), (1, -k), (k, -1), (0, -1), (-k, -1), (-1, -k)])
    around = np.concatenate([around, -around])
    points = np.empty((len(profile), 12, 3))
    points[..., :2] = profile[:, :1, None] * around[None]
    points[..., 2] = profile[:, 1:]
    return Part(with_weights(points))


def smooth_profile(control: Doubles) -> Doubles:
    """Bezier points of a cubic spline of a half silhouette (n, 2) whose ends lie on the axis and are mirrored there."""
    control = control.copy()
    control[[0, -1], 0] = 0
    mirror = np.array([-1, 1])
    whole = np.concatenate([control[1:2] * mirror, control, control[-2:-1] * mirror])
    profile = bezier_from_cubic_b_spline(whole, 0)
    profile[[0, -1], 0] = 0  # the poles, exactly
    return profile


# --- random volumes ------------------------------------------------------------------------------------------------


def random_cells(random: np.random.Generator, low: Doubles, high: Doubles, count: int) -> list[tuple[Doubles, Doubles]]:
    """A box cut into so many cells by random planes, across the longest side each time."""
    if count == 1:
        return [(low, high)]
    axis = int(np.argmax(high - low))
    first = count // 2
    share = np.clip(random.normal(first / count, 0.08), 0.3, 0.7)
    cut = low[axis] + share * (high[axis] - low[axis])
    middle_high, middle_low = high.copy(), low.copy()
    middle_high[axis] = middle_low[axis] = cut
    return random_cells(random, low, middle_high, first) + random_cells(random, middle_low, high, count - first)


def random_rotation(random: np.random.Generator) -> Doubles:
    """A rotation, all equally likely."""
    basis, triangle = np.linalg.qr(random.normal(size=(3, 3)))
    basis = basis * np.sign(np.diag(triangle))
    return basis if np.linalg.det(basis) > 0 else -basis


def convex_body(random: np.random.Generator) -> Part:
    """A convex body of revolution: 5 to 16 cubic curves along its silhouette, four patches around each."""
    curves = int(random.integers(5, 17))
    gaps = random.uniform(0.5, 1.5, curves)
    angles = np.concatenate([[0], np.cumsum(gaps)]) / gaps.sum() * np.pi - np.pi / 2
    # Points of a superellipse make a convex polygon, and a B-spline lies on the inner side of a convex one.
    power = 2 / random.uniform(1.5, 4.0)
    radius, height = random.uniform(0.45, 1.0), random.uniform(0.45, 1.0)
    control = np.stack(
        [
            radius * np.abs(np.cos(angles)) ** power,
            height * np.sign(np.sin(angles)) * np.abs(np.sin(angles)) ** power,
        ],
        axis=1,
    )
    return turned(smooth_profile(control))


def random_volumes(seed: int, count: int = 6, side: float = 6.0) -> list[Part]:
    """Bodies in the cells of a cube around the origin, none touching another."""
    random = np.random.default_rng(seed)
    half = np.full(3, side / 2)
    bodies = []
    for low, high in random_cells(random, -half, half, count):
        body = convex_body(random).moved(random_rotation(random), np.zeros(3))
        points = body.points[..., :3].reshape(-1, 3)
        size = points.max(axis=0) - points.min(axis=0)
        scale = 0.92 * np.min((high - low) / size)
        middle = (points.max(axis=0) + points.min(axis=0)) / 2
        bodies.append(body.moved(np.eye(3) * scale, (low + high) / 2 - scale * middle))
    return bodies


# --- sheets, vases, tomatoes ---------------------------------------------------------------------------------------


def waved_sheet(patches: int = 10, side: float = 10.0) -> Part:
    """A sheet of patches x patches, smooth to the second derivative, with waves of about a third of a unit."""
    place = (np.arange(patches + 3) - 1) * side / patches - side / 2
    x, y = np.meshgrid(place, place)
    z = 0.35 * np.sin(0.9 * x + 0.4) * np.cos(0.8 * y) + 0.1 * np.sin(1.7 * y - 0.6 * x)
    return Part(with_weights(np.stack([x, y, z], axis=2)), OPEN_SPLINE, OPEN_SPLINE)


def gentle_body() -> Part:
    """A closed body of revolution with a gentle waist: not convex, and yet no ray runs through it wildly."""
    radius = np.array([0, 1.05, 1.5, 1.42, 1.3, 1.32, 1.45, 1.4, 0.9, 0])
    height = np.array([-2.0, -2.0, -1.6, -0.8, 0.0, 0.7, 1.3, 1.8, 2.1, 2.1])
    return turned(smooth_profile(np.stack([radius, height], axis=1)))


def chaotic_vase() -> list[Part]:
    """A strongly curved outside around a closed cavity of air; the cavity's surface faces into it."""
    radius = np.array([0, 0.8, 1.5, 1.7, 0.7, 0.5, 1.2, 1.7, 1.0, 0.45, 0.9, 0.6, 0])
    height = np.array([-2.4, -2.4, -2.1, -1.5, -1.0, -0.5, 0.0, 0.6, 1.1, 1.5, 2.0, 2.4, 2.4])
    outside = turned(smooth_profile(np.stack([radius, height], axis=1)))
    inner_radius = np.array([0, 0.3, 0.75, 0.9, 0.6, 0.25, 0])
    inner_height = np.array([-0.35, -0.35, 0.0, 0.5, 0.85, 1.0, 1.0])
    cavity = turned(smooth_profile(np.stack([inner_radius, inner_height], axis=1)))
    return [outside, cavity.turned_inside_out()]


def ball(radius: float, center: Any) -> Part:
    """A sphere of 4 x 2 bicubic patches."""
    k = QUARTER
    profile = np.array([(0, -1), (k, -1), (1, -k), (1, 0), (1, k), (k, 1), (0, 1)], float)
    return turned(radius * profile).moved(np.eye(3), np.asarray(center, float))


def bowl(radius: float = 2.4, depth: float = 1.5, thickness: float = 0.09) -> Part:
    """A bowl that stands on z = 0: foot, outside, rim and inside in one closed profile."""
    r, d, t = radius, depth, thickness
    outside = [(0, 0), (0.3 * r, 0), (0.42 * r, 0.02 * d), (0.7 * r, 0.22 * d), (0.93 * r, 0.6 * d), (r, d)]
    rim = [(r + 0.3 * t, d + t), (r - 0.5 * t, d + 1.4 * t), (r - 1.2 * t, d + 0.6 * t)]
    inside = [
        (0.93 * r - t, 0.62 * d),
        (0.7 * r - 0.8 * t, 0.24 * d + t),
        (0.4 * r, t + 0.05 * d),
        (0.2 * r, t),
        (0, t),
    ]
    return turned(smooth_profile(np.array(outside + rim + inside)))


def tomato(radius: float = 0.8, lobes: int = 5) -> Part:
    """A lobed ball with a dimple on top, all of B-splines; it stands on z = 0."""
    profile = np.array([(0, 0.12), (0.45, 0.0), (0.95, 0.25), (1.14, 0.8), (0.95, 1.35), (0.5, 1.55), (0.17, 1.36)])
    profile = np.concatenate([profile, [(0, 1.2)]])
    whole = smooth_profile(profile)
    count = 4 * lobes
    angle = -2 * np.pi * np.arange(count) / count
    points = np.empty((len(whole), count, 3))
    # Flat towards the poles, so that they are points.
    swell = 1 + 0.055 * np.cos(lobes * angle)[None] * np.minimum(whole[:, :1] / 0.6, 1)
    points[..., 0] = radius * whole[:, :1] * swell * np.cos(angle)
    points[..., 1] = radius * whole[:, :1] * swell * np.sin(angle)
    points[..., 2] = radius * whole[:, 1:]
    return Part(with_weights(points), CLOSED_SPLINE, BEZIER)


def plastic_wrap(rim: float = 2.5, side: float = 6.2, patches: int = 10) -> Part:
    """A sheet that lies on a bowl's rim at z = 0: it sags inside, falls outside, and is crumpled a little."""
    place = (np.arange(patches + 3) - 1) / patches * side - side / 2
    x, y = np.meshgrid(place, place)
    far = np.hypot(x, y)
    crumple = 0.035 * np.sin(2.4 * x + 1.3 * y) + 0.03 * np.sin(3.1 * y - 1.7 * x + 1) + 0.02 * np.cos(4.0 * x + 2)
    fall = 0.35 * np.logaddexp(0, (far - rim) / 0.35)
    z = crumple - 0.08 * np.exp(-((far / 1.5) ** 2)) - 0.55 * fall
    return Part(with_weights(np.stack([x, y, z], axis=2)), OPEN_SPLINE, OPEN_SPLINE)


def table(side: float = 26.0) -> Part:
    """A flat square of one patch in the plane z = 0."""
    place = (np.arange(4) / 3 - 0.5) * side
    x, y = np.meshgrid(place, place)
    return Part(with_weights(np.stack([x, y, np.zeros_like(x)], axis=2)), BEZIER, BEZIER)


@dataclass
class TomatoScene:
    """The parts by what they are, where they lie."""

    bowl: Part = field(default_factory=bowl)
    table: Part = field(default_factory=table)
    wrap: Part = field(default_factory=lambda: plastic_wrap().moved(np.eye(3), np.array([0, 0, 1.86])))
    beside: Part = field(default_factory=lambda: tomato().moved(np.eye(3), np.array([3.3, -1.5, 0.0])))
    in_bowl: list[Part] = field(default_factory=lambda: [ball(radius, center) for radius, center in BALLS])


# Radius and middle of the tomatoes in the bowl.
BALLS = (
    (0.62, (0.0, 0.1, 0.80)),
    (0.55, (1.15, 0.25, 1.02)),
    (0.58, (-1.15, 0.3, 1.05)),
    (0.55, (0.45, -1.1, 1.02)),
    (0.5, (-0.75, -0.95, 1.0)),
    (0.56, (0.35, 1.25, 1.06)),
    (0.42, (-0.45, 1.2, 0.95)),
)
