"""Which part of a curve is bevelled, and how thick: bevel factors and taper objects, as Blender counts them.

Positions along a spline count Blender's samples: 0 at the first, n - 1 at the last.

* RESOLUTION: a factor times n - 1. SPLINE: by length. SEGMENTS: by the segments' lengths, and within a segment by samples.
* The ring at a cut takes the radius of the sample that is cut away, not one in between: it shows where a straight segment is cut.
* Factors in the wrong order are swapped; equal ones leave nothing of open splines. Closed splines are never cut.
* A taper object gives a factor: y over x of its first spline, x from its first point (0) to its last (1), by the share of samples passed,
  of all of them or, with use_map_taper, of those between the cuts. Without length along x it counts as 1.
"""

import numpy as np
from curve_spine import Spine


def _lengths(spine):
    return np.linalg.norm(np.diff(spine.position, axis=0), axis=1)


def cut_position(spine, factor, mapping):
    """Where along an open spline a bevel factor lies."""
    lengths, last = _lengths(spine), len(spine.position) - 1
    if factor >= 1:
        return float(last)
    if mapping == "RESOLUTION":
        return factor * last
    if mapping == "SPLINE":
        passed = np.concatenate([[0], np.cumsum(lengths)])
        return float(np.interp(factor * passed[-1], passed, np.arange(last + 1)))
    segments = spine.segment[:-1]
    ends = np.concatenate([[0], np.flatnonzero(np.diff(segments)) + 1, [last]])
    passed = np.concatenate([[0], np.cumsum(np.add.reduceat(lengths, ends[:-1]))])
    return float(np.interp(factor * passed[-1], passed, ends))


def visible_range(spine, settings):
    """(begin, end) in samples; None if nothing is left."""
    last = len(spine.position) - 1
    if spine.cyclic:
        return 0.0, float(last)
    start, end = settings.get("bevel_factor_start", 0.0), settings.get("bevel_factor_end", 1.0)
    if abs(end - start) < 1.2e-7:
        return None
    positions = [
        cut_position(spine, factor, settings.get(f"bevel_factor_mapping_{name}", "RESOLUTION"))
        for name, factor in (("start", start), ("end", end))
    ]
    return min(positions), max(positions)


def _slerped(first, second, share):
    """A frame between two, by the rotation that takes one to the other; frames have rows X, Y, direction."""
    turn = first.T @ second
    axis = np.array([turn[1, 2] - turn[2, 1], turn[2, 0] - turn[0, 2], turn[0, 1] - turn[1, 0]])
    sine = np.linalg.norm(axis) / 2
    if sine < 1e-12:
        return first
    angle = np.arctan2(sine, (np.trace(turn) - 1) / 2) * share
    axis = axis / np.linalg.norm(axis)
    cos, sin = np.cos(angle), np.sin(angle)
    return np.array([row * cos + np.cross(axis, row) * sin + axis * (axis @ row) * (1 - cos) for row in first])


def cut_rings(spine, frames, radius, begin, end, flat):
    """(positions, frames, radius, samples): rings between two places of the spline, those at the cuts included."""
    n = len(spine.position)
    start, stop = int(begin), min(int(end) + 1, n - 1)
    inner = np.arange(start + 1, stop)
    places = np.concatenate([[begin], inner, [end]])
    rows = [(start, start + 1, begin - start), *((i, i, 0.0) for i in inner), (stop, stop - 1, stop - end)]
    position = np.array([spine.position[i] * (1 - f) + spine.position[j] * f for i, j, f in rows])
    if flat:
        turned = [frames[i] * (1 - f) + frames[j] * f for i, j, f in rows]
    else:
        turned = [_slerped(frames[i], frames[j], f) if f else frames[i] for i, j, f in rows]
    return position, np.array(turned), radius[[row[0] for row in rows]], places


def taper_factor(points, share):
    """y of a taper's polygon (n, 2) where its x has passed a share of its length."""
    length = points[-1, 0] - points[0, 0]
    if length <= 0:
        return np.ones_like(share)
    x = (points[:, 0] - points[0, 0]) / length
    return np.interp(share, np.maximum.accumulate(x), points[:, 1])


def tapered_radius(radius, points, mode, places, count, visible):
    """Radius of rings at places (in samples) of a spline of so many samples; `visible`: the range to fit the taper to, or None."""
    begin, end = visible or (0.0, count - 1.0)
    factor = taper_factor(points, (places - begin) / (end - begin))
    return {"OVERRIDE": factor, "MULTIPLY": factor * radius, "ADD": factor + radius}[mode]


def is_whole(spine: Spine, visible):
    """Whether nothing of a spline is cut off."""
    return spine.cyclic or visible == (0.0, len(spine.position) - 1.0)
