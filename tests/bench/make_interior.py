"""Makes interior.blend: a library with two hundred textures, each an image of its own, and forty lamps.

After the folder may follow the size of the images, in pixels along their sides.
"""

import sys
from collections.abc import Iterator
from itertools import cycle
from pathlib import Path
from typing import Any

import bpy
import numpy as np

sys.path[:0] = [str(Path(__file__).resolve().parent), str(Path(__file__).resolve().parents[2] / "blend_scenes")]
from interior_textures import textures  # noqa: E402
from scene_tools import (  # noqa: E402
    NodeTree,
    Triple,
    add_camera,
    add_lamp,
    arguments,
    glass,
    lathe,
    add_grid,
    add_surface,
    link,
    make_circle_of_u,
    material,
    pack_image,
    plain_world,
    save,
    start_empty,
)

IMAGE_SIZE = 512
WIDTH, DEPTH, HEIGHT = 8.0, 10.0, 3.4  # of the room, metres; it begins at y = 0, its middle is at x = 0
Looks = dict[str, Iterator[Any]]


def textured(name: str, image: Any, roughness: float) -> Any:
    """A material with an image on the UV map, shinier where the image is bright."""
    made = bpy.data.materials.new(name)
    tree = NodeTree(made)
    place = tree.add("ShaderNodeTexCoord").outputs["UV"]
    picture = tree.add("ShaderNodeTexImage", {"Vector": place}, image=image).outputs["Color"]
    rough = tree.add("ShaderNodeMath", {0: picture, 1: -0.2, 2: roughness + 0.1}, operation="MULTIPLY_ADD")
    shader = tree.add("ShaderNodeBsdfPrincipled", {"Base Color": picture, "Roughness": rough.outputs[0]})
    tree.add("ShaderNodeOutputMaterial", {"Surface": shader.outputs[0]})
    return made


def make_looks(size: int) -> Looks:
    """The materials of each group of textures, over and over."""
    rough = {"floor": 0.35, "stone": 0.2, "tile": 0.3, "furniture": 0.4}
    looks: Looks = {}
    for group, pictures in textures(7, size).items():
        made = [
            textured(f"{group} {index}", pack_image(f"{group} {index}", pixels, "sRGB"), rough.get(group, 0.7))
            for index, pixels in enumerate(pictures)
        ]
        looks[group] = cycle(made)
    return looks


# --- shapes --------------------------------------------------------------------------------------------------------


def quads(name: str, corners: list[list[Triple]], look: Any, repeats: float = 1.0) -> Any:
    """Rectangles, each with all of the texture, or so often as `repeats` says."""
    mesh = bpy.data.meshes.new(name)
    points = [corner for quad in corners for corner in quad]
    mesh.from_pydata(points, [], [tuple(range(4 * index, 4 * index + 4)) for index in range(len(corners))])
    layer = mesh.uv_layers.new(name="UVMap")
    square = np.array([(0, 0), (1, 0), (1, 1), (0, 1)], np.float32) * repeats
    layer.data.foreach_set("uv", np.tile(square, (len(corners), 1)).ravel())
    mesh.materials.append(look)
    return link(name, mesh)


def box(name: str, low: Triple, high: Triple, look: Any, bevel: float = 0.0) -> Any:
    """Six rectangles that face outwards."""
    (x, y, z), (X, Y, Z) = low, high
    sides: list[list[Triple]] = [
        [(x, y, z), (X, y, z), (X, y, Z), (x, y, Z)],
        [(X, Y, z), (x, Y, z), (x, Y, Z), (X, Y, Z)],
        [(x, Y, z), (x, y, z), (x, y, Z), (x, Y, Z)],
        [(X, y, z), (X, Y, z), (X, Y, Z), (X, y, Z)],
        [(x, y, Z), (X, y, Z), (X, Y, Z), (x, Y, Z)],
        [(x, Y, z), (X, Y, z), (X, y, z), (x, y, z)],
    ]
    made = quads(name, sides, look)
    if bevel:
        made.modifiers.new("weld", "WELD")
        made.modifiers.new("edges", "BEVEL").width = bevel
        made.modifiers["edges"].segments = 3
    return made


