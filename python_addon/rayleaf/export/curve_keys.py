"""Relative shape keys of CURVE objects: what they move, and the handles that follow."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

Doubles = NDArray[np.float64]

# Blender's automatic handles are this many times shorter than the sum of both unit directions: with it four of them make a
# good circle.
_AUTO_LENGTH = 2.5614
# An automatic handle reaches at most this far beyond what the shorter neighbour allows.
_AUTO_RATIO = 5.0


class ShapeKeys:
    """The mixed values of a curve's relative shape keys, element by element in the order of its points."""

    def __init__(self, curve_object: Any) -> None:
        keys = curve_object.data.shape_keys
        blocks = list(keys.key_blocks)
        if curve_object.show_only_shape_key:
            self._values = self._read(blocks[curve_object.active_shape_key_index])
            return
        self._values = self._read(blocks[0])
        for block in blocks[1:]:
            if not block.mute and block.value != 0.0:
                own, relative = self._read(block), self._read(block.relative_key)
                for name, values in self._values.items():
                    values += block.value * (own[name] - relative[name])

    @staticmethod
    def _read(block: Any) -> dict[str, Doubles]:
        data = block.data
        count = len(data)
        is_bezier = np.fromiter((hasattr(element, "handle_left") for element in data), bool, count)
        values = {}
        for name, width in (("co", 3), ("radius", 1), ("tilt", 1)):
            read = np.empty(count * width, np.float32)
            data.foreach_get(name, read)
            values[name] = read.reshape(-1, width).astype(np.float64)
        for name in ("handle_left", "handle_right"):
            values[name] = np.zeros((count, 3))
            if is_bezier.all():
                read = np.empty(count * 3, np.float32)
                data.foreach_get(name, read)
                values[name][:] = read.reshape(-1, 3)
            else:
                for place in np.flatnonzero(is_bezier).tolist():
                    values[name][place] = getattr(data[place], name)
        return values

    def apply(self, points: Doubles, handles: Doubles, radii: Doubles, tilts: Doubles) -> None:
        """Replace what shape keys move, in place."""
        points[:, :3] = self._values["co"]
        handles[:, 0], handles[:, 1] = self._values["handle_left"], self._values["handle_right"]
        radii[:], tilts[:] = self._values["radius"][:, 0], self._values["tilt"][:, 0]


def has_aligned_handles(curve: Any) -> bool:
    """True if some handle is ALIGNED: where it goes after mixing depends on what was selected last."""
    return any(
        "ALIGNED" in (point.handle_left_type, point.handle_right_type)
        for spline in curve.splines
        if spline.type == "BEZIER"
        for point in spline.bezier_points
    )


def placed_handles(points: Doubles, handles: Doubles, types: list[tuple[str, str]], cyclic: bool) -> Doubles:
    """(n, 2, 3): handles with the AUTO and VECTOR ones where Blender puts them; the others stay."""
    if len(points) < 2:
        return handles
    before, after = np.roll(points, 1, axis=0), np.roll(points, -1, axis=0)
    if not cyclic:
        before[0] = 2 * points[0] - points[1]
        after[-1] = 2 * points[-1] - points[-2]
    legs = np.stack([points - before, after - points], axis=1)
    lengths = np.linalg.norm(legs, axis=2)
    lengths[lengths == 0.0] = 1.0
    direction = (legs / lengths[:, :, None]).sum(axis=1)
    size = np.linalg.norm(direction, axis=1) * _AUTO_LENGTH
    back = np.minimum(lengths[:, 0], _AUTO_RATIO * lengths[:, 1])
    ahead = np.minimum(lengths[:, 1], _AUTO_RATIO * back)
    reach = np.stack([-back, ahead], axis=1)
    result = handles.copy()
    for side, sign in ((0, -1.0), (1, 1.0)):
        kinds = np.array([pair[side] for pair in types])
        auto = (kinds == "AUTO") & (size > 0.0)
        result[auto, side] = points[auto] + direction[auto] * (reach[auto, side] / size[auto])[:, None]
        vector = kinds == "VECTOR"
        result[vector, side] = points[vector] + sign * legs[vector, side] / 3.0
    return result
