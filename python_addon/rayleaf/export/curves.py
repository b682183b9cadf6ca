"""CURVE and FONT objects as swept curves: which can be, and what the core needs of them.

What Blender makes of each setting is told, and checked against Blender, by tests/blender/curve_reference.py.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from types import ModuleType
from typing import Any

import numpy as np

from .. import versions
from ..messages import Messages, Subject
from ..names import name_of
from . import curve_directions, curve_fills, curve_profiles, curve_splines
from .curve_keys import ShapeKeys, has_aligned_handles
from .curve_outlines import orient
from .curve_splines import CYCLIC, KIND, SMOOTH, SplineTable
from .strands import CurveSettings

# Blender's fill modes of 2D curves, as the round bevel counts them.
_FILLS = {"NONE": "FULL", "BOTH": "HALF"}


@contextmanager
def splines_of(curve_object: Any, depsgraph: Any) -> Iterator[Any]:
    """The data block with an object's splines: its own, or what its text is written with."""
    if curve_object.type != "FONT":
        yield curve_object.data
        return
    try:
        yield curve_object.to_curve(depsgraph)
    finally:
        curve_object.to_curve_clear()


def makes_faces(curve: Any) -> bool:
    """Whether there is anything to sweep or to fill: else a curve is a thread."""
    if curve_fills.is_filled(curve):
        return True
    if curve.bevel_mode == "OBJECT":
        return curve.bevel_object is not None and _has_splines(curve.bevel_object)
    return curve.bevel_depth != 0.0 or curve.extrude != 0.0


def _has_splines(bevel: Any) -> bool:
    """Whether a bevel object is a plain curve; one that is bevelled itself counts for nothing in Blender."""
    data = bevel.data
    return bevel.type == "CURVE" and data.extrude == 0.0 and data.bevel_depth == 0.0 and len(data.splines) > 0


@dataclass
class Judged:
    """What a CURVE or FONT object is rendered as."""

    has_faces: bool  # False: a thread, of which nothing is seen
    reason: str | None = None  # why as Blender's evaluated mesh
    curve: Any | None = None  # the core's SweptCurve of one that is exact
    problem: str | None = None  # why an exact one cannot be rendered
    is_open: bool = False  # `settle` is still to be called

    def settle(self, core: ModuleType) -> None:
        """Find out whether the outlines of a filled area cross. That takes the whole surface, which the core may be making."""
        if not self.is_open or self.curve is None:
            return
        self.is_open = False
        try:
            if self.curve.borders_cross():
                self.reason, self.curve = "filled area whose outlines cross", None
        except core.InputError as error:
            self.problem, self.curve = str(error), None


def judge(core: ModuleType, curve_object: Any, curve: Any) -> Judged:
    """Find out what an object is rendered as, as far as that does not take its surface, and describe it to the core; `curve`
    holds its splines."""
    if not makes_faces(curve):
        return Judged(False)
    reason = _reason_by_settings(curve_object, curve)
    if reason is not None:
        return Judged(True, reason)
    table = _table(curve_object, curve)
    filled = curve_fills.is_filled(curve)
    reason = _reason_by_splines(curve, table) or (curve_fills.fallback_reason(curve, table) if filled else None)
    if reason is not None:
        return Judged(True, reason)
    try:
        described = _describe(core, curve_object, curve, table)
        if described is None:
            return Judged(True, "profile widget of too many points")
        return Judged(True, curve=described, is_open=filled)
    except core.InputError as error:
        return Judged(True, problem=str(error))


def _reason_by_settings(curve_object: Any, curve: Any) -> str | None:
    reason = _deformed(curve_object)
    if reason is not None:
        return reason
    if curve.dimensions == "3D" and curve.twist_mode != "MINIMUM" and curve.twist_smooth > 0.0:
        return "smoothed twist, which depends on the resolution"
    bevel = curve.bevel_object if curve.bevel_mode == "OBJECT" else None
    if bevel is not None and (_deformed(bevel) or bevel.data.offset != 0.0):
        return "bevel object with a modifier, absolute shape keys or an offset"
    taper = curve.taper_object
    if taper is not None and taper.type == "CURVE" and (_deformed(taper) or not _is_thread(taper.data)):
        return "taper object with a modifier, faces or absolute shape keys"
    return None


def _reason_by_splines(curve: Any, table: SplineTable) -> str | None:
    if not table.settings[:, SMOOTH].all():
        return "flat shading"
    if curve.dimensions != "3D":
        return None
    if curve.twist_mode == "TANGENT" and curve_directions.bends_nowhere(table):
        return "tangent twist, which Blender leaves undefined on straight segments and NURBS"
    if curve_directions.turns_back(table):
        return "spline that turns straight back, where Blender's rings have no direction"
    return None


def _deformed(curve_object: Any) -> str | None:
    """What keeps an object's control points from being the whole story."""
    for modifier in curve_object.modifiers:
        if modifier.show_render:
            return f"modifier {name_of(modifier)}"
    keys = curve_object.data.shape_keys
    if keys is not None:
        if not keys.use_relative:
            return "absolute shape keys"
        if has_aligned_handles(curve_object.data):
            return "shape keys with aligned handles"
    return None


