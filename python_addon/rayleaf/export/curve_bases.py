"""Hair curves of mixed types as cubic Bezier curves."""

from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .strand_arrays import StrandArrays

Doubles = NDArray[np.float64]

# Blender's numbers in the attribute `curve_type`.
CURVE_TYPES = {"CATMULL_ROM": 0, "POLY": 1, "BEZIER": 2, "NURBS": 3}

# A NURBS curve goes through so many points of its own a control point, with cubic pieces between.
_NURBS_SAMPLES = 8


def _pieces(points: Doubles, before: Doubles, after: Doubles, last: Doubles) -> Doubles:
    """(3 m + 1, k): Bezier points from the m starts of pieces, the handles of each, and where the last piece ends."""
    return np.vstack([np.stack([points, before, after], axis=1).reshape(-1, points.shape[1]), last])


def catmull_rom_as_bezier(points: Doubles, cyclic: bool) -> Doubles:
    """Bezier points (3 a piece and 1 more; the last is the first again if cyclic) of a Catmull-Rom spline."""
    if cyclic:
        back, here = np.roll(points, 1, axis=0), points
        ahead, far = np.roll(points, -1, axis=0), np.roll(points, -2, axis=0)
    else:
        here, ahead = points[:-1], points[1:]
        back, far = np.vstack([points[:1], points[:-2]]), np.vstack([points[2:], points[-1:]])
    return _pieces(here, here + (ahead - back) / 6.0, ahead - (far - here) / 6.0, ahead[-1:])


def linear_as_bezier(points: Doubles, cyclic: bool) -> Doubles:
    """The same of a polygon."""
    ring = np.vstack([points, points[:1]]) if cyclic else points
    step = np.diff(ring, axis=0) / 3.0
    return _pieces(ring[:-1], ring[:-1] + step, ring[1:] - step, ring[-1:])


def bezier_with_handles(points: Doubles, left: Doubles, right: Doubles, cyclic: bool) -> Doubles:
    """The same of a Bezier spline; what is beyond the position (the radius) runs evenly."""
    ring = np.vstack([points, points[:1]]) if cyclic else points
    arriving = np.vstack([left, left[:1]]) if cyclic else left
    leaving = np.vstack([right, right[:1]]) if cyclic else right
    step = np.diff(ring, axis=0) / 3.0
    before, after = ring[:-1] + step, ring[1:] - step
    before[:, :3], after[:, :3] = leaving[:-1], arriving[1:]
    return _pieces(ring[:-1], before, after, ring[-1:])


def nurbs_as_bezier(
    core: ModuleType, points: Doubles, order: int, endpoint: bool, bezier: bool, cyclic: bool
) -> Doubles:
    """The same through points of a NURBS curve; its control polygon if there is no such curve."""
    weights = np.ones((len(points), 1))
    curve = core.NurbsCurve(np.hstack([points[:, :3], weights]), order, cyclic, endpoint, bezier)
    if curve.problem() is not None:
        return linear_as_bezier(points, cyclic)
    t = np.linspace(0.0, 1.0, _NURBS_SAMPLES * len(points) + 1)
    positions = curve.to_bezier().positions(t[:-1] if cyclic else t)
    # The radius as a fourth coordinate of the same curve.
    flat = np.hstack([points[:, 3:], np.zeros((len(points), 2)), weights])
    radii = core.NurbsCurve(flat, order, cyclic, endpoint, bezier).to_bezier().positions(t[:-1] if cyclic else t)
    return catmull_rom_as_bezier(np.hstack([positions, radii[:, :1]]), cyclic)


def hair_as_bezier(
    core: ModuleType,
    arrays: StrandArrays,
    kinds: NDArray[np.int32],
    handles: tuple[Any, ...],
    orders: NDArray[np.float32] | None,
    modes: NDArray[np.float32] | None,
) -> None:
    """Turn strands of mixed types into Bezier curves, in place. Values per point give way to those of the roots.

    handles: left and right (n, 3), or None; orders and modes of NURBS: (strands, 1), or None for Blender's own.
    """
    left, right = handles
    strands = []
    for i, kind in enumerate(kinds.tolist()):
        part = slice(int(arrays.offsets[i]), int(arrays.offsets[i + 1]))
        points = np.hstack([arrays.points[part], arrays.radii[part, None].astype(np.float64)])
        cyclic = arrays.cyclic is not None and bool(arrays.cyclic[i])
        if len(points) < 2:
            strands.append(points)
        elif kind == CURVE_TYPES["BEZIER"] and left is not None and right is not None:
            strands.append(bezier_with_handles(points, left[part], right[part], cyclic))
        elif kind == CURVE_TYPES["NURBS"]:
            order = 4 if orders is None else int(orders[i, 0])
            mode = 0 if modes is None else int(modes[i, 0])  # 1: to the end points, 2: Bezier, 3: both
            strands.append(nurbs_as_bezier(core, points, order, mode in (1, 3), mode in (2, 3), cyclic))
        elif kind == CURVE_TYPES["CATMULL_ROM"]:
            strands.append(catmull_rom_as_bezier(points, cyclic))
        else:
            strands.append(linear_as_bezier(points, cyclic))
    for name, values in arrays.point_attributes.items():
        arrays.attributes[name] = values[np.minimum(arrays.offsets[:-1], len(values) - 1)]
    arrays.point_attributes = {}
    merged = np.vstack(strands)
    arrays.points, arrays.radii = np.ascontiguousarray(merged[:, :3]), merged[:, 3].astype(np.float32)
    arrays.offsets = np.concatenate([[0], np.cumsum([len(strand) for strand in strands])]).astype(np.int32)
    arrays.basis, arrays.cyclic = "BEZIER", None
