"""Control points of a small car, by NumPy alone, for the parking lot and the street.

The car stands on z = 0 around the origin, its nose towards +x: about 3.9 long, 1.6 wide, 1.4 high. All of it is cubic
splines. A detail of d gives the body d times as many patches each way, and the same shape.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scene_shapes import (
    BEZIER,
    CLOSED_SPLINE,
    OPEN_SPLINE,
    Part,
    ball,
    bezier_from_cubic_b_spline,
    smooth_profile,
    turned,
    with_weights,
)

Doubles = NDArray[np.float64]
Parts = dict[str, list[Part]]

WHEEL_RADIUS, WHEEL_X, WHEEL_Y = 0.3, 1.2, 0.67
TAIL, NOSE = -1.95, 1.95
CABIN_BACK, CABIN_FRONT = -1.5, 0.98
# Along x: half the body's width, its underside and its top; half the cabin's width at the belt, and its top.
WIDTH = [(-1.95, 0.56), (-1.7, 0.76), (-0.9, 0.82), (0.9, 0.82), (1.6, 0.77), (1.95, 0.52)]
UNDERSIDE = [(-1.95, 0.36), (-1.6, 0.18), (1.6, 0.16), (1.95, 0.3)]
TOP = [(-1.95, 0.66), (-1.7, 0.84), (-1.0, 0.9), (0.8, 0.88), (1.5, 0.76), (1.95, 0.52)]
CABIN_WIDTH = [(-1.5, 0.5), (-1.1, 0.66), (0.5, 0.68), (0.98, 0.56)]
CABIN_TOP = [(-1.5, 0.8), (-1.1, 1.24), (-0.6, 1.44), (0.1, 1.45), (0.4, 1.32), (0.98, 0.82)]
CABIN_FLOOR = 0.7


def add_to(parts: Parts, more: Parts) -> None:
    """Append what is of the same material."""
    for kind, made in more.items():
        parts.setdefault(kind, []).extend(made)


def along(x: Doubles, table: list[tuple[float, float]]) -> Doubles:
    """The value at x of a table of (x, value), its corners rounded."""
    places, values = np.array(table).T
    spread = np.linspace(-0.16, 0.16, 17)
    weights = np.cos(spread / 0.17 * np.pi / 2) ** 2
    return np.asarray((np.interp(x[..., None] + spread, places, values) * weights).sum(axis=-1) / weights.sum())


def squared(angle: Doubles, power: float) -> tuple[Doubles, Doubles]:
    """Points at these angles of a superellipse with half axes 1: round for power 2, squarer for more."""
    c, s = np.cos(angle), np.sin(angle)
    return np.sign(c) * np.abs(c) ** (2 / power), np.sign(s) * np.abs(s) ** (2 / power)


def on_body(x: Doubles, angle: Doubles) -> Doubles:
    """Points of the body: angle 0 is the right side, a quarter turn the top."""
    y, z = squared(angle, 4.0)
    low, high = along(x, UNDERSIDE), along(x, TOP)
    points = np.broadcast_arrays(x, along(x, WIDTH) * y, (low + high) / 2 + (high - low) / 2 * z)
    return np.stack(points, axis=-1)


def on_cabin(x: Doubles, angle: Doubles) -> Doubles:
    """Points of the cabin, narrower towards the roof; angles as on the body."""
    y, z = squared(angle, 3.0)
    high = along(x, CABIN_TOP)
    narrow = 1 - 0.22 * np.maximum(z, 0)
    points = np.broadcast_arrays(
        x, along(x, CABIN_WIDTH) * narrow * y, CABIN_FLOOR + np.maximum(high - CABIN_FLOOR, 0.05) * z
    )
    return np.stack(points, axis=-1)


def closed_body(rings: Doubles) -> Part:
    """A closed smooth surface through rings of points (n, columns, 3); the first and the last ring are one point each."""
    before, behind = (2 * ring.mean(axis=0) - ring for ring in (rings[1], rings[-2]))
    bezier = bezier_from_cubic_b_spline(np.concatenate([before[None], rings, behind[None]]), 0)
    bezier[[0, -1]] = bezier[[0, -1]].mean(axis=1)[:, None]  # exactly
    return Part(with_weights(bezier), CLOSED_SPLINE, BEZIER)


def shell(place: Callable[[Doubles, Doubles], Doubles], back: float, front: float, rows: int, columns: int) -> Part:
    """The closed surface of `on_body` or `on_cabin` between two x, closer rows towards the ends."""
    x = (front + back) / 2 - (front - back) / 2 * np.cos(np.linspace(0, np.pi, rows + 1)[:, None])
    rings = place(x, -np.arange(columns)[None] / columns * 2 * np.pi)
    rings[[0, -1]] = rings[[0, -1]].mean(axis=1)[:, None]
    return closed_body(rings)


def panel(place: Callable[[Doubles, Doubles], Doubles], x: Doubles, angle: Doubles, lift: float) -> Part:
    """A sheet over a part of the surface, lifted off it."""
    x, angle = x[:, None], angle[None]
    points = place(x, angle)
    middle = np.array([0.0, 0.0, CABIN_FLOOR])
    outward = (points - middle) * np.array([0.2, 1.0, 1.0])
    points += lift * outward / np.linalg.norm(outward, axis=-1)[..., None]
    return Part(with_weights(points[::-1]), OPEN_SPLINE, OPEN_SPLINE)


def tube(path: Doubles, radius: float, columns: int = 8) -> Part:
    """A round tube with round ends along points (n, 3) that never run straight up."""
    direction = np.gradient(path, axis=0)
    direction /= np.linalg.norm(direction, axis=1)[:, None]
    side = np.cross(direction, np.array([0.0, 0.0, 1.0]))
    side /= np.linalg.norm(side, axis=1)[:, None]
    up = np.cross(side, direction)
    # The ends: half a ball of two rings and a tip each.
    steps = np.array([-1.0, -0.85, *np.zeros(len(path)), 0.85, 1.0]) * radius
    sizes = np.array([0.0, 0.6, *np.ones(len(path)), 0.6, 0.0]) * radius
    index = np.array([0, 0, *range(len(path)), len(path) - 1, len(path) - 1])
    middle = path[index] + steps[:, None] * direction[index]
    angle = -np.arange(columns) / columns * 2 * np.pi
    ring = np.cos(angle)[:, None] * side[index, None] + np.sin(angle)[:, None] * up[index, None]
    return closed_body(middle[:, None] + sizes[:, None, None] * ring)


def torus(radius: float, thickness: float, columns: int, around: int = 10) -> Part:
    """A ring about the y axis, of B-splines both ways; `radius` is that of its middle line."""
    u, v = np.meshgrid(-np.arange(columns) / columns * 2 * np.pi, np.arange(around) / around * 2 * np.pi)
    far = radius + thickness * np.cos(v)
    points = np.stack([far * np.cos(u), thickness * np.sin(v), far * np.sin(u)], axis=-1)
    return Part(with_weights(points), CLOSED_SPLINE, CLOSED_SPLINE)


def about_y(profile: list[tuple[float, float]]) -> Part:
    """A closed body turned about the y axis; the profile is (radius, y), upwards."""
    quarter = np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]])
    return turned(smooth_profile(np.array(profile))).moved(quarter.T, np.zeros(3))


def ellipsoid(middle: tuple[float, float, float], axes: tuple[float, float, float]) -> Part:
    """A ball pulled along the axes."""
    return ball(1.0, (0, 0, 0)).moved(np.diag(axes), np.array(middle))


def wheels(detail: int) -> Parts:
    """Four wheels in their arches, by material."""
    parts: Parts = {"rubber": [], "chrome": [], "shade": [], "paint": []}
    tread = torus(WHEEL_RADIUS - 0.09, 0.1, 16 * detail)
    rim = about_y([(0, -0.02), (0.05, -0.03), (0.1, 0.0), (0.19, 0.03), (0.2, 0.07), (0.1, 0.09), (0, 0.09)])
    drum = about_y([(0, -0.2), (0.36, -0.2), (0.385, -0.18), (0.385, 0.1), (0.37, 0.125), (0, 0.125)])
    angle = np.linspace(-0.12, np.pi + 0.12, 12 * detail)
    for x in (-WHEEL_X, WHEEL_X):
        for side in (-1.0, 1.0):
            matrix = np.diag([1.0, side, 1.0])
            place = np.array([x, side * WHEEL_Y, WHEEL_RADIUS])
            for kind, part in (("rubber", tread), ("chrome", rim), ("shade", drum)):
                # Mirrored, a part would face inwards.
                moved = part.moved(matrix, place)
                parts[kind].append(moved if side > 0 else moved.turned_inside_out())
            lip = np.stack(
                [x + 0.39 * np.cos(angle), 0 * angle + side * 0.8, WHEEL_RADIUS + 0.39 * np.sin(angle)], axis=1
            )
            parts["paint"].append(arch(lip, 0.035))
    return parts


def arch(path: Doubles, radius: float) -> Part:
    """A tube that may run straight up, in a plane of about constant y."""
    turn = np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]])
    return tube(path @ turn.T, radius).moved(turn.T, np.zeros(3))


def seam(x: float, first: float, last: float) -> Part:
    """A dark line across the body's side, between two angles."""
    angle = np.linspace(first, last, 10)
    path = on_body(np.full(10, x), angle)
    return tube(path + np.array([0.02, 0, 0]) * np.linspace(-1, 1, 10)[:, None], 0.009, 6)


