"""The surface that a curve object stands for: what Blender's mesh of it tends to as its resolution grows.

A ring at a point P of the spine is P + r ((y + offset) X + z Y): r is the radius there, (y, z) a point of the profile, `offset` the
curve's Offset minus 1 (as the interface calls it; Blender 3.4's Python gives 1 for none), X and Y the first two axes of the frame,
whose third is the direction. So the offset grows with the radius. See curve_spine.py for where rings lie. Frames in 3D:

* Z_UP: X is horizontal and Y points as much upwards as it can. Straight up or down there is no such frame; Blender then takes
  X = -x, Y = -y and X = -x, Y = +y. So does a spline of two samples, whatever the twist method.
* MINIMUM: Z_UP's frame at the first ring, carried along without rotation about the direction (parallel transport; at a corner from the
  arriving tangent by the bisector to the leaving one). Where a closed spline meets its beginning, the frame jumps: Blender 3.4 means to
  spread the missing angle over the rings and does not; later versions do, and begin with Z_UP's frame at the last ring.
* TANGENT (curved Bezier segments only): Y is opposite to the part of the second derivative that is perpendicular to the direction. The
  second derivative is negated where it turns by more than a right angle from one ring to the next, as where it passes through zero: a
  third of the way from a vector handle. Y jumps where the curvature does: at points, and by half a turn at inflections. The last ring
  is compared with its neighbour before that is negated, and the first with the last: a spline may end with half a turn. Of straight
  segments, NURBS and POLY splines Blender never sets it, and on a line it has no direction; their rings are garbage.
* Tilt turns the frame about the direction, afterwards, from X towards Y.

In 2D, X is the normal to the left of the direction and Y the z axis; at corners X is 1 / sin(half the angle between the legs) long, so
that straight segments keep their width. Tilt and twist do not count. Closed 2D splines run so that outlines and holes turn opposite ways.
"""

import numpy as np
from curve_spine import spine_of, unit


def z_up_frames(direction):
    """(n, 3, 3): rows X, Y, direction."""
    z = np.zeros_like(direction)
    z[:, 2] = 1
    y = unit(z - direction * direction[:, 2:])
    flat = np.abs(direction[:, :2]).sum(axis=1) < 1e-12
    y[flat] = np.where(direction[flat, 2:] > 0, (0.0, -1.0, 0.0), (0.0, 1.0, 0.0))
    frames = np.stack([np.cross(y, direction), y, direction], axis=1)
    frames[~direction.any(axis=1)] = np.eye(3)
    return frames


def rotated(vectors, axis, angle):
    """Vectors turned about a unit axis (Rodrigues)."""
    cos, sin = np.cos(angle)[..., None], np.sin(angle)[..., None]
    along = (vectors * axis).sum(axis=-1, keepdims=True)
    return vectors * cos + np.cross(axis, vectors) * sin + axis * along * (1 - cos)


def turned(vector, begin, end):
    """A vector carried by the shortest rotation from one unit direction to another."""
    axis, cos = np.cross(begin, end), begin @ end
    if 1 + cos < 1e-12:
        return vector
    return vector * cos + np.cross(axis, vector) + axis * (axis @ vector) / (1 + cos)


def transported(x, spine, i, j):
    """X carried along interval i of the spine, from ring i to ring j."""
    if spine.straight[i]:
        return turned(x, spine.direction[i], spine.direction[j])
    x = turned(x, spine.direction[i], spine.after[i])
    # Double reflection (Wang, Jüttler, Zheng, Liu 2008): fourth order in the interval.
    step = spine.position[j] - spine.position[i]
    if step.any():
        mirrored = x - 2 * (step @ x) / (step @ step) * step
        tangent = spine.after[i] - 2 * (step @ spine.after[i]) / (step @ step) * step
        other = spine.before[j] - tangent
        if other @ other > 0:
            mirrored = mirrored - 2 * (other @ mirrored) / (other @ other) * other
        x = mirrored
    return turned(x, spine.before[j], spine.direction[j])


def minimum_frames(spine, closed_twist):
    """Frames of the twist method MINIMUM, before tilt; closed_twist: SPREAD or JUMP."""
    n = len(spine.position)
    x = np.empty((n, 3))
    spreads = spine.cyclic and closed_twist == "SPREAD"
    first = n - 1 if spreads else 0
    x[first] = z_up_frames(spine.direction[first : first + 1])[0, 0]
    for i in range(-1 if spreads else 0, n - 2 if spreads else n - 1):
        x[i + 1] = transported(x[i], spine, i % n, i + 1)
    if spreads:
        direction, arriving = spine.direction[first], transported(x[n - 2], spine, n - 2, first)
        angle = np.arctan2(np.cross(arriving, x[first]) @ direction, arriving @ x[first])
        x = rotated(x, spine.direction, angle * spread_shares(n))
    return np.stack([x, np.cross(spine.direction, x), spine.direction], axis=1)


def spread_shares(n):
    """(n,): the share of the missing angle that each ring is turned by. Blender begins at the last one."""
    return np.append(np.arange(2, n + 1), 1) / n


