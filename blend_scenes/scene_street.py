"""Control points of houses, lamps and pavements, by NumPy alone. A street runs along x; its houses face -y.

A house stands with the middle of its front on the origin, reaches back along +y, and is `storeys` high.
"""

import numpy as np
from numpy.typing import NDArray
from scene_cars import Parts, add_to, ellipsoid, tube
from scene_shapes import (
    BEZIER,
    CLOSED_SPLINE,
    OPEN_SPLINE,
    Part,
    smooth_profile,
    turned,
    with_weights,
)

Doubles = NDArray[np.float64]

STOREY, DEPTH = 3.1, 7.0


def flat(middle: Doubles, right: Doubles, up: Doubles) -> Part:
    """A flat rectangle of one patch; `right` and `up` reach from its middle to its sides. It faces right x up."""
    place = np.linspace(-1, 1, 4)
    u, v = np.meshgrid(place, place)
    return Part(with_weights(middle + u[..., None] * right + v[..., None] * up), BEZIER, BEZIER)


def box(low: tuple[float, float, float], high: tuple[float, float, float]) -> list[Part]:
    """Six rectangles that face outwards."""
    middle, half = (np.array(low) + np.array(high)) / 2, np.diag((np.array(high) - np.array(low)) / 2)
    sides = []
    for axis in range(3):
        first, second = half[(axis + 1) % 3], half[(axis + 2) % 3]
        sides += [flat(middle + half[axis], first, second), flat(middle - half[axis], second, first)]
    return sides


def moulding(profile: list[tuple[float, float]], length: float, place: tuple[float, float, float]) -> Part:
    """A profile of (-y, z), rounded at its corners, drawn along x through `place`."""
    points = np.array(profile)
    points = np.concatenate([2 * points[:1] - points[1:2], points, 2 * points[-1:] - points[-2:-1]])
    x = np.linspace(-0.5, 0.5, 4) * length * 3  # of a uniform spline of four points the middle third is drawn
    grid = np.empty((len(points), 4, 3))
    grid[..., 0] = x
    grid[..., 1], grid[..., 2] = -points[:, :1], points[:, 1:]
    return Part(with_weights(grid + np.array(place)), OPEN_SPLINE, OPEN_SPLINE)


def frame(width: float, height: float, thickness: float, place: tuple[float, float, float]) -> Part:
    """A rectangular frame in a plane of constant y, its corners and its section round."""
    w, h = width / 2, height / 2
    corner = min(w, h) * 0.2
    line = [(w, -h + corner), (w, 0), (w, h - corner), (w, h), (w - corner, h), (0, h), (corner - w, h), (-w, h)]
    line += [
        (-w, h - corner),
        (-w, 0),
        (-w, corner - h),
        (-w, -h),
        (corner - w, -h),
        (0, -h),
        (w - corner, -h),
        (w, -h),
    ]
    around = np.arange(8) / 8 * 2 * np.pi
    scale = 1 + thickness * np.cos(around)[:, None] / np.array([[w], [h]]).mean()
    path = np.array(line[::-1])
    points = np.empty((8, len(path), 3))
    points[..., 0], points[..., 2] = scale * path[:, 0], scale * path[:, 1]
    points[..., 1] = thickness * np.sin(around)[:, None]
    return Part(with_weights(points + np.array(place)), CLOSED_SPLINE, CLOSED_SPLINE)


