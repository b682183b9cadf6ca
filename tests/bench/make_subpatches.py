"""Makes subpatches.blend: a million NURBS patches, dunes to the horizon, beside a geometry cache of 30 MB.

Sixteen surfaces of 250 x 250 patches that share their borders, one smooth sheet, under a low sun; three mirrors on it
see the dunes again, in all directions. After the folder may follow the patches along the side of a surface.
"""

import sys
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

sys.path.append(str(Path(__file__).resolve().parents[2] / "blend_scenes"))
from scene_tools import (  # noqa: E402
    NodeTree,
    add_camera,
    add_grid,
    add_lamp,
    add_surface,
    arguments,
    graded_world,
    link,
    material,
    save,
    start_empty,
)

TILES = 4  # along each side
PATCHES = 250  # along the side of a tile
SIDE = 40.0  # of the whole sheet
ORDER = 4
MEGABYTES = 30.0  # of the geometry cache: some bytes a patch


def height(x: NDArray[np.float64], y: NDArray[np.float64]) -> NDArray[np.float64]:
    """Dunes that lean over, and ripples on them."""
    bend = x + 1.3 * np.sin(0.21 * y) + 0.5 * np.sin(0.47 * y + 1)
    dunes = 0.9 * (1 - np.abs(np.sin(0.29 * bend))) ** 1.6 + 0.5 * np.sin(0.13 * y - 0.2 * x)
    ripples = 0.035 * np.sin(5.1 * bend + 0.9 * np.sin(0.8 * y)) + 0.012 * np.sin(13.0 * bend - 2.0 * y)
    return dunes + ripples


def control_points(column: int, row: int, patches: int) -> NDArray[np.float64]:
    """Of one tile. Neighbours share three rows, so the sheet is smooth across borders."""
    step = SIDE / (TILES * patches)
    along = np.arange(patches + ORDER - 1) - 1
    x, y = np.meshgrid((along + column * patches) * step - SIDE / 2, (along + row * patches) * step - SIDE / 2)
    return np.stack([x, y, height(x, y), np.ones_like(x)], axis=-1)


def first_tile(patches: int) -> Any:
    """The surface that the others are copies of; Blender joins rows slowly."""
    surface = add_surface("tile 0 0")
    spline = add_grid(surface, control_points(0, 0, patches), resolution=1)
    spline.order_u = spline.order_v = ORDER
    surface.data.materials.append(material("sand", (0.78, 0.55, 0.32), 0.6, Specular=0.2))
    return surface


def add_dunes(patches: int) -> None:
    """All tiles."""
    first = first_tile(patches)
    for index in range(1, TILES * TILES):
        column, row = index % TILES, index // TILES
        tile = link(f"tile {column} {row}", first.data.copy())
        points = control_points(column, row, patches).astype(np.float32)
        tile.data.splines[0].points.foreach_set("co", points.ravel())


def add_mirrors() -> None:
    """Three balls of chrome."""
    made = bpy.data.materials.new("chrome")
    tree = NodeTree(made)
    shader = tree.add("ShaderNodeBsdfGlossy", {"Color": (0.9, 0.9, 0.92, 1), "Roughness": 0.0})
    tree.add("ShaderNodeOutputMaterial", {"Surface": shader.outputs[0]})
    for x, y, radius in ((-1.2, -13.0, 0.9), (1.6, -11.5, 1.3), (0.2, -6.0, 2.0)):
        bpy.ops.surface.primitive_nurbs_surface_sphere_add(radius=radius)
        ball = bpy.context.object
        ball.location = (x, y, float(height(np.array(x), np.array(y))) + 0.8 * radius)
        ball.data.materials.append(made)


def main() -> None:
    words = arguments()[1:]
    start_empty(width=960, height=540, samples=16)
    bpy.context.scene.rayleaf.facet_memory = 0.0
    bpy.context.scene.rayleaf.geometry_cache_size = MEGABYTES
    add_dunes(int(words[0]) if words else PATCHES)
    add_mirrors()
    graded_world("sky", ((0.0, (0.75, 0.78, 0.8)), (0.5, (0.25, 0.45, 0.8)), (1.0, (0.1, 0.2, 0.5))), 0.7)
    add_lamp("sun", "SUN", (-8, 4, 4), (0, 0, 0), 3.0, (1.0, 0.85, 0.65)).data.angle = 0.02
    add_camera((0.0, -19.0, 3.6), (0.2, -4.0, 0.4), 32)
    save("subpatches")


main()
