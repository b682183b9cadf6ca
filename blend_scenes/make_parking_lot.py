"""Makes parking_lot.blend: fifteen cars of NURBS with shiny paint, copied and not instanced, under sun and sky.

After the folder may follow the cars' detail: their bodies have that many times as many patches each way. And `diffuse`
or `occlusion`: what light the ground gathers from the sky, none, or all that the cars do not hide.
"""

import sys
from pathlib import Path
from typing import Any

import bpy
import numpy as np

sys.path.append(str(Path(__file__).resolve().parent))
from scene_cars import car  # noqa: E402
from scene_shapes import Part, table  # noqa: E402
from scene_tools import (  # noqa: E402
    NodeTree,
    add_camera,
    add_lamp,
    add_parts,
    arguments,
    link,
    material,
    plain_world,
    save,
    start_empty,
)

COLUMNS, ROWS = 5, 3
STALL, AISLE = 2.5, 6.2
PAINTS = (
    *((0.55, 0.02, 0.02), (0.02, 0.1, 0.4), (0.75, 0.72, 0.65), (0.02, 0.2, 0.08), (0.85, 0.4, 0.02)),
    *((0.03, 0.03, 0.035), (0.25, 0.5, 0.6), (0.6, 0.08, 0.25), (0.35, 0.37, 0.4), (0.8, 0.65, 0.1)),
)


def shiny(name: str, color: tuple[float, float, float]) -> Any:
    """Matte paint under a clear coat that mirrors, more so where one looks along it."""
    made = bpy.data.materials.new(name)
    tree = NodeTree(made)
    matte = tree.add("ShaderNodeBsdfDiffuse", {"Color": (*color, 1)})
    coat = tree.add("ShaderNodeBsdfGlossy", {"Color": (1, 1, 1, 1), "Roughness": 0.0})
    weight = tree.add("ShaderNodeFresnel", {"IOR": 1.6})
    mixed = tree.add("ShaderNodeMixShader", {0: weight.outputs[0], 1: matte.outputs[0], 2: coat.outputs[0]})
    tree.add("ShaderNodeOutputMaterial", {"Surface": mixed.outputs[0]})
    made.diffuse_color = (*color, 1)
    return made


def mirror(name: str, color: tuple[float, float, float]) -> Any:
    """A perfect mirror."""
    made = bpy.data.materials.new(name)
    tree = NodeTree(made)
    shader = tree.add("ShaderNodeBsdfGlossy", {"Color": (*color, 1), "Roughness": 0.0})
    tree.add("ShaderNodeOutputMaterial", {"Surface": shader.outputs[0]})
    return made


def make_car(detail: int) -> list[Any]:
    """One car of an object a material, at the origin, with slots that the copies fill."""
    looks = {
        "glass": shiny("glass", (0.012, 0.016, 0.018)),
        "chrome": mirror("chrome", (0.75, 0.76, 0.78)),
        "rubber": material("rubber", (0.02, 0.02, 0.02), 0.7),
        "shade": material("shade", (0.01, 0.01, 0.01), 0.8),
        "lamp": shiny("lamp", (0.8, 0.8, 0.75)),
        "tail lamp": shiny("tail lamp", (0.5, 0.01, 0.01)),
    }
    made = []
    for kind, parts in car(detail).items():
        # Blender tessellates surfaces whatever engine renders; Rayleaf does not look at that, so the least will do.
        thing = add_parts(kind, parts, resolution=1)
        thing.data.materials.append(looks.get(kind))
        made.append(thing)
    return made


def park(first: list[Any]) -> None:
    """Fill the stalls with copies of the car, data included, each in a paint of its own and not quite straight."""
    random = np.random.default_rng(15)
    for index in range(COLUMNS * ROWS):
        column, row = index % COLUMNS, index // COLUMNS
        paint = shiny(
            f"paint {index}", PAINTS[index % len(PAINTS)] if index < 10 else PAINTS[(index * 3 + 1) % len(PAINTS)]
        )
        turn = np.pi / 2 * (1 if row % 2 else -1) + random.normal(0, 0.03)
        place = ((column - (COLUMNS - 1) / 2) * STALL + random.normal(0, 0.08), row * AISLE + random.normal(0, 0.15), 0)
        for part in first:
            copy = link(f"{part.name} {index}", part.data.copy(), place)
            copy.rotation_euler = (0, 0, turn)
            if part.name == "paint":
                copy.data.materials[0] = paint
    for part in first:
        data = part.data
        bpy.data.objects.remove(part)
        bpy.data.curves.remove(data)


def ground() -> None:
    """Asphalt, and white lines between the stalls."""
    asphalt = add_parts("ground", [table(400.0)])
    asphalt.data.materials.append(material("asphalt", (0.16, 0.16, 0.165), 0.9, Specular=0.0))
    lines = []
    for row in range(ROWS):
        for column in range(COLUMNS + 1):
            x = (column - COLUMNS / 2) * STALL
            lines.append(table(1.0).moved(np.diag([0.1, 4.6, 1.0]), np.array([x, row * AISLE, 0.004])))
    add_parts("lines", lines).data.materials.append(material("white", (0.7, 0.7, 0.68), 0.9, Specular=0.0))


def main() -> None:
    words = arguments()[1:]
    detail = next((int(word) for word in words if word.isdigit()), 1)
    start_empty(width=960, height=540, samples=8)
    settings = bpy.context.scene.rayleaf
    settings.integrator = "DISTRIBUTION"
    settings.indirect = "NONE" if "diffuse" in words else "AMBIENT_OCCLUSION"
    settings.light_rays = 1
    park(make_car(detail))
    ground()
    plain_world((0.5, 0.65, 0.9), 0.55 if settings.indirect == "AMBIENT_OCCLUSION" else 1.0)
    add_lamp("sun", "SUN", (-8, -9, 14), (0, 0, 0), 3.2, (1.0, 0.93, 0.82)).data.angle = 0.0
    add_camera((7.4, -9.6, 5.4), (0.2, 3.6, 0.2), 38)
    save("parking_lot")


main()
