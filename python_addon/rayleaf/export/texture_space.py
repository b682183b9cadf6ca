"""The box in which Blender's Generated coordinates run from 0 to 1."""

from typing import Any

import numpy as np

Corner = tuple[float, float, float]


def texture_space(data: Any) -> tuple[Corner, Corner] | None:
    """The low and the high corner, object space; None for data without one."""
    if not hasattr(data, "texspace_location"):
        return None
    middle, half = np.array(data.texspace_location, float), np.abs(np.array(data.texspace_size, float))
    corners = (middle - half, middle + half)
    if not np.isfinite(corners).all():
        return None
    low, high = ((float(x), float(y), float(z)) for x, y, z in corners)
    return low, high