def trim() -> Parts:
    """Bumpers, lights, mirrors, handles, grille and seams, by material."""
    parts: Parts = {"chrome": [], "lamp": [], "tail lamp": [], "shade": [], "paint": []}
    y = np.linspace(-1, 1, 13)
    front = np.stack([NOSE + 0.06 - 0.42 * np.abs(y) ** 3, 0.72 * y, 0.4 + 0 * y], axis=1)
    back = np.stack([TAIL - 0.06 + 0.36 * np.abs(y) ** 3, 0.74 * y, 0.44 + 0 * y], axis=1)
    parts["chrome"] += [tube(front, 0.055), tube(back, 0.055)]
    for height in (0.47, 0.52, 0.57):
        bar = np.stack([NOSE - 0.02 - 0.1 * np.abs(y) ** 2, 0.3 * y, height + 0 * y], axis=1)
        parts["chrome"].append(tube(bar, 0.012, 6))
    for side in (-1.0, 1.0):
        socket = torus(0.125, 0.022, 12).moved(
            np.array([[0, 1.0, 0], [-1, 0, 0], [0, 0, 1]]), np.array([1.78, side * 0.5, 0.6])
        )
        parts["chrome"].append(socket)
        parts["lamp"].append(ellipsoid((1.77, side * 0.5, 0.6), (0.06, 0.12, 0.12)))
        parts["tail lamp"].append(ellipsoid((-1.77, side * 0.56, 0.66), (0.06, 0.07, 0.12)))
        parts["paint"].append(ellipsoid((0.6, side * 0.8, 0.93), (0.06, 0.1, 0.07)))
        handle = np.stack([np.linspace(-0.45, -0.25, 6), np.full(6, side * 0.81), np.full(6, 0.74)], axis=1)
        parts["chrome"].append(tube(handle, 0.014, 6))
        for x in (-0.55, 0.55):
            ends = (-0.75, 0.7) if side > 0 else (np.pi + 0.75, np.pi - 0.7)
            parts["shade"].append(seam(x, *ends))
    exhaust = np.stack([np.linspace(-2.02, -1.7, 5), np.full(5, -0.4), np.full(5, 0.24)], axis=1)
    parts["chrome"].append(tube(exhaust, 0.03, 8))
    return parts


def pillars() -> list[Part]:
    """Between the windows, from the body up to the roof."""
    made = []
    for x0, x1 in ((0.93, 0.22), (-0.42, -0.42), (-1.4, -0.82)):
        for side in (1, -1):
            angle = np.linspace(0.1, 0.95, 9)
            x = np.linspace(x0, x1, 9)
            made.append(tube(on_cabin(x, angle if side > 0 else np.pi - angle), 0.035))
    return made


def car(detail: int = 1) -> Parts:
    """The parts by material: paint, glass, chrome, rubber, shade, lamp, tail lamp."""
    parts: Parts = {
        "paint": [shell(on_body, TAIL, NOSE, 22 * detail, 28 * detail), *pillars()],
        "glass": [shell(on_cabin, CABIN_BACK, CABIN_FRONT, 18 * detail, 24 * detail)],
    }
    x, angle = np.linspace(-1.05, 0.3, 10 * detail), np.linspace(0.55, np.pi - 0.55, 12 * detail)
    parts["paint"].append(panel(on_cabin, x, angle, 0.022))
    add_to(parts, wheels(detail))
    add_to(parts, trim())
    return parts
