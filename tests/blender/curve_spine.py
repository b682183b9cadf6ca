"""Where a curve object's cross sections lie: a spline's positions, directions, radius and tilt at Blender's own samples.

Blender samples a spline and puts one cross section, a "ring", at each sample. What it makes of that as the resolution grows is
the surface that Rayleaf renders. The facts, each checked by test_curve_oracle.py:

* A curved Bezier segment has `resolution` samples, at t = k / resolution. A segment whose handles are VECTOR at both sides has one,
  at its start; so has every segment of a POLY spline. Such straight segments stay ruled surfaces between two rings.
* A NURBS spline has resolution x segments samples, spaced evenly in the knot parameter, both ends included if it is open.
* A ring is perpendicular to the bisector of the directions to its neighbours. In the limit that is the tangent, or where the tangent
  breaks the bisector of the two one-sided ones. In 3D the ring is not widened there; in 2D it is mitred.
* The first and last ring of an open spline are perpendicular to the handle (Bezier) or the first and last leg of the control polygon
  (NURBS, POLY). A NURBS spline without the endpoint flag is not tangent to that: its end rings are askew.
* Radius and tilt of a curved Bezier segment are cubics in t, of two or four neighbouring points by the interpolation mode, and of a
  NURBS spline the same rational combination of the points as the coordinates are.
"""

from dataclasses import dataclass

import numpy as np

# Blender's cardinal spline: tension.
CARDINAL = 0.71


@dataclass
class Spine:
    """A spline at Blender's samples, n of them; the interval after sample i is number i."""

    position: np.ndarray  # (n, 3)
    before: np.ndarray  # (n, 3) unit direction at which the curve arrives
    after: np.ndarray  # (n, 3) unit direction at which it leaves
    direction: np.ndarray  # (n, 3) unit, what the ring is perpendicular to
    second: np.ndarray  # (n, 3) second derivative of the interval after; Bezier only
    radius: np.ndarray  # (n,)
    tilt: np.ndarray  # (n,) radians
    straight: np.ndarray  # (n,) bool: interval i has rings at its ends only
    segment: np.ndarray  # (n,) which segment interval i belongs to
    cyclic: bool


def unit(vectors):
    """Unit vectors; zero stays zero."""
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return vectors / np.where(length > 0, length, 1)


def interpolation_weights(mode, t):
    """(n, 4): weights of previous, start, end and next point of a segment."""
    zero, ease = np.zeros_like(t), 3 * t**2 - 2 * t**3
    if mode == "LINEAR":
        return np.stack([zero, 1 - t, t, zero], axis=1)
    if mode == "EASE":
        return np.stack([zero, 1 - ease, ease, zero], axis=1)
    if mode == "CARDINAL":
        c = CARDINAL
        return np.stack(
            [
                -c * t**3 + 2 * c * t**2 - c * t,
                (2 - c) * t**3 + (c - 3) * t**2 + 1,
                (c - 2) * t**3 + (3 - 2 * c) * t**2 + c * t,
                c * t**3 - c * t**2,
            ],
            axis=1,
        )
    return (
        np.stack([(1 - t) ** 3, 3 * t**3 - 6 * t**2 + 4, -3 * t**3 + 3 * t**2 + 3 * t + 1, t**3], axis=1) / 6
    )


def _cubic(points, t):
    """Position, first and second derivative of a cubic Bezier segment (4, 3) at t (n,)."""
    p, s = points[:, None], 1 - t[None, :, None]
    t = t[None, :, None]
    position = s**3 * p[0] + 3 * s**2 * t * p[1] + 3 * s * t**2 * p[2] + t**3 * p[3]
    first = 3 * (s**2 * (p[1] - p[0]) + 2 * s * t * (p[2] - p[1]) + t**2 * (p[3] - p[2]))
    second = 6 * (s * (p[2] - 2 * p[1] + p[0]) + t * (p[3] - 2 * p[2] + p[1]))
    return position[0], first[0], second[0]


def _end_direction(points):
    """Unit direction in which a segment leaves its first point, (4, 3): towards the first point that differs."""
    for point in points[1:]:
        if np.linalg.norm(point - points[0]) > 1e-12:
            return unit(point - points[0])
    return np.zeros(3)


def _bisected(before, after, ends):
    """Directions of the rings; `ends` replaces the first and last of an open spline."""
    direction = unit(before + after)
    if ends is not None:
        direction[0], direction[-1] = ends
    return direction


def _bezier_segment(spline, knots, start):
    """(samples of one segment by name, arriving direction): the segment that starts at a point."""
    count, cyclic = len(knots), spline["cyclic"]
    end = (start + 1) % count
    straight = spline["vector"][start][1] and spline["vector"][end][0]
    points = np.array([knots[start, 1], knots[start, 2], knots[end, 0], knots[end, 1]])
    if straight:
        points[1], points[2] = points[[0, 0]] + (points[3] - points[0]) * np.array([[1], [2]]) / 3
    t = np.arange(1 if straight else spline["resolution"]) / spline["resolution"]
    position, tangent, second = _cubic(points, t)
    tangent = unit(tangent)
    tangent[0] = _end_direction(points)
    around = (
        [start - 1, start, end, (end + 1) % count] if cyclic else np.clip(np.arange(start - 1, start + 3), 0, count - 1)
    )
    samples = {"position": position, "after": tangent, "second": second, "straight": np.full(len(t), straight)}
    for name in ("radius", "tilt"):
        weights = interpolation_weights("LINEAR" if straight else spline[f"{name}_mode"], t)
        samples[name] = weights @ spline[name][around]
    return samples, -_end_direction(points[::-1]), _cubic(points, np.ones(1))[2][0]


