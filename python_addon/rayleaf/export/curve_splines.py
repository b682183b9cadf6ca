"""The splines of CURVE objects as plain arrays: up to millions of splines or points in seconds."""

from dataclasses import dataclass
from functools import cached_property
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .curve_keys import ShapeKeys, placed_handles

Doubles = NDArray[np.float64]

# Settings that the core wants equal for splines given together, in this order in `SplineTable.settings`.
KINDS = ("BEZIER", "NURBS", "POLY")
_INTERPOLATIONS = ("LINEAR", "CARDINAL", "BSPLINE", "EASE")
KIND, CYCLIC, ORDER, ENDPOINT, BEZIER, RADIUS, TILT, RESOLUTION, MATERIAL, SMOOTH, FILL, ENDS_AT_SEAM = range(12)


@dataclass
class SplineTable:
    """All splines of a curve, their points end to end in the order of the splines."""

    settings: NDArray[np.int32]  # (splines, 12): indices above; enumerations as places in KINDS and _INTERPOLATIONS
    counts: NDArray[np.int32]  # (splines,) points
    points: Doubles  # (n, 4) x, y, z, weight
    handles: Doubles  # (n, 2, 3) left, right; zero where there are none
    radii: Doubles  # (n,)
    tilts: Doubles  # (n,) radians
    straight: NDArray[np.bool_]  # (n,) the segment that starts here has VECTOR handles at both sides

    @cached_property
    def firsts(self) -> NDArray[np.int64]:
        """(splines,): where each spline's points begin."""
        return np.asarray(np.cumsum(self.counts, dtype=np.int64) - self.counts)

    @cached_property
    def following(self) -> NDArray[np.int64]:
        """(n,): the point after each; after the last one of a spline its first, where the last segment ends."""
        result = np.arange(1, len(self.points) + 1)
        some = self.counts > 0
        result[(self.firsts + self.counts - 1)[some]] = self.firsts[some]
        return result

    def kind(self, number: int) -> str:
        """BEZIER, NURBS or POLY."""
        return KINDS[self.settings[number, KIND]]

    def alone(self, number: int) -> "SplineTable":
        """A table of one spline."""
        one, part = slice(number, number + 1), self.part(number)
        return SplineTable(
            self.settings[one],
            self.counts[one],
            self.points[part],
            self.handles[part],
            self.radii[part],
            self.tilts[part],
            self.straight[part],
        )

    def part(self, number: int) -> slice:
        """The points of one spline."""
        first = int(self.firsts[number])
        return slice(first, first + int(self.counts[number]))


def _column(splines: Any, name: str, kind: Any) -> NDArray[np.int32]:
    values = np.empty(len(splines), kind)
    splines.foreach_get(name, values)
    return values.astype(np.int32)


def _settings(curve: Any) -> NDArray[np.int32]:
    splines = curve.splines
    settings = np.zeros((len(splines), ENDS_AT_SEAM + 1), np.int32)
    # Enumerations cannot be read together: Blender's foreach_get gives their bytes with what lies beside them.
    names = [spline.type for spline in splines]
    settings[:, KIND] = [KINDS.index(name) for name in names]
    for own, spline, name in zip(settings, splines, names, strict=True):
        if name == "BEZIER":
            own[RADIUS] = _INTERPOLATIONS.index(spline.radius_interpolation)
            own[TILT] = _INTERPOLATIONS.index(spline.tilt_interpolation)
    columns: tuple[tuple[int, str, Any], ...] = (
        (CYCLIC, "use_cyclic_u", bool),
        (ORDER, "order_u", np.int32),
        (ENDPOINT, "use_endpoint_u", bool),
        (BEZIER, "use_bezier_u", bool),
        (RESOLUTION, "resolution_u", np.int32),
        (MATERIAL, "material_index", np.int32),
        (SMOOTH, "use_smooth", bool),
    )
    for column, name, kind in columns:
        settings[:, column] = _column(splines, name, kind)
    if curve.render_resolution_u > 0:
        settings[:, RESOLUTION] = curve.render_resolution_u
    # What does not count must not part splines that could go together.
    settings[np.ix_(settings[:, KIND] != KINDS.index("NURBS"), (ORDER, ENDPOINT, BEZIER))] = (4, 0, 0)
    return settings


def read_table(curve: Any, keys: ShapeKeys | None) -> SplineTable:
    """The splines of an evaluated curve data block, with its shape keys mixed in."""
    settings = _settings(curve)
    counts = _column(curve.splines, "point_count_u", np.int32)
    of_bezier = np.repeat(settings[:, KIND] == KINDS.index("BEZIER"), counts)
    read = _read_points(curve.splines, settings[:, KIND].tolist(), counts.tolist(), len(of_bezier))
    points = read["points"].reshape(-1, 4)
    points[of_bezier, :3] = read["positions"].reshape(-1, 3)[of_bezier]
    points[of_bezier, 3] = 1.0
    handles = np.stack([read["left"].reshape(-1, 3), read["right"].reshape(-1, 3)], axis=1)
    table = SplineTable(
        settings,
        counts,
        points.astype(np.float64),
        handles.astype(np.float64),
        read["radii"].astype(np.float64),
        read["tilts"].astype(np.float64),
        np.zeros(len(of_bezier), bool),
    )
    table.straight[:] = read["right_is_vector"] & read["left_is_vector"][table.following]
    if keys is not None:
        keys.apply(table.points, table.handles, table.radii, table.tilts)
        _place_handles(curve, table)
    return table


