"""The profile widget of a curve's bevel as Bezier segments: what Blender's samples of it lie on.

Blender tells neither handles nor segments of the widget, but samples of it at even parameters of each segment, as many as
are asked for: so many determine the cubic.
"""

from dataclasses import dataclass
from functools import cache
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .curve_splines import Doubles

# Samples of a segment. Its end and three determine a cubic; more tell whether it is one.
_SAMPLES, _FEWEST_SAMPLES = 9, 4
# Blender gives no more than this in all.
_MOST_SAMPLES = 1000
# How far samples may lie from their cubic: they are single precision numbers of the order of 1.
_FIT = 1e-5


@dataclass
class Outline:
    """Cubic segments, one after the other."""

    segments: Doubles  # (n, 4, 2)
    straight: NDArray[np.bool_]  # (n,)

    def mirrored(self, x: float, y: float) -> "Outline":
        """The same run through backwards, its coordinates multiplied."""
        return Outline(self.segments[::-1, ::-1] * (x, y), self.straight[::-1])

    def moved(self, y: float) -> "Outline":
        """The same further along y."""
        return Outline(self.segments + (0.0, y), self.straight)


def _line(begin: Doubles, end: Doubles) -> Outline:
    share = np.arange(4)[:, None] / 3.0
    return Outline((begin + share * (end - begin))[None], np.array([True]))


def _joined(parts: list[Outline]) -> Outline:
    """The parts with straight segments where one does not begin at the end of the one before."""
    chain = [parts[0]]
    for part in parts[1:]:
        begin, end = chain[-1].segments[-1, 3], part.segments[0, 0]
        if (begin != end).any():
            chain.append(_line(begin, end))
        chain.append(part)
    return Outline(np.concatenate([part.segments for part in chain]), np.concatenate([part.straight for part in chain]))


@cache
def _inner_weights(samples: int) -> Doubles:
    """(2, samples + 1): what the samples count for in the two inner points of a cubic with given ends."""
    t = np.linspace(0.0, 1.0, samples + 1)
    return np.asarray(np.linalg.pinv(np.stack([3 * t * (1 - t) ** 2, 3 * t * t * (1 - t)], axis=1)))


def _samples(widget: Any, segments: int) -> Doubles | None:
    """(segments, samples + 1, 2) of an evaluated widget, which is left as it was; None if there are too few."""
    each = min(_SAMPLES, _MOST_SAMPLES // segments)
    if each < _FEWEST_SAMPLES:
        return None
    flags, before = (widget.use_sample_even_lengths, widget.use_sample_straight_edges), len(widget.segments)
    try:
        widget.use_sample_even_lengths, widget.use_sample_straight_edges = False, True
        widget.initialize(segments * each)
        inner = np.array([point.location[:] for point in widget.segments], np.float64).reshape(segments, each, 2)
    finally:
        widget.use_sample_even_lengths, widget.use_sample_straight_edges = flags
        widget.initialize(max(before, 1))
    last = np.array(widget.points[-1].location[:], np.float64)
    ends = np.concatenate([inner[1:, 0], last[None]])
    return np.concatenate([inner, ends[:, None]], axis=1)


def quarter(widget: Any) -> Outline | None:
    """From the widget's first point (1, 0) to its last (0, 1); None if its samples lie on no cubics, or are too few."""
    points = list(widget.points)
    samples = _samples(widget, len(points) - 1)
    if samples is None:
        return None
    each = samples.shape[1] - 1
    t = np.linspace(0.0, 1.0, each + 1)[None, :, None]
    begins, ends = samples[:, :1], samples[:, -1:]
    off = samples - (begins * (1 - t) ** 2 * (1 + 2 * t) + ends * t * t * (3 - 2 * t))
    inner = _inner_weights(each) @ off + np.concatenate([begins, ends], axis=1)
    cubics = np.concatenate([begins, inner, ends], axis=1)
    back = off - 3 * t * (1 - t) ** 2 * (inner[:, :1] - begins) - 3 * t * t * (1 - t) * (inner[:, 1:] - ends)
    if not np.abs(back).max() < _FIT:
        return None
    straight = [
        before.handle_type_2 == "VECTOR" and after.handle_type_1 == "VECTOR"
        for before, after in zip(points[:-1], points[1:], strict=True)
    ]
    return Outline(cubics, np.array(straight))


def _section(edge: Outline, extrude: float, fill: str) -> Outline:
    """The whole profile, counter-clockwise from the lower end of the back, for the fill modes of 3D curves."""
    start = edge.segments[0, 0]
    low, high = start * (1.0, -1.0) - (0.0, extrude), start + (0.0, extrude)
    back, front = edge.mirrored(1.0, -1.0).moved(-extrude), edge.moved(extrude)
    if fill == "BACK":
        return _joined([back, _line(low, high)] if extrude else [back])
    if fill == "FRONT":
        return _joined([_line(low, high), front] if extrude else [front])
    parts = [back, front]
    if fill == "FULL":
        away = Outline(edge.segments * (-1.0, -1.0), edge.straight).moved(-extrude)
        parts += [front.mirrored(-1.0, 1.0), away]
    return _joined(parts)


def profile_splines(core: ModuleType, curve: Any, fill: str) -> list[Any] | None:
    """The profile of a curve with a widget as the core's CurveSplines; None if the widget cannot be told exactly."""
    edge = quarter(curve.bevel_profile)
    if edge is None:
        return None
    edge.segments *= curve.bevel_depth
    # Blender draws its last point at the bevel's depth, wherever the widget ends.
    end = np.array([0.0, curve.bevel_depth])
    if np.abs(edge.segments[-1, 3] - end).max() > _FIT * abs(curve.bevel_depth):
        edge = _joined([edge, _line(edge.segments[-1, 3], end)])
    edge.segments[-1, 3] = end
    whole = _section(edge, curve.extrude, fill)
    closed = fill == "FULL"
    starts, ends = whole.segments[:, 0], whole.segments[:, 3]
    leaving, arriving = whole.segments[:, 1], whole.segments[:, 2]
    if closed:  # the core runs through a closed Bezier spline from its last point
        flat, leaving, straight = (np.roll(each, -1, axis=0) for each in (starts, leaving, whole.straight))
    else:
        flat = np.concatenate([starts, ends[-1:]])
        leaving = np.concatenate([leaving, ends[-1:]])
        arriving = np.concatenate([starts[:1], arriving])
        straight = np.append(whole.straight, False)
    count = len(flat)
    points = np.concatenate([flat, np.zeros((count, 1)), np.ones((count, 1))], axis=1)
    handles = np.concatenate([np.stack([arriving, leaving], axis=1), np.zeros((count, 2, 1))], axis=2)
    steps = curve.bevel_resolution + 1 - np.count_nonzero(edge.straight)
    resolution = max(1, round(steps / max(1, np.count_nonzero(~edge.straight))))
    return [
        core.CurveSplines(
            "BEZIER",
            np.array([count], np.int32),
            points,
            handles=handles,
            straight=straight,
            cyclic=closed,
            resolution=resolution,
        )
    ]
