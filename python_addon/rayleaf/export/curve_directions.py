"""Where splines have no direction that Blender's rings could look along: its meshes show rounding there, at any resolution."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .curve_splines import CYCLIC, KIND, KINDS, ORDER, Doubles, SplineTable

# Of the largest coordinate: by how much handles that lie on a line may be off it. Second derivatives as small as that have no
# direction in Blender's single precision.
_OFF_LINE = 2.0**-17
# The length of the sum of two unit directions that are opposite but for rounding.
_OPPOSITE = 2.0**-17

_BEZIER, _NURBS = KINDS.index("BEZIER"), KINDS.index("NURBS")


def bends_nowhere(table: SplineTable) -> bool:
    """Whether tangent twist has no second derivative to go by: Blender computes it for curved Bezier segments alone."""
    if (table.settings[:, KIND] != _BEZIER).any():
        return True
    straight = table.straight | _on_lines(table)
    # What follows the last point of an open spline is no segment.
    straight[(table.firsts + table.counts - 1)[table.settings[:, CYCLIC] == 0]] = False
    return bool(straight.any())


def _on_lines(table: SplineTable) -> NDArray[np.bool_]:
    """(n,): whether the handles of the Bezier segment that starts at each point lie on its chord, but for their rounding."""
    following = table.following
    begins, ends = table.points[:, :3], table.points[following, :3]
    handles = np.stack([table.handles[:, 1], table.handles[following, 0]], axis=1) - begins[:, None]
    chords = ends - begins
    squares = np.maximum((chords**2).sum(axis=1), np.finfo(float).tiny)
    along = (handles * chords[:, None]).sum(axis=2) / squares[:, None]
    off = np.abs(handles - along[:, :, None] * chords[:, None]).max(axis=(1, 2))
    largest = np.abs(np.concatenate([begins, ends], axis=1)).max(axis=1)
    return np.asarray(off <= _OFF_LINE * largest)


def turns_back(table: SplineTable) -> bool:
    """Whether a spline leaves a point the way it came."""
    if len(table.points) == 0:
        return False
    legs = table.points[table.following, :3] - table.points[:, :3]
    preceding = np.empty(len(legs), np.int64)
    preceding[table.following] = np.arange(len(legs))
    arrives, leaves = legs[preceding], legs.copy()
    kinds = np.repeat(table.settings[:, KIND], table.counts)
    curved = (kinds == _BEZIER) & ~table.straight
    own = table.points[:, :3] - table.handles[:, 0], table.handles[:, 1] - table.points[:, :3]
    for directions, handles, here in ((arrives, own[0], curved[preceding]), (leaves, own[1], curved)):
        chosen = here & handles.any(axis=1)
        directions[chosen] = handles[chosen]
    looked_at = (kinds != _NURBS) | (np.repeat(table.settings[:, ORDER], table.counts) == 2)
    # Closed splines of two rings are open in Blender.
    two_rings = (table.counts == 2) & ~curved[np.minimum(table.firsts, len(curved) - 1)]
    open_splines = ((table.settings[:, CYCLIC] == 0) | two_rings) & (table.counts > 0)
    looked_at[table.firsts[open_splines]] = looked_at[(table.firsts + table.counts - 1)[open_splines]] = False
    looked_at &= arrives.any(axis=1) & leaves.any(axis=1)
    sums = _unit(arrives[looked_at]) + _unit(leaves[looked_at])
    return bool((np.linalg.norm(sums, axis=1) < _OPPOSITE).any())


def _unit(vectors: Any) -> Doubles:
    return np.asarray(vectors / np.linalg.norm(vectors, axis=1, keepdims=True))