def add_room(looks: Looks) -> None:
    """Floor, ceiling, four walls."""
    x, y, z = WIDTH / 2, DEPTH, HEIGHT
    quads("floor", [[(-x, 0, 0), (x, 0, 0), (x, y, 0), (-x, y, 0)]], next(looks["floor"]), repeats=5)
    plaster = material("plaster", (0.8, 0.78, 0.74), 0.9)
    quads("ceiling", [[(-x, y, z), (x, y, z), (x, 0, z), (-x, 0, z)]], plaster)
    walls: list[list[Triple]] = [
        [(x, y, 0), (-x, y, 0), (-x, y, z), (x, y, z)],
        [(-x, y, 0), (-x, 0, 0), (-x, 0, z), (-x, y, z)],
        [(x, 0, 0), (x, y, 0), (x, y, z), (x, 0, z)],
        [(-x, 0, 0), (x, 0, 0), (x, 0, z), (-x, 0, z)],
    ]
    for index, wall in enumerate(walls):
        quads(f"wall {index}", [wall], next(looks["wall"]), repeats=4)


def add_shelves(random: np.random.Generator, looks: Looks) -> None:
    """Books along the back wall, on seven boards."""
    back = DEPTH - 0.02
    for level in range(7):
        z = 0.35 + 0.4 * level
        box(f"board {level}", (-3.6, back - 0.34, z - 0.03), (3.6, back, z), next(looks["furniture"]), 0.006)
        x = -3.55
        while x < 3.45:
            thick, tall, deep = random.uniform(0.03, 0.08), random.uniform(0.22, 0.34), random.uniform(0.2, 0.28)
            box("book", (x, back - 0.05 - deep, z), (x + thick, back - 0.05, z + tall), next(looks["book"]), 0.004)
            x += thick + (random.uniform(0.1, 0.3) if random.uniform() < 0.06 else 0.002)


def add_paintings(looks: Looks) -> None:
    """Two rows on both side walls, in frames."""
    for index in range(24):
        side, place, row = (-1 if index % 2 else 1), index // 2 % 6, index // 12
        y, z = 1.2 + 1.5 * place, 1.15 + 1.05 * row
        wall, front = side * WIDTH / 2, side * (WIDTH / 2 - 0.05)
        box(
            "frame",
            (min(wall, front), y - 0.5, z),
            (max(wall, front), y + 0.5, z + 0.85),
            next(looks["furniture"]),
            0.01,
        )
        x, near, far = side * (WIDTH / 2 - 0.053), y - side * 0.44, y + side * 0.44
        canvas: list[Triple] = [(x, near, z + 0.06), (x, far, z + 0.06), (x, far, z + 0.79), (x, near, z + 0.79)]
        quads("painting", [canvas], next(looks["painting"]))


def add_sofa(x: float, y: float, looks: Looks) -> None:
    """A frame and four cushions, rounded."""
    box("sofa", (x - 0.9, y - 0.4, 0.1), (x + 0.9, y + 0.4, 0.38), next(looks["furniture"]), 0.03)
    for index in range(4):
        left = x - 0.88 + 0.44 * index
        cushion = box("cushion", (left, y - 0.38, 0.38), (left + 0.43, y + 0.38, 0.58), next(looks["cushion"]))
        cushion.modifiers.new("weld", "WELD")
        cushion.modifiers.new("round", "SUBSURF").render_levels = 3
        cushion.data.polygons.foreach_set("use_smooth", [True] * 6)


def add_table(x: float, y: float, looks: Looks) -> None:
    """A top of stone on legs, with vases and books."""
    box("table top", (x - 0.6, y - 0.4, 0.68), (x + 0.6, y + 0.4, 0.74), next(looks["stone"]), 0.015)
    wood = next(looks["furniture"])
    for across in (-0.52, 0.52):
        for along in (-0.32, 0.32):
            low, high = (x + across - 0.03, y + along - 0.03, 0), (x + across + 0.03, y + along + 0.03, 0.68)
            box("leg", low, high, wood, 0.005)
    for index in range(3):
        box(
            "book",
            (x - 0.5, y - 0.2, 0.74 + 0.04 * index),
            (x - 0.2, y + 0.2, 0.78 + 0.04 * index),
            next(looks["book"]),
        )


