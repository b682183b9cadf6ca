"""Curve objects for the scripts that make the scenes."""

from collections.abc import Sequence
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray
from scene_tools import Triple, link

Points = NDArray[np.float64] | Sequence[Triple]


def add_curve(name: str, location: Triple = (0, 0, 0), **settings: Any) -> Any:
    """A CURVE object without splines; `settings` of its data block. `dimensions` counts first."""
    data = bpy.data.curves.new(name, "CURVE")
    data.dimensions = settings.pop("dimensions", "3D")
    for key, value in settings.items():
        setattr(data, key, value)
    return link(name, data, location)


def _set(spline: Any, points: Any, radii: Sequence[float] | None, tilts: Sequence[float] | None, settings: dict) -> Any:
    for name, values in (("radius", radii), ("tilt", tilts)):
        if values is not None:
            points.foreach_set(name, np.asarray(values, np.float32))
    for key, value in settings.items():
        setattr(spline, key, value)
    return spline


def add_bezier(
    curve: Any,
    points: Points,
    handles: str | tuple[NDArray[np.float64], NDArray[np.float64]] = "AUTO",
    radii: Sequence[float] | None = None,
    tilts: Sequence[float] | None = None,
    **settings: Any,
) -> Any:
    """Append a Bezier spline. `handles`: a type, or the coordinates of the left and the right ones."""
    spline = curve.data.splines.new("BEZIER")
    own = spline.bezier_points
    own.add(len(points) - 1)
    # A closed spline's automatic handles see the neighbours across the seam.
    spline.use_cyclic_u = settings.pop("use_cyclic_u", False)
    own.foreach_set("co", np.asarray(points, np.float32).ravel())
    for point in own:
        kind = handles if isinstance(handles, str) else "FREE"
        point.handle_left_type = point.handle_right_type = kind
    if not isinstance(handles, str):
        own.foreach_set("handle_left", handles[0].astype(np.float32).ravel())
        own.foreach_set("handle_right", handles[1].astype(np.float32).ravel())
    return _set(spline, own, radii, tilts, settings)


def add_points(
    curve: Any,
    kind: str,
    points: Points,
    weights: Sequence[float] | None = None,
    radii: Sequence[float] | None = None,
    tilts: Sequence[float] | None = None,
    **settings: Any,
) -> Any:
    """Append a NURBS or POLY spline."""
    spline = curve.data.splines.new(kind)
    spline.points.add(len(points) - 1)
    ones = np.ones(len(points)) if weights is None else np.asarray(weights)
    spline.points.foreach_set("co", np.column_stack([np.asarray(points, float), ones]).astype(np.float32).ravel())
    return _set(spline, spline.points, radii, tilts, settings)


def label(text: str, location: Triple, size: float, look: Any) -> Any:
    """A line or more of text, lying on the floor."""
    data = bpy.data.curves.new(f"label of {text}", "FONT")
    data.body, data.size, data.align_x, data.resolution_u = text, size, "CENTER", 2
    data.materials.append(look)
    return link(data.name, data, location)