def bezier_spine(spline):
    """The spine of a Bezier spline. Blender starts a closed one with the segment from the last to the first point."""
    knots = np.stack([spline["handle_left"], spline["co"], spline["handle_right"]], axis=1)
    count, cyclic = len(knots), spline["cyclic"]
    order = [(count - 1 + i) % count for i in range(count)] if cyclic else range(count - 1)
    parts, arrives, segment = [], [], []
    for number, start in enumerate(order):
        samples, arrival, second = _bezier_segment(spline, knots, start)
        parts.append(samples)
        arrives.append(arrival)
        segment += [number] * len(samples["radius"])
    if not cyclic:
        last = {"position": knots[-1, 1], "after": arrives[-1], "second": second, "straight": True}
        last.update(radius=spline["radius"][-1], tilt=spline["tilt"][-1])
        parts.append({name: np.array([value]) for name, value in last.items()})
        segment.append(number)
    joined = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
    before, segment = joined["after"].copy(), np.array(segment)
    for number, place in enumerate(np.flatnonzero(np.diff(np.concatenate([[-1], segment])))):
        if number or cyclic:
            before[place] = arrives[number - 1]
    ends = None if cyclic else (joined["after"][0], before[-1])
    direction = _bisected(before, joined["after"], ends)
    return Spine(before=before, direction=direction, segment=segment, cyclic=cyclic, **joined)


def poly_spine(spline):
    """The spine of a POLY spline."""
    points, cyclic = spline["co"][:, :3], spline["cyclic"]
    legs = unit(np.roll(points, -1, axis=0) - points)
    before, after = np.roll(legs, 1, axis=0), legs.copy()
    if not cyclic:
        before[0], after[-1] = after[0], before[-1]
    direction = _bisected(before, after, None if cyclic else (after[0], before[-1]))
    n = len(points)
    return Spine(
        points,
        before,
        after,
        direction,
        np.zeros((n, 3)),
        spline["radius"],
        spline["tilt"],
        np.ones(n, bool),
        np.arange(n),
        cyclic,
    )


def nurbs_spine(core, spline):
    """The spine of a NURBS spline, by way of the core's conversion to Bezier form (test_nurbs_oracle.py checks that)."""
    order, cyclic, endpoint, bezier = spline["flags"]
    points, count = spline["co"], len(spline["co"])
    segments = count if cyclic else count - 1
    total = segments * spline["resolution"]
    t = np.arange(total) / (total if cyclic else total - 1)
    flags = (order, bool(cyclic), bool(endpoint), bool(bezier))
    chain = core.NurbsCurve(points, *flags).to_bezier()
    with_radius = points.copy()
    with_radius[:, :3] = np.stack([spline["radius"], spline["tilt"], np.zeros(count)], axis=1)
    other = core.NurbsCurve(with_radius, *flags).to_bezier()
    values = other.positions(t)
    before, after = _one_sided_tangents(chain, t)
    ends = None
    if not cyclic:
        before[0], after[-1] = after[0], before[-1]
        ends = (unit(points[1, :3] - points[0, :3]), unit(points[-1, :3] - points[-2, :3]))
    direction = _bisected(before, after, ends)
    if not cyclic:
        before[0], after[-1] = ends
    return Spine(
        chain.positions(t),
        before,
        after,
        direction,
        np.zeros((total, 3)),
        values[:, 0],
        values[:, 1],
        np.zeros(total, bool),
        np.arange(total) // spline["resolution"],
        cyclic,
    )


def _one_sided_tangents(chain, t):
    """Unit tangents of a Bezier chain just before and just after parameters."""
    ranges = chain.ranges
    result = []
    for side in (-1, 1):
        wrapped = t % 1.0 if side > 0 else np.where(t <= 0, 1.0, t)
        middle = ranges.mean(axis=1)
        nudge = 1e-9 * side
        number = np.clip(np.searchsorted(ranges[:, 0], wrapped + nudge, side="right") - 1, 0, len(middle) - 1)
        tangents = np.empty((len(t), 3))
        for i in np.unique(number):
            here = number == i
            begin, end = ranges[i]
            tangents[here] = _rational_tangent(
                chain.segment(int(i)).points, np.clip((wrapped[here] - begin) / (end - begin), 0, 1)
            )
        result.append(tangents)
    return result


def _rational_tangent(points, t):
    """Unit tangents of one rational Bezier segment, (degree + 1, 3 or 4) homogeneous."""
    if points.shape[1] == 3:
        points = np.concatenate([points, np.ones((len(points), 1))], axis=1)
    degree = len(points) - 1
    value = _de_casteljau(points, t)
    slope = degree * _de_casteljau(np.diff(points, axis=0), t)
    return unit(slope[:, :3] * value[:, 3:] - value[:, :3] * slope[:, 3:])


def _de_casteljau(points, t):
    layer = np.repeat(points[:, None], len(t), axis=1)
    while len(layer) > 1:
        layer = layer[:-1] * (1 - t)[None, :, None] + layer[1:] * t[None, :, None]
    return layer[0]


def spine_of(core, spline):
    """The spine of any spline."""
    if spline["type"] == "BEZIER":
        return bezier_spine(spline)
    return poly_spine(spline) if spline["type"] == "POLY" else nurbs_spine(core, spline)