def _is_thread(curve: Any) -> bool:
    closed = curve.dimensions == "2D" and curve.fill_mode != "NONE" and any(s.use_cyclic_u for s in curve.splines)
    return not (closed or curve.extrude or curve.bevel_depth or curve.bevel_object or curve.offset)


def _table(curve_object: Any, curve: Any) -> SplineTable:
    keys = curve_object.data.shape_keys
    mixed = ShapeKeys(curve_object) if keys is not None and keys.key_blocks else None
    return curve_splines.read_table(curve, mixed)


def _profile(core: ModuleType, bevel: Any) -> list[Any]:
    """The splines of a bevel object in profile coordinates: its x to the right of the curve, its y along the frame's Y."""
    table = _table(bevel, bevel.data)
    scale = np.array([-bevel.scale.x, bevel.scale.y, 0.0])
    table.points[:, :3] *= scale
    table.handles *= scale
    for number in np.flatnonzero((table.settings[:, CYCLIC] == 1) & (table.settings[:, KIND] == 0)).tolist():
        # A closed Bezier spline begins at its first point as a profile, and at its last as a path.
        part = table.part(number)
        for values in (table.points, table.handles, table.straight):
            values[part] = np.roll(values[part], -1, axis=0)
    return curve_splines.send(core, table)


def _taper(core: ModuleType, taper: Any) -> Any | None:
    """The first spline of a taper object that Blender draws; None if it has no length along x, or there is none."""
    table = _table(taper, taper.data)
    for number, spline in enumerate(taper.data.splines):
        alone = table.alone(number)
        if len(alone.points) < 2:
            continue
        if spline.type == "NURBS":
            curve = core.NurbsCurve(
                alone.points, spline.order_u, spline.use_cyclic_u, spline.use_endpoint_u, spline.use_bezier_u
            )
            if curve.problem() is not None:
                continue
            ends = curve.to_bezier().positions(np.array([0.0, 1.0]))[:, 0]
        else:
            ends = alone.points[[0, -1], 0]
        return curve_splines.send(core, alone)[0] if ends[1] > ends[0] else None
    return None


def _radius_without_taper(table: SplineTable, mode: str) -> None:
    """A taper object without length counts as 1 everywhere."""
    if mode == "OVERRIDE":
        table.radii[:] = 1.0
    elif mode == "ADD":
        table.radii += 1.0


def _describe(core: ModuleType, curve_object: Any, curve: Any, table: SplineTable) -> Any | None:
    """The core's SweptCurve of an object; None if the profile widget cannot be told. Raises the core's InputError."""
    if curve.dimensions == "2D":
        orient(core, table)
    fills = curve_fills.group_fills(table, curve) if curve_fills.is_filled(curve) else []
    taper = None
    if curve.taper_object is not None and curve.taper_object.type == "CURVE":
        taper = _taper(core, curve.taper_object)
        if taper is None:
            _radius_without_taper(table, curve.taper_radius_mode)
    own_profile = curve.bevel_mode == "OBJECT"
    fill = _FILLS.get(curve.fill_mode, curve.fill_mode)
    profile = None if curve.bevel_object is None or not own_profile else _profile(core, curve.bevel_object)
    if curve.bevel_mode == "PROFILE" and curve.bevel_depth != 0.0:
        profile = curve_profiles.profile_splines(core, curve, fill)
        if profile is None:
            return None
    return core.SweptCurve(
        name_of(curve_object),
        curve_splines.send(core, table),
        dimensions=curve.dimensions,
        twist=curve.twist_mode,
        closed_twist=versions.closed_twist(),
        bevel_depth=0.0 if own_profile else curve.bevel_depth,
        extrude=0.0 if own_profile else curve.extrude,
        offset=curve.offset,
        fill=fill,
        bevel_resolution=curve.bevel_resolution,
        profile=profile,
        taper=taper,
        taper_radius=curve.taper_radius_mode,
        taper_fits_bevel=curve.use_map_taper,
        bevel_start=curve.bevel_factor_start,
        bevel_end=curve.bevel_factor_end,
        start_mapping=curve.bevel_factor_mapping_start,
        end_mapping=curve.bevel_factor_mapping_end,
        fill_caps=curve.use_fill_caps,
        fill_materials=fills,
    )


def add_curve(
    core: ModuleType, scene: Any, name: str, judged: Judged, messages: Messages, settings: CurveSettings
) -> int | None:
    """Send an exact CURVE or FONT object; the shape's index, or None if nothing of it can be rendered."""
    try:
        if judged.problem is None:
            other = settings.of_curve(core, judged.curve)
            return int(scene.add_curve(judged.curve) if other is None else scene.add_shape(other))
        problem = judged.problem
    except core.InputError as error:
        problem = str(error)
    subject = Subject("Object", name)
    messages.warn(f"{subject}: {problem}; left out", subject)
    return None
