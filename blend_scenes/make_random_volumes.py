"""Makes random_volumes.blend: convex bodies of glass in random cells of a cube, each turned from 5 to 16 Bezier curves."""

import sys
from pathlib import Path

import bpy

sys.path.append(str(Path(__file__).resolve().parent))
from scene_shapes import random_volumes  # noqa: E402
from scene_tools import (  # noqa: E402
    NodeTree,
    add_camera,
    add_lamp,
    add_parts,
    color_ramp,
    link,
    save,
    seed_argument,
    start_empty,
)

SEED, BODIES, SIDE = 7, 10, 6.0
TINTS = ((1, 1, 1), (0.82, 0.96, 0.9), (0.99, 0.88, 0.78), (0.84, 0.9, 1.0), (0.98, 0.84, 0.88))


def glass(index: int) -> bpy.types.Material:
    """Clear glass, a little tinted."""
    made = bpy.data.materials.new(f"glass {index}")
    tree = NodeTree(made)
    shader = tree.add("ShaderNodeBsdfGlass", {"Color": (*TINTS[index], 1), "Roughness": 0.0, "IOR": 1.45})
    tree.add("ShaderNodeOutputMaterial", {"Surface": shader.outputs[0]})
    return made


def striped_world() -> None:
    """A sky with bands, so that one sees what the glass does to it."""
    world = bpy.data.worlds.new("bands")
    bpy.context.scene.world = world
    tree = NodeTree(world)
    direction = tree.add("ShaderNodeTexCoord").outputs["Generated"]
    placed = tree.add("ShaderNodeMapping", {"Vector": direction, "Scale": (1.2, 1.2, 2.2)}).outputs[0]
    noise = tree.add("ShaderNodeTexNoise", {"Vector": placed, "Scale": 1.6, "Detail": 1.0, "Distortion": 0.3})
    stops = (
        (0.3, (0.02, 0.05, 0.14)),
        (0.44, (0.1, 0.35, 0.5)),
        (0.5, (0.9, 0.9, 0.82)),
        (0.57, (0.95, 0.55, 0.2)),
        (0.7, (0.35, 0.06, 0.05)),
    )
    sky = color_ramp(tree, noise.outputs["Fac"], stops).outputs["Color"]
    background = tree.add("ShaderNodeBackground", {"Color": sky, "Strength": 0.9})
    tree.add("ShaderNodeOutputWorld", {"Surface": background.outputs[0]})


def checkered_floor() -> None:
    """Below the bodies."""
    made = bpy.data.materials.new("floor")
    tree = NodeTree(made)
    position = tree.add("ShaderNodeTexCoord").outputs["Object"]
    above = tree.add("ShaderNodeMapping", {"Vector": position, "Location": (0, 0, 0.5)}).outputs[0]
    colors = {"Vector": above, "Color1": (0.75, 0.74, 0.7, 1), "Color2": (0.12, 0.14, 0.17, 1), "Scale": 0.9}
    checker = tree.add("ShaderNodeTexChecker", colors)
    shader = tree.add("ShaderNodeBsdfDiffuse", {"Color": checker.outputs["Color"]})
    tree.add("ShaderNodeOutputMaterial", {"Surface": shader.outputs[0]})
    mesh = bpy.data.meshes.new("floor")
    mesh.from_pydata([(-30, -30, 0), (30, -30, 0), (30, 30, 0), (-30, 30, 0)], [], [(0, 1, 2, 3)])
    mesh.materials.append(made)
    link("floor", mesh, (0, 0, -SIDE / 2 - 0.4))


def main() -> None:
    start_empty(width=640, height=640, samples=48)
    bpy.context.scene.rayleaf.ray_interpolation.mode = "AUTO"
    looks = [glass(index) for index in range(len(TINTS))]
    for index, body in enumerate(random_volumes(seed_argument(SEED), BODIES, SIDE)):
        add_parts(f"body {index}", [body]).data.materials.append(looks[index % len(looks)])
    striped_world()
    checkered_floor()
    add_lamp("sun", "SUN", (4, -6, 9), (0, 0, 0), 2.5, (1.0, 0.94, 0.86))
    add_camera((6.5, -9.5, 4.6), (0.0, 0.0, -0.35), 46)
    save("random_volumes")


main()