def _place_handles(curve: Any, table: SplineTable) -> None:
    """Blender places automatic and vector handles anew after mixing."""
    for number, spline in enumerate(curve.splines):
        if spline.type != "BEZIER":
            continue
        part = table.part(number)
        types = [(point.handle_left_type, point.handle_right_type) for point in spline.bezier_points]
        table.handles[part] = placed_handles(table.points[part, :3], table.handles[part], types, spline.use_cyclic_u)


def _read_points(splines: Any, kinds: list[int], counts: list[int], total: int) -> dict[str, Any]:
    """All that points have, flat and end to end. What a spline's kind has not stays zero."""
    widths = {"points": 4, "positions": 3, "left": 3, "right": 3, "radii": 1, "tilts": 1}
    arrays: dict[str, Any] = {name: np.zeros(total * width, np.float32) for name, width in widths.items()}
    left_is_vector, right_is_vector = arrays["left_is_vector"], arrays["right_is_vector"] = np.zeros((2, total), bool)
    points, positions, left, right, radii, tilts = (arrays[name] for name in widths)
    bezier = KINDS.index("BEZIER")
    first = 0
    for spline, kind, count in zip(splines, kinds, counts, strict=True):
        end = first + count
        if kind == bezier:
            own = spline.bezier_points
            own.foreach_get("co", positions[3 * first : 3 * end])
            own.foreach_get("handle_left", left[3 * first : 3 * end])
            own.foreach_get("handle_right", right[3 * first : 3 * end])
            left_is_vector[first:end] = [point.handle_left_type == "VECTOR" for point in own]
            right_is_vector[first:end] = [point.handle_right_type == "VECTOR" for point in own]
        else:
            own = spline.points
            own.foreach_get("co", points[4 * first : 4 * end])
        own.foreach_get("radius", radii[first:end])
        own.foreach_get("tilt", tilts[first:end])
        first = end
    return arrays


def _numbers(table: SplineTable) -> NDArray[np.int64]:
    """(splines,): equal for equal settings. One number a spline, for numbers sort faster than rows."""
    largest = table.settings.max(axis=0).astype(np.int64) + 1
    return np.asarray(np.ravel_multi_index(tuple(table.settings.T), tuple(largest)))


def _by_settings(table: SplineTable) -> tuple[SplineTable, NDArray[np.int64]]:
    """The splines with those of equal settings together, else in their order; where each such group begins."""
    if (table.settings == table.settings[:1]).all():
        return table, np.arange(min(len(table.settings), 1))
    numbers = _numbers(table)
    order = np.argsort(numbers, kind="stable")
    of_points = np.argsort(np.repeat(numbers, table.counts), kind="stable")
    together = SplineTable(
        table.settings[order],
        table.counts[order],
        table.points[of_points],
        table.handles[of_points],
        table.radii[of_points],
        table.tilts[of_points],
        table.straight[of_points],
    )
    return together, np.flatnonzero(np.diff(numbers[order], prepend=-1))


def send(core: ModuleType, table: SplineTable) -> list[Any]:
    """The core's CurveSplines. Raises its InputError."""
    result = []
    table, begins = _by_settings(table)
    firsts = np.append(table.firsts, len(table.points))
    for begin, end in zip(begins.tolist(), [*begins[1:].tolist(), len(table.counts)], strict=False):
        settings, counts = table.settings[begin].tolist(), table.counts[begin:end]
        chosen = slice(firsts[begin], firsts[end])
        kind = KINDS[settings[KIND]]
        is_bezier = kind == "BEZIER"
        result.append(
            core.CurveSplines(
                kind,
                counts,
                table.points[chosen],
                handles=table.handles[chosen] if is_bezier else None,
                radii=table.radii[chosen],
                tilts=table.tilts[chosen],
                straight=table.straight[chosen] if is_bezier else None,
                order=settings[ORDER],
                cyclic=bool(settings[CYCLIC]),
                endpoint=bool(settings[ENDPOINT]),
                bezier=bool(settings[BEZIER]),
                radius_interpolation=_INTERPOLATIONS[settings[RADIUS]],
                tilt_interpolation=_INTERPOLATIONS[settings[TILT]],
                resolution=settings[RESOLUTION],
                material_slot=settings[MATERIAL],
                smooth=bool(settings[SMOOTH]),
                fill_group=settings[FILL],
                ends_at_seam=bool(settings[ENDS_AT_SEAM]),
            )
        )
    return result
