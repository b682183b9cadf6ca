"""Point clouds: balls, each a strand whose axis is one point."""

from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .attributes import flat_values, for_shading
from .random_numbers import random_of_index
from .strand_arrays import StrandArrays

Floats = NDArray[np.float32]

# What points tell of themselves, as attributes; names no attribute can have in Blender. IS_POINT is 1.
IS_POINT, POSITION, RADIUS, RANDOM = (f"\npoint {name}" for name in ("is", "position", "radius", "random"))

# Of points without that attribute, as in Blender's own engine.
_DEFAULT_RADIUS = 0.01


def point_balls(cloud: Any, wanted: frozenset[str]) -> StrandArrays | None:
    """The balls of a PointCloud data block, with the attributes that are wanted and there; None if it has no points."""
    places = flat_values(cloud.attributes, "position", "POINT")
    if places is None or len(places) == 0:
        return None
    radii = flat_values(cloud.attributes, "radius", "POINT")
    count = len(places)
    radii = np.full((count, 1), _DEFAULT_RADIUS, np.float32) if radii is None else np.maximum(radii, 0.0)
    own = {
        IS_POINT: np.ones((count, 1), np.float32),
        POSITION: places,
        RADIUS: np.repeat(radii, 3, axis=1),  # a vector, which the object scales
        RANDOM: random_of_index(count)[:, None],
    }
    arrays = StrandArrays(
        np.repeat(places, 2, axis=0).astype(np.float64),
        np.repeat(radii[:, 0], 2),
        np.arange(0, 2 * count + 1, 2, dtype=np.int32),
        basis="LINEAR",
    )
    for name in wanted:
        values = own[name] if name in own else for_shading(flat_values(cloud.attributes, name, "POINT"))
        if values is not None:
            arrays.attributes[name] = np.ascontiguousarray(values, np.float32)
    return arrays


def add_points(core: ModuleType, scene: Any, name: str, arrays: StrandArrays) -> int:
    """Send balls; the shape's index. Raises the core's InputError."""
    attributes = {scene.attribute(key): values for key, values in arrays.attributes.items()}
    balls = core.Strands(
        name,
        arrays.points,
        arrays.radii,
        arrays.offsets,
        basis=arrays.basis,
        form="ROUND",
        attributes=attributes,
        moved_points=arrays.moved_points,
    )
    index = int(scene.add_shape(balls))
    scene.set_texture_space(index, (0.0, 0.0, 0.0), (1.0, 1.0, 1.0))  # Generated coordinates are the object's
    return index
