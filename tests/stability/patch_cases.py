"""Stiff and extreme Bezier patches, and what they are in extended precision (x87's 64-bit significand).

All patches have about the size 1. `difficult` points, where a patch has no normal or folds over itself, are left to the
cases that are about them.
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import comb
from typing import Any

import numpy as np
from rayleaf import _core

Extended = Any  # arrays of np.longdouble


def extended(values: Any) -> Extended:
    return np.asarray(values, dtype=np.longdouble)


@dataclass(frozen=True)
class PatchCase:
    """One Bezier patch: points (count_v, count_u, 4): x, y, z, weight."""

    name: str
    points: Any
    # Parameters to aim at, (n, 2): by default a grid inside the patch.
    targets: Any = None
    # Angle of aimed rays to the normal, radians; steeper than this the patch hides itself.
    steepest: float = 1.2
    # How far the core's surface may lie from this one, in sizes.
    position_bound: float = 1e-12

    def surface(self) -> Any:
        """The core's."""
        count_v, count_u, _ = self.points.shape
        clamped = (False, True, False)
        return _core.trace.PatchSurface(self.name, [(self.points, (count_u, *clamped), (count_v, *clamped), True, 0)])

    def aims(self) -> Any:
        if self.targets is not None:
            return np.asarray(self.targets, float)
        places = np.array([0.03, 0.21, 0.5, 0.77, 0.96])
        return np.stack(np.meshgrid(places, places), axis=-1).reshape(-1, 2)

    def evaluate(self, u: Any, v: Any) -> tuple[Extended, Extended, Extended]:
        """Position and both derivatives at parameters, each (n, 3), in extended precision."""
        count_v, count_u, _ = self.points.shape
        basis_u, slope_u = bernstein(count_u - 1, extended(u))
        basis_v, slope_v = bernstein(count_v - 1, extended(v))
        homogeneous = extended(self.points)
        homogeneous = np.concatenate([homogeneous[..., :3] * homogeneous[..., 3:], homogeneous[..., 3:]], axis=-1)

        def contract(along_v: Extended, along_u: Extended) -> Extended:
            return np.einsum("jn,in,jik->nk", along_v, along_u, homogeneous)

        value, by_u, by_v = contract(basis_v, basis_u), contract(basis_v, slope_u), contract(slope_v, basis_u)
        position = value[:, :3] / value[:, 3:]
        return (
            position,
            (by_u[:, :3] - position * by_u[:, 3:]) / value[:, 3:],
            (by_v[:, :3] - position * by_v[:, 3:]) / value[:, 3:],
        )

    def normals(self, u: Any, v: Any) -> Extended:
        """Unit normals P_v x P_u: Blender's side."""
        _, by_u, by_v = self.evaluate(u, v)
        normal = np.cross(by_v, by_u)
        return normal / np.sqrt(np.sum(normal * normal, axis=1))[:, None]


def bernstein(degree: int, t: Extended) -> tuple[Extended, Extended]:
    """Polynomials and their derivatives, (degree + 1, n) each."""

    def of(n: int) -> Extended:
        return np.array([extended(comb(n, i)) * t**i * (1 - t) ** (n - i) for i in range(n + 1)])

    values = of(degree)
    if degree == 0:
        return values, np.zeros_like(values)
    lower = of(degree - 1)
    padded = np.concatenate([np.zeros_like(lower[:1]), lower, np.zeros_like(lower[:1])])
    return values, degree * (padded[:-1] - padded[1:])


def sheet(count_u: int, count_v: int, height: Callable[[Any, Any], Any], weights: Any = 1.0) -> Any:
    """Control points over the square of side 2."""
    x, y = np.meshgrid(np.linspace(-1, 1, count_u), np.linspace(-1, 1, count_v))
    return np.stack([x, y, height(x, y), np.broadcast_to(weights, x.shape)], axis=-1)


def wave(x: Any, y: Any) -> Any:
    return 0.3 * np.sin(2 * x + 1) * np.cos(1.5 * y)