def window(x: float, z: float, wide: float, high: float, shutters: bool) -> Parts:
    """A window in the wall y = 0: a frame around panes, a sill below."""
    y = np.array([0.0, -1.0, 0.0])
    made: Parts = {
        "pane": [flat(np.array([x, 0, z]) + 0.012 * y, np.array([wide / 2, 0, 0]), np.array([0, 0, high / 2]))]
    }
    bars = [np.array([[x, -0.03, z - high / 2], [x, -0.035, z], [x, -0.03, z + high / 2]])]
    bars.append(
        np.array(
            [
                [x - wide / 2, -0.03, z + 0.15 * high],
                [x, -0.035, z + 0.15 * high],
                [x + wide / 2, -0.03, z + 0.15 * high],
            ]
        )
    )
    made["stone"] = [
        frame(wide + 0.12, high + 0.12, 0.07, (x, -0.02, z)),
        tube(bars[1], 0.025, 6),
        upright(bars[0], 0.025),
    ]
    sill = np.array(
        [
            [x - 0.6 * wide, -0.1, z - high / 2 - 0.1],
            [x, -0.1, z - high / 2 - 0.1],
            [x + 0.6 * wide, -0.1, z - high / 2 - 0.1],
        ]
    )
    made["stone"].append(tube(sill, 0.07))
    if shutters:
        made["shutter"] = []
        for side in (-1, 1):
            middle = x + side * (wide * 0.78 + 0.05)
            made["shutter"] += box((middle - wide / 4, -0.06, z - high / 2), (middle + wide / 4, -0.001, z + high / 2))
            for slat in np.linspace(z - 0.42 * high, z + 0.42 * high, 8):
                ends = np.array(
                    [[middle - 0.2 * wide, -0.065, slat], [middle, -0.065, slat], [middle + 0.2 * wide, -0.065, slat]]
                )
                made["shutter"].append(tube(ends, 0.018, 6))
    return made


def upright(path: Doubles, radius: float) -> Part:
    """A tube that may run straight up."""
    turn = np.array([[0.0, 1, 0], [0, 0, 1], [1, 0, 0]])
    return tube(path @ turn.T, radius, 6).moved(turn.T, np.zeros(3))


def balcony(x: float, z: float, wide: float) -> Parts:
    """A slab with a railing."""
    made: Parts = {"stone": box((x - wide / 2, -0.9, z - 0.14), (x + wide / 2, 0, z)), "iron": []}
    left, right, out = x - wide / 2 + 0.06, x + wide / 2 - 0.06, -0.84
    corners = [
        (left, -0.05),
        (left, out + 0.1),
        (left + 0.03, out),
        (x, out),
        (right - 0.03, out),
        (right, out + 0.1),
        (right, -0.05),
    ]
    for height in (0.12, 0.95):
        made["iron"].append(tube(np.array([(*corner, z + height) for corner in corners]), 0.025, 6))
    for place in np.linspace(left, right, int(wide / 0.13)):
        made["iron"].append(upright(np.array([(place, out, z), (place, out, z + 0.5), (place, out, z + 0.95)]), 0.012))
    return made


def house(random: np.random.Generator, width: float, storeys: int, windows: int) -> Parts:
    """A house by material: wall, stone, pane, shutter, iron, roof, door."""
    height = storeys * STOREY + 0.5
    made: Parts = {"wall": box((-width / 2, 0, 0), (width / 2, DEPTH, height)), "stone": [], "roof": [], "door": []}
    cornice = [
        (0.0, -0.5),
        (0.06, -0.5),
        (0.1, -0.3),
        (0.12, -0.25),
        (0.3, -0.18),
        (0.42, -0.05),
        (0.46, 0.0),
        (0.46, 0.1),
        (0.0, 0.14),
    ]
    made["stone"].append(moulding(cornice, width, (0, 0, height)))
    plinth = [(0.0, 0.62), (0.1, 0.6), (0.12, 0.55), (0.12, 0.3), (0.12, 0.0)]
    made["stone"].append(moulding(plinth[::-1], width, (0, 0, 0)))
    for storey in range(1, storeys):
        band = [(0.0, -0.1), (0.05, -0.1), (0.09, 0.0), (0.05, 0.1), (0.0, 0.1)]
        made["stone"].append(moulding(band, width, (0, 0, storey * STOREY + 0.3)))
    eaves = [(0.46, 0.12), (0.4, 0.3), (0.1, 1.1), (-0.6, 1.7), (-2.2, 2.2), (-DEPTH / 2, 2.4), (-DEPTH, 2.0)]
    made["roof"].append(moulding(eaves, width, (0, 0, height)))
    shutters, porch = bool(random.integers(2)), int(random.integers(windows))
    places = (np.arange(windows) + 0.5) / windows * width - width / 2
    railed = int(random.integers(1, storeys)) if storeys > 2 else 0
    for storey in range(storeys):
        for index, x in enumerate(places):
            z = storey * STOREY + 1.9
            if storey == 0 and index == porch:
                add_to(made, entrance(float(x)))
                continue
            add_to(made, window(float(x), z, 0.95, 1.7, shutters and storey > 0))
            if railed and storey == railed:
                add_to(made, balcony(float(x), storey * STOREY + 0.75, 1.5))
    return made


