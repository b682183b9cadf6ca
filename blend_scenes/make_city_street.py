"""Makes city_street.blend: houses, lamps, cars and trees, shaded by what is near: short-range ambient occlusion times colour.

All is NURBS but the trees' crowns and the bushes, which are subdivision surfaces. After the folder may follow the number
of houses on either side.
"""

import sys
from pathlib import Path
from typing import Any

import bmesh
import bpy
import numpy as np

sys.path.append(str(Path(__file__).resolve().parent))
from scene_cars import Parts, car  # noqa: E402
from scene_shapes import Part  # noqa: E402
from scene_street import awning, bollard, flat, house, lamp_post, pavement, upright  # noqa: E402
from scene_tools import (  # noqa: E402
    NodeTree,
    add_camera,
    add_parts,
    arguments,
    color_ramp,
    link,
    matte,
    save,
    start_empty,
)

ROAD, WALK = 3.6, 3.0  # half the road's width, the pavement's width
WALLS = (
    (0.75, 0.62, 0.45),
    (0.72, 0.42, 0.32),
    (0.8, 0.77, 0.7),
    (0.5, 0.6, 0.62),
    (0.78, 0.7, 0.42),
    (0.62, 0.5, 0.52),
)
COLORS = {
    **{"stone": (0.72, 0.7, 0.66), "pane": (0.1, 0.14, 0.18), "shutter": (0.12, 0.3, 0.24), "iron": (0.06, 0.06, 0.07)},
    **{"roof": (0.36, 0.14, 0.09), "door": (0.25, 0.1, 0.05), "globe": (0.95, 0.92, 0.82), "glass": (0.05, 0.06, 0.07)},
    **{"chrome": (0.7, 0.7, 0.72), "rubber": (0.03, 0.03, 0.03), "shade": (0.02, 0.02, 0.02), "lamp": (0.9, 0.88, 0.8)},
    **{"tail lamp": (0.6, 0.03, 0.03), "leaves": (0.16, 0.34, 0.08), "bark": (0.2, 0.13, 0.08)},
    **{"asphalt": (0.2, 0.2, 0.21), "flags": (0.55, 0.54, 0.52), "line": (0.8, 0.8, 0.78)},
}
PAINTS = ((0.6, 0.06, 0.05), (0.1, 0.25, 0.55), (0.8, 0.72, 0.3), (0.75, 0.75, 0.72), (0.15, 0.35, 0.3))


def look(name: str, color: tuple[float, float, float]) -> Any:
    """The matte material of a name, made once."""
    return bpy.data.materials.get(name) or matte(name, color)


def place(name: str, parts: Parts, location: tuple[float, float, float], turn: float, **looks: Any) -> None:
    """An object a material; `looks` replaces materials by kind."""
    for kind, made in parts.items():
        if made:
            thing = add_parts(f"{name} {kind}", made, location, resolution=1)
            thing.rotation_euler = (0, 0, turn)
            thing.data.materials.append(looks.get(kind) or look(kind, COLORS[kind]))


def leafy(name: str, random: np.random.Generator, location: tuple[float, float, float], size: float) -> None:
    """A lumpy crown: a cage of triangles whose limit surface is smooth."""
    mesh = bpy.data.meshes.new(name)
    cage = bmesh.new()
    bmesh.ops.create_icosphere(cage, subdivisions=2, radius=size)
    for vertex in cage.verts:
        vertex.co *= 1 + random.uniform(-0.28, 0.28)
    cage.to_mesh(mesh)
    cage.free()
    mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))
    mesh.materials.append(look("leaves", COLORS["leaves"]))
    crown = link(name, mesh, location)
    modifier = crown.modifiers.new("subdivision", "SUBSURF")
    modifier.levels = modifier.render_levels = 3


def tree(index: int, random: np.random.Generator, x: float, y: float) -> None:
    """A trunk with three crowns."""
    path = np.array([(0, 0, 0), (0.05, 0.02, 0.9), (-0.04, 0.05, 1.8), (0.03, 0, 2.8)])
    place(f"tree {index}", {"bark": [upright(path, 0.13)]}, (x, y, 0.1), 0)
    for part, (dx, dy, z, size) in enumerate([(0, 0, 3.5, 1.15), (0.6, 0.3, 3.0, 0.75), (-0.55, -0.2, 3.1, 0.8)]):
        leafy(f"crown {index} {part}", random, (x + dx, y + dy, z), size)


