"""Which way closed splines of 2D curves run: Blender turns outlines and holes so that the bevel's outside is outside."""

from functools import lru_cache
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .curve_splines import BEZIER, CYCLIC, ENDPOINT, ENDS_AT_SEAM, KIND, ORDER, RESOLUTION, SplineTable

Doubles = NDArray[np.float64]

# The most samples that one spline's outline is judged by: as many as tell the way of any loop that can be seen.
_MOST_SAMPLES = 4096


@lru_cache(maxsize=64)
def _bernstein(resolution: int) -> Doubles:
    """(resolution, 4): the cubic basis at the begins of equal steps."""
    t = np.arange(resolution) / resolution
    s = 1.0 - t
    return np.stack([s**3, 3 * s * s * t, 3 * s * t * t, t**3], axis=1)


def _next(rows: NDArray[Any]) -> NDArray[Any]:
    """For each row the one after it, for the last the first."""
    return np.concatenate((rows[1:], rows[:1]))


def _bezier_outline(points: Doubles, handles: Doubles, straight: NDArray[np.bool_], resolution: int) -> Doubles:
    """Samples of a closed spline; of a straight segment only its begin."""
    begins = points[:, :2]
    controls = np.stack([begins, handles[:, 1, :2], _next(handles[:, 0, :2]), _next(begins)], axis=1)
    samples = _bernstein(resolution) @ controls
    if not straight.any():
        return np.asarray(samples.reshape(-1, 2))
    return np.asarray(samples[~straight[:, None] | (np.arange(resolution) == 0)])


def outline(core: ModuleType, table: SplineTable, number: int) -> Doubles | None:
    """(n, 2): a closed spline as a polygon, about as fine as Blender's; None if Blender draws nothing of it."""
    part, settings = table.part(number), table.settings[number]
    points = table.points[part]
    if len(points) < 2:
        return None
    resolution = max(1, min(int(settings[RESOLUTION]), _MOST_SAMPLES // len(points)))
    if table.kind(number) == "BEZIER":
        result = _bezier_outline(points[:, :3], table.handles[part], table.straight[part], resolution)
    elif table.kind(number) == "NURBS":
        curve = core.NurbsCurve(points, int(settings[ORDER]), True, bool(settings[ENDPOINT]), bool(settings[BEZIER]))
        if curve.problem() is not None:
            return None
        count = len(points) * resolution
        result = curve.to_bezier().positions(np.arange(count) / count)[:, :2]
    else:
        result = points[:, :2]
    return result if len(result) > 1 else None


def _turns_left(polygon: Doubles) -> bool:
    """Whether a polygon runs counter-clockwise, judged like Blender by the corner furthest to the left."""
    corner = int(np.argmin(polygon[:, 0]))
    before, here, after = polygon[corner - 1], polygon[corner], polygon[(corner + 1) % len(polygon)]
    arrived, rest = here - before, before - after
    return bool(arrived[0] * rest[1] - arrived[1] * rest[0] <= 0.0)


def _contains(polygon: Doubles, point: Doubles) -> bool:
    """Whether a point lies inside a polygon, by the edges that a ray to the right crosses."""
    a, b = polygon, _next(polygon)
    crossing = (a[:, 1] > point[1]) != (b[:, 1] > point[1])
    a, b = a[crossing], b[crossing]
    x = a[:, 0] + (point[1] - a[:, 1]) / (b[:, 1] - a[:, 1]) * (b[:, 0] - a[:, 0])
    return bool(np.count_nonzero(x > point[0]) % 2)


def holes(polygons: list[Doubles]) -> list[bool]:
    """Which polygons are holes: those inside an outline that is not itself one."""
    order = sorted(range(len(polygons)), key=lambda i: float(polygons[i][:, 0].min()))
    boxes = np.array([[*polygon.min(axis=0), *polygon.max(axis=0)] for polygon in polygons]).reshape(-1, 4)
    result = [False] * len(polygons)
    ordered = boxes[order]
    for place, number in enumerate(order):
        point = polygons[number][0]
        around = (ordered[:place, :2] <= point).all(axis=1) & (ordered[:place, 2:] >= point).all(axis=1)
        for other in np.flatnonzero(around)[::-1]:
            if _contains(polygons[order[other]], point):
                result[number] = not result[order[other]]
                break
    return result


def orient(core: ModuleType, table: SplineTable) -> None:
    """Turn the closed splines round that run the wrong way, in place; they keep their beginning."""
    found = [(number, outline(core, table, number)) for number in np.flatnonzero(table.settings[:, CYCLIC]).tolist()]
    loops = [(number, polygon) for number, polygon in found if polygon is not None]
    for (number, polygon), hole in zip(loops, holes([polygon for _, polygon in loops]), strict=True):
        if _turns_left(polygon) != hole:
            _reverse(table, number)


def _last_of_reversed(kind: str, count: int, settings: NDArray[np.int32]) -> int:
    """Which point comes first when a closed spline runs backwards from where it began."""
    if kind == "BEZIER":  # begins at its last point
        return count - 2
    if kind == "POLY":  # Blender's reversed list begins at the last point
        return count - 1
    # The place where the knots are the same backwards; found by trying, for all flags and orders up to 6.
    if settings[ENDPOINT] or settings[ORDER] == 2:
        return 0
    return 2 if settings[BEZIER] else int(settings[ORDER]) - 2


def _reverse(table: SplineTable, number: int) -> None:
    part = table.part(number)
    count = part.stop - part.start
    kind = table.kind(number)
    last = _last_of_reversed(kind, count, table.settings[number])
    if kind == "BEZIER" and count > 1 and table.straight[part][count - 2]:
        last = count - 3  # the last segment is a single piece, and the reversed spline begins at its other end
    else:
        table.settings[number, ENDS_AT_SEAM] = kind != "POLY"
    order = part.start + (last - np.arange(count)) % count
    if kind == "BEZIER":
        segments = part.start + (last - 1 - np.arange(count)) % count
        table.straight[part] = table.straight[segments]
        table.handles[part] = table.handles[order][:, ::-1]
    table.points[part] = table.points[order]
    table.radii[part], table.tilts[part] = table.radii[order], table.tilts[order]