def entrance(x: float) -> Parts:
    """A door in a frame, with two steps and a knob."""
    made: Parts = {
        "door": box((x - 0.5, -0.05, 0.3), (x + 0.5, 0, 2.55)),
        "stone": [frame(1.14, 2.4, 0.09, (x, -0.03, 1.5))],
    }
    made["stone"] += box((x - 0.8, -0.75, 0), (x + 0.8, 0, 0.15)) + box((x - 0.7, -0.4, 0.15), (x + 0.7, 0, 0.3))
    for z in (0.85, 1.85):
        made["stone"].append(frame(0.62, 0.7, 0.03, (x, -0.06, z)))
    made["iron"] = [ellipsoid((x + 0.38, -0.1, 1.35), (0.04, 0.05, 0.04))]
    return made


def lamp_post(height: float = 4.6) -> Parts:
    """A turned post with a bent arm towards -y and a globe."""
    profile = [(0, 0), (0.2, 0), (0.2, 0.12), (0.12, 0.3), (0.09, 0.5), (0.1, 0.62), (0.06, 0.75), (0.05, 2.0)]
    profile += [(0.045, height - 0.9), (0.07, height - 0.8), (0.04, height - 0.7), (0.035, height), (0, height)]
    angle = np.linspace(0, 0.75 * np.pi, 9)
    arm = np.stack([0 * angle, -0.45 * (1 - np.cos(angle)), height - 0.1 + 0.45 * np.sin(angle)], axis=1)
    globe = ellipsoid((0.0, -0.77, height + 0.02), (0.2, 0.2, 0.2))
    turn = np.array([[0.0, 1, 0], [0, 0, 1], [1, 0, 0]])
    return {
        "iron": [turned(smooth_profile(np.array(profile))), tube(arm @ turn.T, 0.03).moved(turn.T, np.zeros(3))],
        "globe": [globe],
    }


def bollard() -> Parts:
    """A low turned post."""
    profile = [(0, 0), (0.11, 0), (0.1, 0.1), (0.07, 0.2), (0.065, 0.6), (0.09, 0.68), (0.08, 0.78), (0, 0.84)]
    return {"iron": [turned(smooth_profile(np.array(profile)))]}


def awning(width: float) -> Part:
    """A striped cloth that hangs from the wall, its edge in waves."""
    x = np.linspace(-width / 2, width / 2, 26)
    down = np.linspace(0, 1, 7)[:, None]
    wave = np.cos(np.arange(26) * 2 * np.pi / 4)[None] * down**2
    points = np.stack(
        np.broadcast_arrays(x[None], -1.25 * down - 0.02 * wave, -0.55 * down - 0.25 * down**6 + 0.05 * wave), axis=-1
    )
    return Part(with_weights(points[::-1]), OPEN_SPLINE, OPEN_SPLINE)


def pavement(length: float, width: float) -> Part:
    """A raised walk along y = 0 whose kerb is rounded, towards -y."""
    profile = [(0.0, -0.3), (0.0, -0.05), (0.0, 0.06), (0.0, 0.13), (-0.05, 0.15), (-0.3, 0.155), (-width, 0.17)]
    return moulding(profile, length, (0, 0, 0))