def side_of_street(random: np.random.Generator, houses: int, facing: int) -> None:
    """Houses, pavement, lamps, trees and bollards; facing is +1 for the houses behind +y."""
    turn = 0.0 if facing > 0 else np.pi
    x = 0.0
    for index in range(houses):
        windows = int(random.integers(3, 5))
        width = 2.1 * windows + 0.6
        name, wall = f"house {facing} {index}", WALLS[int(random.integers(len(WALLS)))]
        made = house(random, width, int(random.integers(2, 5)), windows)
        middle = (x + width / 2, facing * (ROAD + WALK), 0.15)
        place(name, made, middle, turn, wall=look(f"wall {WALLS.index(wall)}", wall))
        if index % 2:
            cloth = look(f"cloth {index % 3}", PAINTS[index % 3])
            place(f"awning {name}", {"cloth": [awning(width * 0.8)]}, (middle[0], middle[1], 3.3), turn, cloth=cloth)
        x += width
    walk = pavement(x + 30, WALK + 8)
    place(f"pavement {facing}", {"flags": [walk]}, (x / 2, facing * ROAD, 0), turn)
    for index, along in enumerate(np.arange(3.0, x, 9.0)):
        place(f"lamp {facing} {index}", lamp_post(), (along, facing * (ROAD + 0.4), 0.14), turn)
        tree(index + (100 if facing > 0 else 0), random, along + 4.5, facing * (ROAD + 0.9))
        for step in (-1.5, 1.5, 3.0):
            place(f"bollard {facing} {index} {step}", bollard(), (along + step, facing * (ROAD + 0.35), 0.14), 0)


def cars(random: np.random.Generator, length: float) -> None:
    """Parked on both sides."""
    for index, x in enumerate(np.arange(5.0, length, 6.5)):
        facing = 1 if index % 2 else -1
        paint = PAINTS[index % len(PAINTS)]
        location = (float(x + random.normal(0, 0.3)), facing * (ROAD - 1.0), 0.0)
        place(
            f"car {index}",
            car(),
            location,
            0.0 if facing < 0 else np.pi,
            paint=look(f"paint {index % len(PAINTS)}", paint),
        )


def end_of_street(random: np.random.Generator, x: float) -> None:
    """Two houses across."""
    for index, y in enumerate((-5.0, 5.0)):
        wall = look(f"wall {index}", WALLS[index])
        place(f"end {index}", house(random, 10.0, 3 + index, 4), (x, y, 0.15), -np.pi / 2, wall=wall)


def bright_world() -> None:
    """White light; the camera sees a sky of blue above the horizon."""
    world = bpy.data.worlds.new("sky")
    bpy.context.scene.world = world
    tree = NodeTree(world)
    height = tree.add("ShaderNodeSeparateXYZ", {"Vector": tree.add("ShaderNodeTexCoord").outputs["Generated"]}).outputs[
        "Z"
    ]
    blue = color_ramp(tree, height, ((0.0, (0.8, 0.88, 0.95)), (0.6, (0.16, 0.38, 0.75)))).outputs["Color"]
    seen = tree.add("ShaderNodeLightPath").outputs["Is Camera Ray"]
    sky = tree.add("ShaderNodeMixRGB", {"Fac": seen, "Color1": (1, 1, 1, 1), "Color2": blue})
    background = tree.add("ShaderNodeBackground", {"Color": sky.outputs[0], "Strength": 1.0})
    tree.add("ShaderNodeOutputWorld", {"Surface": background.outputs[0]})


def road(length: float) -> list[Part]:
    """Dashes in the middle."""
    return [
        flat(np.array([x, 0, 0.004]), np.array([0.9, 0, 0]), np.array([0, 0.06, 0])) for x in np.arange(0, length, 4.5)
    ]


def main() -> None:
    words = arguments()[1:]
    houses = int(words[0]) if words else 4
    random = np.random.default_rng(31)
    start_empty(width=960, height=540, samples=8)
    for facing in (1, -1):
        side_of_street(random, houses, facing)
    length = houses * 8.0
    cars(random, length)
    end_of_street(random, length + 6)
    ground = flat(np.array([length / 2, 0, 0]), np.array([length + 60, 0, 0]), np.array([0, 60.0, 0]))
    place("road", {"asphalt": [ground], "line": road(length)}, (0, 0, 0), 0)
    settings = bpy.context.scene.rayleaf
    settings.integrator, settings.indirect = "DISTRIBUTION", "AMBIENT_OCCLUSION"
    settings.occlusion_distance = 1.5
    bright_world()
    add_camera((-7.5, -1.6, 2.3), (16, 0.6, 2.9), 24)
    save("city_street")


main()
