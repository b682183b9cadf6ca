"""Makes spline_gallery.blend: every NURBS flag and every order, in both directions, each surface with its label."""

import colorsys
import sys
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

sys.path.append(str(Path(__file__).resolve().parent))
from scene_curves import label  # noqa: E402
from scene_tools import (  # noqa: E402
    add_grid,
    add_surface,
    light_gallery,
    material,
    save,
    start_empty,
)

KINDS = ("plain", "endpoint", "bezier", "endpoint bezier", "cyclic", "cyclic bezier")
ORDERS = (2, 3, 4, 5, 6)
SPACING_X, SPACING_Y = 2.9, 3.5


def point_count(kind: str, order: int) -> int:
    """Points for about three spans: what Blender draws completely."""
    if kind == "cyclic bezier":
        return max(3 * (order - 1), 4)
    if "bezier" in kind:
        return max(2 * (order - 1) + 1, order + 1)
    return order + 3


def parameters(kind: str, order: int) -> NDArray[np.float64]:
    """Where the points lie: around, or from -1 to 1 and beyond where the surface ends before its last points."""
    count = point_count(kind, order)
    if "cyclic" in kind:
        return np.arange(count) / count * 2 * np.pi
    reach = {"plain": (order + 2) / 4, "bezier": 1.0 if order == 2 else 1.6}.get(kind, 1.0)
    return np.linspace(-reach, reach, count)


def shape(kind_u: str, order_u: int, kind_v: str, order_v: int) -> NDArray[np.float64]:
    """A wavy sheet, a tube or a ring, as the cyclic directions ask; weights vary a little."""
    u, v = np.meshgrid(parameters(kind_u, order_u), parameters(kind_v, order_v))
    if "cyclic" in kind_u and "cyclic" in kind_v:
        x, y, z = (0.72 + 0.36 * np.cos(v)) * np.cos(u), (0.72 + 0.36 * np.cos(v)) * np.sin(u), 0.55 + 0.36 * np.sin(v)
    elif "cyclic" in kind_u:
        radius = 0.62 + 0.28 * np.cos(2.4 * v + 0.5)
        x, y, z = radius * np.cos(u), radius * np.sin(u), 0.85 + 0.75 * v
    elif "cyclic" in kind_v:
        radius = 0.55 + 0.2 * np.cos(2.2 * u)
        x, y, z = 0.95 * u, radius * np.cos(v), 0.75 + radius * np.sin(v)
    else:
        x, y, z = 1.05 * u, 1.05 * v, 0.75 + 0.45 * np.sin(2.6 * u + 0.7) * np.cos(2.1 * v)
    weight = 1 + 0.35 * np.cos(3 * u) * np.cos(2 * v)
    return np.stack([x, y, z, weight], axis=-1)


def set_flags(spline: Any, direction: str, kind: str, order: int) -> None:
    """Kind and order of one direction, u or v."""
    for flag in ("cyclic", "endpoint", "bezier"):
        setattr(spline, f"use_{flag}_{direction}", flag in kind)
    setattr(spline, f"order_{direction}", order)
    if getattr(spline, f"order_{direction}") != order:
        raise RuntimeError(f"Blender does not take order {order} for {kind}")


def add_exhibit(row: int, column: int, label_material: bpy.types.Material) -> None:
    """One surface: the row gives the kind in u, the column the order in u; v takes them in another sequence."""
    kind_u, order_u = KINDS[row], ORDERS[column]
    kind_v, order_v = KINDS[(row + column) % len(KINDS)], ORDERS[(column + 2 * row + 1) % len(ORDERS)]
    name = f"u {kind_u} {order_u}, v {kind_v} {order_v}"
    x, y = (column - 2) * SPACING_X, (2.5 - row) * SPACING_Y
    surface = add_surface(name, (x, y, 0.05))
    spline = add_grid(surface, shape(kind_u, order_u, kind_v, order_v), resolution=6)
    set_flags(spline, "u", kind_u, order_u)
    set_flags(spline, "v", kind_v, order_v)
    hue = (row * len(ORDERS) + column) / (len(KINDS) * len(ORDERS))
    color = colorsys.hsv_to_rgb(hue, 0.8, 0.75)
    surface.data.materials.append(material(name, color, 0.3))
    text = label(f"U {kind_u} {order_u}\nV {kind_v} {order_v}", (x, y - 1.3, 0.01), 0.3, label_material)
    text.name = text.data.name = f"label of {name}"


def main() -> None:
    start_empty(width=720, height=800, samples=24)
    label_material = material("label", (0.03, 0.03, 0.035), 0.6)
    for row in range(len(KINDS)):
        for column in range(len(ORDERS)):
            add_exhibit(row, column, label_material)
    light_gallery((0, -24, 30), (0, -0.35, 0), 17.6)
    save("spline_gallery")


main()
