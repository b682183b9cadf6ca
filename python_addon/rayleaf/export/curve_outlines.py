"""Which way closed splines of 2D curves run: Blender turns outlines and holes so that the bevel's outside is outside."""

from dataclasses import dataclass
from functools import cached_property, lru_cache
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .curve_splines import BEZIER, CYCLIC, ENDPOINT, ENDS_AT_SEAM, KIND, KINDS, ORDER, RESOLUTION, SplineTable

Doubles = NDArray[np.float64]

# The most samples that one spline's outline is judged by: as many as tell the way of any loop that can be seen.
_MOST_SAMPLES = 4096
# So many pairs of polygons are looked at together.
_MOST_PAIRS = 1 << 18


@lru_cache(maxsize=64)
def _bernstein(resolution: int) -> Doubles:
    """(resolution, 4): the cubic basis at the begins of equal steps."""
    t = np.arange(resolution) / resolution
    s = 1.0 - t
    return np.stack([s**3, 3 * s * s * t, 3 * s * t * t, t**3], axis=1)


@dataclass
class Outlines:
    """Closed splines as polygons, one after the other, about as fine as Blender's."""

    numbers: NDArray[np.int64]  # of the splines in their table
    points: Doubles  # (n, 2)
    counts: NDArray[np.int64]  # of each polygon's points

    @cached_property
    def firsts(self) -> NDArray[np.int64]:
        """Where each polygon begins."""
        return np.asarray(np.cumsum(self.counts) - self.counts)

    @cached_property
    def low(self) -> Doubles:
        """(polygons, 2): the least coordinates."""
        return np.asarray(np.minimum.reduceat(self.points, self.firsts))

    @cached_property
    def high(self) -> Doubles:
        """(polygons, 2): the largest."""
        return np.asarray(np.maximum.reduceat(self.points, self.firsts))

    def polygon(self, place: int) -> Doubles:
        """The points of one."""
        return self.points[self.firsts[place] : self.firsts[place] + self.counts[place]]


def _bezier_outlines(table: SplineTable, numbers: NDArray[np.int64], resolution: int) -> list[Doubles]:
    """Samples of closed splines; of a straight segment only its begin."""
    chosen = np.zeros(len(table.counts), bool)
    chosen[numbers] = True
    places = np.flatnonzero(np.repeat(chosen, table.counts))
    begins, ends = table.points[:, :2], table.following[places]
    controls = np.stack(
        [begins[places], table.handles[places, 1, :2], table.handles[ends, 0, :2], begins[ends]], axis=1
    )
    samples = _bernstein(resolution) @ controls
    kept = ~table.straight[places, None] | (np.arange(resolution) == 0)
    lasts = np.cumsum(kept.sum(axis=1))[np.cumsum(table.counts[numbers]) - 1].tolist()
    points = samples[kept]
    return [points[begin:end] for begin, end in zip([0, *lasts[:-1]], lasts, strict=True)]


def _other_outline(core: ModuleType, table: SplineTable, number: int, resolution: int) -> Doubles:
    """Of a closed NURBS or poly spline; empty where there is no such curve."""
    points, settings = table.points[table.part(number)], table.settings[number]
    if table.kind(number) == "POLY":
        return points[:, :2]
    curve = core.NurbsCurve(points, int(settings[ORDER]), True, bool(settings[ENDPOINT]), bool(settings[BEZIER]))
    if curve.problem() is not None:
        return np.empty((0, 2))
    count = len(points) * resolution
    return np.asarray(curve.to_bezier().positions(np.arange(count) / count)[:, :2])


