"""Cages of small dragons for subdivision, by extruding the faces of a tube. Needs NumPy alone."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Doubles = NDArray[np.float64]

SIDES = 8
# The body from tail to snout, a ring a row: place along, half width, half height, height of its middle.
BODY = np.array(
    [
        (-3.6, 0.02, 0.02, 0.62),
        (-3.0, 0.07, 0.07, 0.50),
        (-2.3, 0.13, 0.14, 0.45),
        (-1.6, 0.22, 0.24, 0.52),
        (-1.0, 0.38, 0.42, 0.68),
        (-0.4, 0.50, 0.52, 0.80),
        (0.2, 0.52, 0.54, 0.86),
        (0.8, 0.46, 0.50, 0.94),
        (1.3, 0.32, 0.36, 1.10),
        (1.7, 0.22, 0.26, 1.42),
        (1.95, 0.19, 0.22, 1.80),
        (2.15, 0.20, 0.22, 2.15),
        (2.45, 0.27, 0.24, 2.36),
        (2.85, 0.22, 0.17, 2.36),
        (3.2, 0.14, 0.10, 2.28),
    ]
)
# The rings whose backs have spikes, and where there are to be fewer.
SPIKED, FEW_SPIKED = (2, 4, 6, 8, 10), (4, 6, 8)
# Of the eight sides of a ring, counted from the right: the upper and lower right, those on the left, top and bottom.
UPPER_RIGHT, TOP, UPPER_LEFT, LOWER_LEFT, LOWER_RIGHT = 0, 1, 3, 4, 7


@dataclass
class Cage:
    """A polygon mesh."""

    vertices: list[Doubles] = field(default_factory=list)
    faces: list[list[int]] = field(default_factory=list)

    def extrude(self, face: int, move: tuple[float, float, float], scale: tuple[float, float, float]) -> None:
        """Move a face, scaled about its middle, and leave walls behind; it keeps its number."""
        old = self.faces[face]
        points = np.array([self.vertices[vertex] for vertex in old])
        middle = points.mean(axis=0)
        new = list(range(len(self.vertices), len(self.vertices) + len(old)))
        self.vertices += list(middle + (points - middle) * scale + move)
        for a, b, c, d in zip(old, [*old[1:], old[0]], [*new[1:], new[0]], new, strict=True):
            self.faces.append([a, b, c, d])
        self.faces[face] = new


def _tube() -> Cage:
    cage = Cage()
    angle = (np.arange(SIDES)) * 2 * np.pi / SIDES
    for along, width, height, middle in BODY:
        cage.vertices += [np.array([width * np.cos(a), along, middle + height * np.sin(a)]) for a in angle]
    for ring in range(len(BODY) - 1):
        first = ring * SIDES
        for side in range(SIDES):
            after = (side + 1) % SIDES
            cage.faces.append([first + after, first + side, first + SIDES + side, first + SIDES + after])
    last = (len(BODY) - 1) * SIDES
    for begin, turned in ((0, False), (last, True)):
        for quad in ((0, 1, 2, 3), (0, 3, 4, 7), (4, 5, 6, 7)):
            cage.faces.append([begin + i for i in (quad[::-1] if turned else quad)])
    return cage


def _face(ring: int, side: int) -> int:
    return ring * SIDES + side


def _leg(cage: Cage, ring: int, side: int) -> None:
    out = -1.0 if side == LOWER_LEFT else 1.0
    face = _face(ring, side)
    height = BODY[ring : ring + 2, 3].mean()
    cage.extrude(face, (0.14 * out, 0.0, -0.06), (0.8, 0.8, 0.8))
    cage.extrude(face, (0.12 * out, 0.05, -0.28 * height), (0.75, 0.75, 0.75))
    cage.extrude(face, (0.02 * out, 0.08, -0.24 * height), (0.9, 0.9, 0.9))
    cage.extrude(face, (0.05 * out, 0.28, -0.04 * height), (1.1, 0.8, 0.6))


def _wing(cage: Cage, ring: int, side: int) -> None:
    out = -1.0 if side == UPPER_LEFT else 1.0
    face = _face(ring, side)
    cage.extrude(face, (0.15 * out, -0.05, 0.2), (0.6, 0.8, 0.4))
    cage.extrude(face, (0.5 * out, -0.15, 0.6), (0.8, 1.6, 0.5))
    cage.extrude(face, (0.8 * out, -0.25, 0.35), (0.9, 1.7, 0.6))
    cage.extrude(face, (0.9 * out, -0.45, -0.25), (0.8, 0.7, 0.6))
    cage.extrude(face, (0.5 * out, -0.5, -0.45), (0.4, 0.3, 0.4))


def dragon(bend: float, lift: float, spiked: tuple[int, ...] = SPIKED) -> tuple[Doubles, list[list[int]]]:
    """Vertices (n, 3) and faces of a dragon that looks along y, feet at z = 0.

    bend: how far it winds; lift: the head; spiked: the rings whose backs have spikes.
    """
    cage = _tube()
    for side in (LOWER_LEFT, LOWER_RIGHT):
        _leg(cage, 4, side)
        _leg(cage, 7, side)
    for side in (UPPER_LEFT, UPPER_RIGHT):
        _wing(cage, 6, side)
        out = -1.0 if side == UPPER_LEFT else 1.0
        cage.extrude(_face(11, side), (0.06 * out, -0.12, 0.1), (0.45, 0.45, 0.45))
        cage.extrude(_face(11, side), (0.04 * out, -0.3, 0.1), (0.3, 0.3, 0.3))
    for ring in spiked:
        for side in (TOP, TOP + 1):
            cage.extrude(_face(ring, side), (0.0, -0.1, 0.16), (0.35, 0.35, 0.35))
    points = np.array(cage.vertices)
    along = points[:, 1].copy()
    points[:, 0] += bend * np.sin(along * 1.1)
    points[:, 2] += lift * np.clip(along - 1.0, 0, None) ** 2 * 0.2
    return points, cage.faces