def tangent_frames(spine):
    """Frames of the twist method TANGENT, before tilt."""
    second = unit(spine.second)
    n = len(second)
    for i in range(-1, n - 1):
        if second[i - 1 if i > -1 else n - 2] @ second[i] < 0:
            second[i] = -second[i]
    y = -unit(second - spine.direction * (second * spine.direction).sum(axis=1, keepdims=True))
    return np.stack([np.cross(y, spine.direction), y, spine.direction], axis=1)


def frames_3d(spine, twist, closed_twist):
    """(n, 3, 3): the frames of the rings of a 3D spline; closed_twist: of MINIMUM."""
    if len(spine.position) == 2:
        direction = unit(spine.position[1:] - spine.position[:1])
        frames = z_up_frames(np.repeat(direction, 2, axis=0))
    elif twist == "MINIMUM":
        frames = minimum_frames(spine, closed_twist)
    else:
        frames = tangent_frames(spine) if twist == "TANGENT" else z_up_frames(spine.direction)
    frames[:, :2] = rotated(frames[:, :2], frames[:, 2:], np.repeat(spine.tilt[:, None], 2, axis=1))
    return frames


def frames_2d(spine):
    """(n, 3, 3): the frames of the rings of a 2D spline; X is not unit at corners."""
    direction = spine.direction
    x = np.stack([-direction[:, 1], direction[:, 0], np.zeros(len(direction))], axis=1)
    cos = (spine.before * spine.after).sum(axis=1)
    widening = 1 / np.sqrt(np.maximum((1 + cos) / 2, 1e-12))
    if not spine.cyclic:
        widening[[0, -1]] = 1
    y = np.zeros_like(x)
    y[:, 2] = 1
    return np.stack([x * widening[:, None], y, direction], axis=1)


def rings(position, frames, radius, profile, offset):
    """(n, m, 3): the points of rings; profile (m, 2)."""
    y, z = profile[None, :, :1] + offset, profile[None, :, 1:]
    return position[:, None] + radius[:, None, None] * (y * frames[:, None, 0] + z * frames[:, None, 1])


def profile_of(settings, widget=None):
    """(polygon (m, 2), closed): Blender's own points of a bevel, or of an extrusion without one; `widget`: of a quarter."""
    depth, extrude, steps = (
        settings.get("bevel_depth", 0),
        settings.get("extrude", 0),
        settings.get("bevel_resolution", 0) + 1,
    )
    fill = settings.get("fill_mode", "FULL")
    if depth == 0:
        return np.array([[0, -extrude], [0, extrude]]), False
    if fill in ("FULL", "NONE") and extrude == 0 and widget is None:
        angle = np.arange(1, 2 * steps + 3) * np.pi / (steps + 1)
        return depth * np.stack([np.cos(angle), np.sin(angle)], axis=1), True
    angle = np.arange(steps) * np.pi / 2 / steps
    quarter = depth * (np.stack([np.cos(angle), np.sin(angle)], axis=1) if widget is None else np.asarray(widget))
    up = np.array([0, extrude])
    back = [[(0, -extrude - depth)], quarter[::-1] * (1, -1) - up]
    front = [quarter + up, [(0, extrude + depth)]]
    if fill == "BACK":
        parts = back + ([[(depth, extrude)]] if extrude else [])
    elif fill == "FRONT":
        parts = ([[(depth, -extrude)]] if extrude else []) + front
    else:
        parts = back + ([front[0][0 if extrude else 1 :]] + front[1:])
    if fill in ("FULL", "NONE"):
        parts += (
            [quarter[:0:-1] * (-1, 1) + up] + ([[(-depth, extrude)]] if extrude else []) + [quarter * (-1, -1) - up]
        )
    return np.concatenate([np.asarray(part, float).reshape(-1, 2) for part in parts]), fill in ("FULL", "NONE")


def runs_backwards(spine):
    """Whether a closed 2D spline that is the outline of an area is reversed: if it runs counter-clockwise."""
    x, y = spine.position[:, 0], spine.position[:, 1]
    left = int(np.argmin(x))
    u = spine.position[left] - spine.position[left - 1]
    w = spine.position[left - 1] - spine.position[(left + 1) % len(x)]
    return bool(u[0] * w[1] - u[1] * w[0] <= 0)


def reversed_spine(spine):
    """The same spline the other way; the interval after a sample is the one that was before it."""
    back = slice(None, None, -1)
    return type(spine)(
        position=spine.position[back],
        before=-spine.after[back],
        after=-spine.before[back],
        direction=-spine.direction[back],
        second=spine.second[back],
        radius=spine.radius[back],
        tilt=spine.tilt[back],
        straight=np.roll(spine.straight, 1)[back] if spine.cyclic else np.roll(spine.straight[back], -1),
        segment=spine.segment[back],
        cyclic=spine.cyclic,
    )


def bevel_object_profile(core, spline, scale):
    """(m, 2): a spline of a bevel object as a profile: x towards the right of the curve, y along the frame's Y, scaled by the object.

    A closed Bezier spline begins at its first point here, not at its last.
    """
    spine = spine_of(core, spline)
    points = spine.position[:, :2] * (-scale[0], scale[1])
    if spline["type"] == "BEZIER" and spline["cyclic"]:
        points = np.roll(points, -int((spine.segment == 0).sum()), axis=0)
    return points