def collapsed_row() -> Any:
    points = sheet(4, 4, wave)
    points[0, :, :3] = points[0, 0, :3]
    return points


def collapsed_corner() -> Any:
    points = sheet(4, 4, wave)
    points[0, 1, :3] = points[1, 0, :3] = points[0, 0, :3]
    return points


def folded() -> Any:
    """Row 2 lies before row 1: the patch runs back over itself near the middle."""
    points = sheet(4, 4, wave)
    points[[1, 2], :, 1] = points[[2, 1], :, 1] * 1.6
    return points


def self_crossing() -> Any:
    """A ribbon whose ends pass through each other: x runs there and back while z keeps apart."""
    points = sheet(4, 2, lambda x, y: 0 * x)
    points[:, :, 0] = [[-1.0, 1.6, -1.6, 1.0]] * 2
    points[:, :, 2] = [[-0.5, 0.7, 0.7, -0.5]] * 2
    return points


def cusp() -> Any:
    """A profile with a cusp at u = 1/2."""
    points = sheet(4, 2, lambda x, y: 0 * x)
    points[:, :, 0] = [[-1.0, 1.0, -1.0, 1.0]] * 2
    points[:, :, 2] = [[0.0, 1.0, 1.0, 0.0]] * 2
    return points


def hairpin() -> Any:
    """A profile that goes there and comes back at a hundredth of its length."""
    points = sheet(4, 2, lambda x, y: 0 * x)
    points[:, :, 0] = [[-1.0, 1.6, 1.6, -1.0]] * 2
    points[:, :, 2] = [[0.0, 0.0, 0.02, 0.02]] * 2
    return points


def near_collinear() -> Any:
    """Two rows 6e-4 apart."""
    points = sheet(4, 4, wave)
    points[1] = points[0]
    points[1, :, 1] += 6e-4
    return points


def extreme_weights() -> Any:
    weights = np.ones((4, 4))
    weights[1, 1], weights[2, 2] = 1e6, 1e-6
    return sheet(4, 4, wave, weights)


def stretched(x: float, y: float, z: float) -> Any:
    points = sheet(4, 4, wave)
    points[..., :3] *= [x, y, z]
    return points


def of_degree(degree: int) -> PatchCase:
    return PatchCase(f"degree {degree}", sheet(degree + 1, 4, wave))


def edges() -> Any:
    """Along all four borders, a millionth inside, and the corners."""
    near, places = 1e-6, np.linspace(0.1, 0.9, 5)
    along = [(p, near) for p in places] + [(p, 1 - near) for p in places]
    corners = [(a, b) for a in (near, 1 - near) for b in (near, 1 - near)]
    return along + [(b, a) for a, b in along] + corners


# A pole is moved to a point that a float can hold (geometry/patch_surface.h).
POLE = 2.0**-24

REGULAR = [
    PatchCase("bicubic", sheet(4, 4, wave)),
    PatchCase("borders and corners", sheet(4, 4, wave), edges()),
    PatchCase("collapsed row", collapsed_row(), position_bound=POLE),
    PatchCase("near the pole of a collapsed row", collapsed_row(), [(u, 1e-4) for u in (0.1, 0.5, 0.9)], 1.2, POLE),
    PatchCase("collapsed corner", collapsed_corner()),
    PatchCase("folded", folded(), steepest=0.3),
    PatchCase("self-crossing", self_crossing(), [(u, 0.4) for u in (0.05, 0.3, 0.5, 0.7, 0.95)], 0.2),
    PatchCase("cusp", cusp(), [(u, 0.4) for u in (0.1, 0.3, 0.49, 0.51, 0.7)], 0.1),
    PatchCase("hairpin", hairpin(), [(u, 0.4) for u in (0.1, 0.3, 0.45, 0.55, 0.7, 0.9)], 0.1),
    PatchCase("near-collinear rows", near_collinear()),
    PatchCase("weights from 1e-6 to 1e6", extreme_weights(), steepest=0.5),
    PatchCase("flat sheet, thickness 1e-6", stretched(1, 1, 1e-6)),
    *(of_degree(degree) for degree in range(1, 13)),
]