def add_vase(x: float, y: float, z: float, look: Any) -> None:
    """A turned surface of splines."""
    profile = np.array([(0.0, 0.0), (0.09, 0.0), (0.16, 0.1), (0.14, 0.22), (0.04, 0.3), (0.05, 0.36), (0.08, 0.4)])
    vase = add_surface("vase", (x, y, z))
    spline = add_grid(vase, lathe(profile))
    make_circle_of_u(spline)
    spline.order_v, spline.use_endpoint_v = 4, True
    vase.data.materials.append(look)


def furnish(random: np.random.Generator, looks: Looks) -> None:
    """All that stands on the floor."""
    metal = material("brass", (0.85, 0.65, 0.3), 0.2, Metallic=1.0)
    china = material("china", (0.9, 0.9, 0.92), 0.15, Clearcoat=1.0)
    vases = cycle((china, glass("glass", (0.85, 0.95, 0.92), 1.5), metal))
    for index in range(5):
        x, y = (-3.05 if index % 2 else 3.05), 2.6 + 1.4 * index
        add_sofa(x, y, looks)
    for index in range(4):
        x, y = (1.45 if index % 2 else -1.45), 2.2 + 1.8 * index
        add_table(x, y + 0.6, looks)
        add_vase(x + 0.25, y + 0.6, 0.74, next(vases))
    for index in range(5):
        box("stand", (-0.35, 1.8 + 1.6 * index, 0), (0.05, 2.2 + 1.6 * index, 0.5), next(looks["stone"]), 0.02)
        add_vase(-0.15, 2.0 + 1.6 * index, 0.5, next(vases))
    for index in range(6):
        x, y = (-1.45, 1.45)[index % 2], 1.0 + 2.9 * (index // 2)
        low, high = (x - 0.8, y), (x + 0.8, y + 2.4)
        corners: list[Triple] = [(*low, 0.002), (high[0], low[1], 0.002), (*high, 0.002), (low[0], high[1], 0.002)]
        quads("rug", [corners], next(looks["tile"]), repeats=3)


def add_lamps() -> None:
    """Forty: eight soft panels, fourteen spots at the ceiling, eighteen small lamps on walls and tables."""
    for index in range(8):
        x, y = (-2.0, 2.0)[index % 2], 1.5 + 2.3 * (index // 2)
        panel = add_lamp("panel", "AREA", (x, y, HEIGHT - 0.02), (x, y, 0), 22, (1.0, 0.95, 0.88))
        panel.data.shape, panel.data.size, panel.data.size_y = "RECTANGLE", 0.6, 0.3
    for index in range(14):
        x, y = (-3.0, 3.0)[index % 2], 0.9 + 1.3 * (index // 2)
        spot = add_lamp("spot", "SPOT", (x, y, HEIGHT - 0.1), (1.28 * x, y, 1.5), 30, (1.0, 0.9, 0.75))
        spot.data.spot_size, spot.data.spot_blend, spot.data.shadow_soft_size = 1.0, 0.4, 0.04
    warm = (1.0, 0.72, 0.45)
    for index in range(18):
        if index < 8:
            place = (-3.4 + 0.97 * index, DEPTH - 0.5, HEIGHT - 0.3)
        else:
            place = ((-2.7, 2.7)[index % 2], 1.6 + 1.7 * ((index - 8) // 2), 1.1)
        add_lamp("bulb", "POINT", place, (0, 0, 0), 6, warm).data.shadow_soft_size = 0.05


def main() -> None:
    words = arguments()[1:]
    random = np.random.default_rng(11)
    start_empty(width=960, height=540, samples=32)
    looks = make_looks(int(words[0]) if words else IMAGE_SIZE)
    add_room(looks)
    add_shelves(random, looks)
    add_paintings(looks)
    furnish(random, looks)
    add_lamps()
    plain_world((0.5, 0.6, 0.8), 0.05)
    add_camera((0.5, 0.25, 1.75), (-0.2, 7.0, 1.15), 22)
    save("interior")


main()