def outlines(core: ModuleType, table: SplineTable) -> Outlines:
    """Of all closed splines of which Blender draws something."""
    numbers = np.flatnonzero((table.settings[:, CYCLIC] == 1) & (table.counts > 1))
    finest = np.maximum(_MOST_SAMPLES // table.counts[numbers], 1)
    resolutions = np.clip(table.settings[numbers, RESOLUTION], 1, finest)
    of_bezier = table.settings[numbers, KIND] == KINDS.index("BEZIER")
    found: dict[int, Doubles] = {}
    for resolution in np.unique(resolutions[of_bezier]).tolist():
        alike = numbers[of_bezier & (resolutions == resolution)]
        found.update(zip(alike.tolist(), _bezier_outlines(table, alike, resolution), strict=True))
    for number, resolution in zip(numbers[~of_bezier].tolist(), resolutions[~of_bezier].tolist(), strict=True):
        found[number] = _other_outline(core, table, number, resolution)
    drawn = [number for number in numbers.tolist() if len(found[number]) > 1]
    points = np.concatenate([found[number] for number in drawn]) if drawn else np.empty((0, 2))
    return Outlines(np.array(drawn, np.int64), points, np.array([len(found[number]) for number in drawn], np.int64))


def turn_left(loops: Outlines) -> NDArray[np.bool_]:
    """Which polygons run counter-clockwise, judged like Blender by the corner furthest to the left."""
    of_polygon = np.repeat(np.arange(len(loops.counts)), loops.counts)
    leftmost = np.flatnonzero(~(loops.points[:, 0] > loops.low[of_polygon, 0]))
    corners = leftmost[np.unique(of_polygon[leftmost], return_index=True)[1]]
    lasts = loops.firsts + loops.counts - 1
    here = loops.points[corners]
    before = loops.points[np.where(corners == loops.firsts, lasts, corners - 1)]
    after = loops.points[np.where(corners == lasts, loops.firsts, corners + 1)]
    arrived, rest = here - before, before - after
    return np.asarray(arrived[:, 0] * rest[:, 1] - arrived[:, 1] * rest[:, 0] <= 0.0)


def _contains(polygon: Doubles, point: Doubles) -> bool:
    """Whether a point lies inside a polygon, by the edges that a ray to the right crosses."""
    a, b = polygon, np.concatenate((polygon[1:], polygon[:1]))
    crossing = (a[:, 1] > point[1]) != (b[:, 1] > point[1])
    a, b = a[crossing], b[crossing]
    x = a[:, 0] + (point[1] - a[:, 1]) / (b[:, 1] - a[:, 1]) * (b[:, 0] - a[:, 0])
    return bool(np.count_nonzero(x > point[0]) % 2)


def holes(loops: Outlines) -> NDArray[np.bool_]:
    """Which polygons are holes: those inside an outline that is not itself one."""
    order = np.argsort(loops.low[:, 0], kind="stable")
    low, high, starts = loops.low[order], loops.high[order], loops.points[loops.firsts[order]]
    found = np.zeros(len(order), bool)
    at_once = max(_MOST_PAIRS // max(len(order), 1), 1)
    for begin in range(0, len(order), at_once):
        rows = np.arange(begin, min(begin + at_once, len(order)))
        points, others = starts[rows, None], slice(0, begin + at_once)
        around = ((low[others] <= points) & (high[others] >= points)).all(axis=2)
        around &= np.arange(around.shape[1]) < rows[:, None]
        for row in np.flatnonzero(around.any(axis=1)).tolist():
            for other in np.flatnonzero(around[row])[::-1].tolist():
                if _contains(loops.polygon(order[other]), points[row, 0]):
                    found[begin + row] = not found[other]
                    break
    result = np.empty_like(found)
    result[order] = found
    return result


def orient(core: ModuleType, table: SplineTable) -> None:
    """Turn the closed splines round that run the wrong way, in place; they keep their beginning."""
    loops = outlines(core, table)
    if len(loops.numbers):
        _reverse(table, loops.numbers[turn_left(loops) != holes(loops)])


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


def _reverse(table: SplineTable, numbers: NDArray[np.int64]) -> None:
    firsts, counts = table.firsts[numbers], table.counts[numbers]
    lasts = []
    for number, first, count in zip(numbers.tolist(), firsts.tolist(), counts.tolist(), strict=True):
        kind = table.kind(number)
        last = _last_of_reversed(kind, count, table.settings[number])
        if kind == "BEZIER" and table.straight[first + count - 2]:
            last = count - 3  # the last segment is a single piece, and the reversed spline begins at its other end
        else:
            table.settings[number, ENDS_AT_SEAM] = kind != "POLY"
        lasts.append(last)
    of_spline = np.repeat(np.arange(len(numbers)), counts)
    begins, sizes = firsts[of_spline], counts[of_spline]
    within = np.arange(len(of_spline)) - (np.cumsum(counts) - counts)[of_spline]
    places = begins + within
    back = np.array(lasts, np.int64)[of_spline] - within
    order, segments = begins + back % sizes, begins + (back - 1) % sizes
    # Where a spline has no handles, they are zero, and none of its segments is straight.
    table.straight[places] = table.straight[segments]
    table.handles[places] = table.handles[order][:, ::-1]
    for values in (table.points, table.radii, table.tilts):
        values[places] = values[order]
