"""Makes knot.blend: a torus knot of glass, one closed NURBS curve with a round bevel, and a smaller one of gold through it."""

import sys
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

sys.path.append(str(Path(__file__).resolve().parent))
from scene_curves import add_curve, add_points  # noqa: E402
from scene_tools import (  # noqa: E402
    add_camera,
    add_floor,
    add_lamp,
    checkered,
    glass,
    graded_world,
    material,
    save,
    start_empty,
)

# Light at the horizon, dark blue above.
SKY = ((0.0, (0.85, 0.75, 0.68)), (0.15, (0.62, 0.68, 0.78)), (0.5, (0.2, 0.3, 0.5)), (1.0, (0.06, 0.1, 0.22)))


def torus_knot(count: int, around: int, through: int, radius: float, tube: float) -> NDArray[np.float64]:
    """Control points of a closed knot that winds about a torus: so often around its axis and so often through its hole."""
    t = np.arange(count) / count * 2 * np.pi
    distance = radius + tube * np.cos(through * t)
    x, y = distance * np.cos(around * t), distance * np.sin(around * t)
    return np.stack([x, y, tube * np.sin(through * t)], axis=1)


def add_knot(name: str, points: NDArray[np.float64], thickness: float, look: Any) -> Any:
    """A closed NURBS curve of order 4 (three times differentiable where it matters: twice) with a round bevel."""
    knot = add_curve(name, (0, 0, 1.62), bevel_depth=thickness, bevel_resolution=4)
    add_points(knot, "NURBS", points, use_cyclic_u=True, order_u=4, resolution_u=12)
    knot.data.materials.append(look)
    knot.rotation_euler = (1.25, 0.0, 0.35)
    return knot


def main() -> None:
    start_empty(width=640, height=560, samples=64)
    add_knot("glass knot", torus_knot(30, 2, 3, 1.1, 0.52), 0.27, glass("blue glass", (0.82, 0.93, 0.99), 1.45))
    gold = material("gold", (1.0, 0.68, 0.25), 0.16, Metallic=1.0)
    add_knot("gold thread", torus_knot(90, 2, 9, 1.12, 0.86), 0.035, gold)
    checks = checkered("floor", (0.7, 0.68, 0.62), (0.05, 0.07, 0.13), 1.3, 0.4)
    add_floor("floor", (-9, -6), (9, 14), checks)
    graded_world("sky", SKY, 0.7)
    key = add_lamp("window", "AREA", (-3.8, -2.2, 5.2), (0, 0, 1.4), 420, (1.0, 0.94, 0.86))
    key.data.shape, key.data.size, key.data.size_y = "RECTANGLE", 2.4, 2.4
    back = add_lamp("back", "AREA", (3.6, 3.4, 3.2), (0, 0, 1.5), 200, (0.8, 0.88, 1.0))
    back.data.shape, back.data.size = "DISK", 1.6
    add_camera((0.5, -7.2, 2.9), (0.0, 0, 1.5), 52)
    save("knot")


main()
