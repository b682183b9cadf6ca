"""Runs inside Blender: meshes that modifiers and shape keys deform, in the colours of their Generated coordinates and bumped by
them, in both engines."""

import sys
from pathlib import Path

import both_engines
import bpy
import numpy as np
import scenes

PIXELS = 64  # of a case, a square
CASES = ("bent", "bent and subdivided", "by a shape key", "by a shape key, subdivided", "bumped", "around an axis")


def material(case):
    """Shines in Generated coordinates, or in the normal that a wave over them bends, or in a tangent around their axis."""
    made, tree, output = scenes.material(case)
    tree.nodes.clear()
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    emission, place = tree.nodes.new("ShaderNodeEmission"), tree.nodes.new("ShaderNodeTexCoord")
    tree.links.new(emission.outputs[0], output.inputs["Surface"])
    source = place.outputs["Generated"]
    if case == "bumped":
        wave, bump = tree.nodes.new("ShaderNodeTexWave"), tree.nodes.new("ShaderNodeBump")
        wave.inputs["Scale"].default_value, bump.inputs["Distance"].default_value = 0.3, 0.2
        tree.links.new(place.outputs["Generated"], wave.inputs["Vector"])
        tree.links.new(wave.outputs["Fac"], bump.inputs["Height"])
        source = bump.outputs[0]
    elif case == "around an axis":
        tangent = tree.nodes.new("ShaderNodeTangent")
        tangent.direction_type = "RADIAL"
        source = tangent.outputs[0]
    shifted = tree.nodes.new("ShaderNodeVectorMath")
    shifted.inputs[1].default_value = (1.0, 1.0, 1.0)  # there is no negative light
    tree.links.new(source, shifted.inputs[0])
    tree.links.new(shifted.outputs[0], emission.inputs["Color"])
    return made


def deformed(case, x):
    """A tube at the middle of a square, deformed."""
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=24, y_subdivisions=24, size=0.7, location=(x, 0.5, 0))
    item = bpy.context.object
    item.rotation_euler = (0.3, 0.2, 0.1)
    bpy.ops.object.shade_smooth()
    item.data.materials.append(material(case))
    if "shape key" in case:
        item.shape_key_add(name="flat")
        key = item.shape_key_add(name="skewed")
        for point in key.data:
            point.co.x, point.co.z = 0.7 * point.co.x + 0.3 * point.co.y, 0.2 * np.sin(6 * point.co.x)
        key.value = 1.0
    else:
        bend = item.modifiers.new("bend", "SIMPLE_DEFORM")
        bend.deform_method, bend.angle, bend.deform_axis = "BEND", 2.0, "Z"
        twist = item.modifiers.new("twist", "SIMPLE_DEFORM")
        twist.deform_method, twist.angle, twist.deform_axis = "TWIST", 0.6, "X"
    if "subdivided" in case:
        smooth = item.modifiers.new("smooth", "SUBSURF")
        smooth.levels = smooth.render_levels = 4


if __name__ == "__main__":
    report = globals()["report"]  # given by the test
    scenes.empty_file()
    scene = bpy.context.scene
    scenes.plain_world((0, 0, 0))
    for number, case in enumerate(CASES):
        deformed(case, number + 0.5)
    report(pictures=both_engines.pictures_of_squares(scene, CASES, PIXELS, 64, Path(sys.argv[1])))
