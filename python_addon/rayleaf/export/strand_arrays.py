"""Hair as plain arrays."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Doubles = NDArray[np.float64]
Floats = NDArray[np.float32]
Ints = NDArray[np.int32]

# Blender keeps numbers that are not finite out of positions by the largest it has; what lies further than this, where
# rays cannot go, counts as not finite.
_FARTHEST = 1e18


@dataclass
class StrandArrays:
    """The arguments of the core's Strands, attributes still by name."""

    points: Doubles  # (n, 3), object space
    radii: Floats  # (n,)
    offsets: Ints  # (strands + 1,)
    basis: str = "CATMULL_ROM"
    cyclic: NDArray[np.uint8] | None = None  # (strands,)
    material_slot: int = 0
    attributes: dict[str, Floats] = field(default_factory=dict)  # (strands, channels)
    point_attributes: dict[str, Floats] = field(default_factory=dict)  # (n, channels)
    moved_points: Doubles | None = None  # (steps, n, 4), with the radii

    @property
    def count(self) -> int:
        """Strands."""
        return len(self.offsets) - 1


def without_bad_points(arrays: StrandArrays) -> int:
    """Makes every radius one that can be rendered, and drops strands with points that are not finite; how many were."""
    arrays.radii = np.where(np.isfinite(arrays.radii), np.maximum(arrays.radii, 0.0), 0.0).astype(np.float32)
    bad_points = ~(np.abs(arrays.points) < _FARTHEST).all(axis=1)
    if arrays.moved_points is not None:
        radii = arrays.moved_points[..., 3]
        arrays.moved_points[..., 3] = np.where(np.isfinite(radii), np.maximum(radii, 0.0), 0.0)
    if not bad_points.any():
        return 0
    counts = np.diff(arrays.offsets)
    strand_of_point = np.repeat(np.arange(arrays.count), counts)
    good = np.ones(arrays.count, bool)
    good[strand_of_point[bad_points]] = False
    kept = good[strand_of_point]
    arrays.points, arrays.radii = arrays.points[kept], arrays.radii[kept]
    if arrays.moved_points is not None:
        arrays.moved_points = np.ascontiguousarray(arrays.moved_points[:, kept])
    arrays.offsets = np.concatenate([[0], np.cumsum(counts[good])]).astype(np.int32)
    if arrays.cyclic is not None:
        arrays.cyclic = arrays.cyclic[good]
    arrays.attributes = {key: values[good] for key, values in arrays.attributes.items()}
    arrays.point_attributes = {key: values[kept] for key, values in arrays.point_attributes.items()}
    return int(np.count_nonzero(~good))
