"""OpenVDB files that tests write."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pyopenvdb

Values = np.ndarray[Any, Any]


def lattice(size: int) -> tuple[Values, Values, Values]:
    """Middles of voxels over the cube from -1 to 1, x first."""
    at = (np.arange(size) + 0.5) / size * 2.0 - 1.0
    x, y, z = np.meshgrid(at, at, at, indexing="ij")
    return x, y, z


def make_grid(name: str, function: Callable[..., Any], size: int, pruned: bool = False) -> Any:
    """A grid over the cube from -1 to 1, of a number or, in a last axis, a vector."""
    values = np.asarray(function(*lattice(size)), np.float32)
    made = pyopenvdb.FloatGrid() if values.ndim == 3 else pyopenvdb.Vec3SGrid()
    made.name = name
    made.copyFromArray(values)
    if pruned:
        made.prune()
    step = 2.0 / size
    rows = [[step, 0, 0, 0], [0, step, 0, 0], [0, 0, step, 0], [-1, -1, -1, 1]]
    made.transform = pyopenvdb.createLinearTransform(rows)
    return made


def write(path: Any, *grids: Any) -> str:
    """The path, as text."""
    pyopenvdb.write(str(path), list(grids))
    return str(path)
