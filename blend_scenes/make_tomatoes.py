"""Makes tomatoes.blend: tomatoes in a mirroring bowl under plastic wrap, one beside it, on a table that reflects.

Everything is made of splines. The wrap reflects and is seen through without bending light; around all is a large painted
sphere.
"""

import sys
from pathlib import Path

import bpy

sys.path.append(str(Path(__file__).resolve().parent))
from scene_shapes import TomatoScene  # noqa: E402
from scene_tools import (  # noqa: E402
    NodeTree,
    add_camera,
    add_lamp,
    add_parts,
    material,
    painted_sky,
    save,
    start_empty,
)

SPHERE = 40.0  # radius


def metal(name: str, color: tuple[float, float, float]) -> bpy.types.Material:
    """A perfect mirror of one colour."""
    made = bpy.data.materials.new(name)
    tree = NodeTree(made)
    shader = tree.add("ShaderNodeBsdfGlossy", {"Color": (*color, 1), "Roughness": 0.0})
    tree.add("ShaderNodeOutputMaterial", {"Surface": shader.outputs[0]})
    return made


def wrap() -> bpy.types.Material:
    """A clear film: more of a mirror where one looks along it."""
    made = bpy.data.materials.new("plastic wrap")
    tree = NodeTree(made)
    clear = tree.add("ShaderNodeBsdfTransparent", {"Color": (0.97, 0.97, 0.98, 1)})
    shiny = tree.add("ShaderNodeBsdfGlossy", {"Color": (1, 1, 1, 1), "Roughness": 0.0})
    facing = tree.add("ShaderNodeLayerWeight", {"Blend": 0.3}).outputs["Facing"]
    weight = tree.add("ShaderNodeMath", {0: facing, 1: 0.55}, operation="MULTIPLY").outputs[0]
    least = tree.add("ShaderNodeMath", {0: weight, 1: 0.1}, operation="ADD").outputs[0]
    mixed = tree.add("ShaderNodeMixShader", {0: least, 1: clear.outputs[0], 2: shiny.outputs[0]})
    tree.add("ShaderNodeOutputMaterial", {"Surface": mixed.outputs[0]})
    return made


def main() -> None:
    start_empty(width=800, height=600, samples=48)
    bpy.context.scene.rayleaf.ray_interpolation.mode = "AUTO"
    made = TomatoScene()
    skin = material("tomato skin", (0.72, 0.055, 0.02), 0.28, Specular=0.5, Clearcoat=0.4, Clearcoat_Roughness=0.08)
    add_parts("bowl", [made.bowl]).data.materials.append(metal("steel", (0.82, 0.83, 0.86)))
    add_parts("wrap", [made.wrap]).data.materials.append(wrap())
    add_parts("tomato beside", [made.beside]).data.materials.append(skin)
    for index, part in enumerate(made.in_bowl):
        add_parts(f"tomato {index}", [part]).data.materials.append(skin)
    add_parts("table", [made.table]).data.materials.append(metal("polished stone", (0.33, 0.34, 0.38)))
    bpy.ops.surface.primitive_nurbs_surface_sphere_add(radius=SPHERE)
    sphere = bpy.context.object
    sphere.name = sphere.data.name = "sphere"
    sphere.data.materials.append(painted_sky())
    bpy.context.scene.world = None
    key = add_lamp("window", "AREA", (-6.0, -5.0, 8.0), (0, 0, 1), 900, (1.0, 0.95, 0.88))
    key.data.size = 3.0
    add_camera((2.6, -10.6, 5.0), (0.55, -0.1, 0.85), 42)
    save("tomatoes")


main()
