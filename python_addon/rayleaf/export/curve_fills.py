"""Filled areas of 2D curves and texts: which can be sent as their outlines, and what belongs together."""

from typing import Any

import numpy as np

from .curve_splines import CYCLIC, FILL, MATERIAL, SplineTable

# The core cuts holes out of an outline one by one.
_MOST_OUTLINES = 50_000


def is_filled(curve: Any) -> bool:
    """Whether Blender fills the area between closed splines: not if every profile is closed itself."""
    if curve.dimensions != "2D" or curve.fill_mode == "NONE":
        return False
    if not any(spline.use_cyclic_u for spline in curve.splines):
        return False
    profiles = _profiles(curve)
    return profiles is None or not all(spline.use_cyclic_u for spline in profiles)


def _profiles(curve: Any) -> Any | None:
    """The splines of the bevel object; None if the bevel is round, or there is none."""
    if curve.bevel_mode != "OBJECT" or curve.bevel_object is None or curve.bevel_object.type != "CURVE":
        return None
    return curve.bevel_object.data.splines


def is_flat(curve: Any) -> bool:
    """Whether there is no profile, so that a filled area is a sheet."""
    if curve.bevel_mode == "OBJECT":
        return curve.bevel_object is None
    return curve.bevel_depth == 0.0 and curve.extrude == 0.0


def fallback_reason(curve: Any, table: SplineTable) -> str | None:
    """Why the areas of a filled curve must come as a mesh; crossing outlines are another matter."""
    closed = table.settings[:, CYCLIC] == 1
    if np.count_nonzero(closed) > _MOST_OUTLINES:
        return f"filled area of more than {_MOST_OUTLINES} outlines"
    profiles = _profiles(curve)
    if profiles is not None and len(profiles) > 1:
        return "filled area between the ends of several profiles"
    radii = table.radii[np.repeat(closed, table.counts)]
    if not is_flat(curve) and (curve.taper_object is not None or np.ptp(radii) > 0.0):
        return "filled area that is not flat, for the radius changes"
    return None


def group_fills(table: SplineTable, curve: Any) -> list[int]:
    """Number the splines by what is filled together: in texts, a character. The material slots of the areas."""
    characters = np.empty(len(curve.splines), np.int32)
    curve.splines.foreach_get("character_index", characters)
    closed = np.flatnonzero(table.settings[:, CYCLIC])
    found, firsts, numbers = np.unique(characters[closed], return_index=True, return_inverse=True)
    table.settings[closed, FILL] = numbers
    return [int(slot) for slot in table.settings[closed[firsts], MATERIAL]] if len(found) else []
