"""Runs inside Blender: point clouds, by their attributes, coordinates and nodes, and in glass and matte, in both engines."""

import sys
from pathlib import Path

import both_engines
import bpy
import scenes

PIXELS = 96  # of a case, a square
CASES = ("Position", "Radius", "Random", "Generated", "Object", "Attribute", "Normal", "matte", "glass")


def material(case):
    """Shines in what the case names, or scatters."""
    made, tree, _ = scenes.material(case)
    nodes, links = tree.nodes, tree.links
    nodes.clear()
    output = nodes.new("ShaderNodeOutputMaterial")
    if case in ("matte", "glass"):
        shader = nodes.new("ShaderNodeBsdfDiffuse" if case == "matte" else "ShaderNodeBsdfGlass")
        links.new(shader.outputs[0], output.inputs["Surface"])
        return made
    emission, shifted = nodes.new("ShaderNodeEmission"), nodes.new("ShaderNodeVectorMath")
    info, place = nodes.new("ShaderNodePointInfo"), nodes.new("ShaderNodeTexCoord")
    attribute = nodes.new("ShaderNodeAttribute")
    attribute.attribute_name = "heat"
    if case == "Attribute":
        source = attribute.outputs["Color"]
    else:
        source = (place if case in ("Generated", "Object", "Normal") else info).outputs[case]
    shifted.inputs[1].default_value = (12.0, 12.0, 12.0)  # there is no negative light
    links.new(source, shifted.inputs[0])
    links.new(shifted.outputs[0], emission.inputs["Color"])
    links.new(emission.outputs[0], output.inputs["Surface"])
    return made


def cloud(case, x):
    """The corners of a grid as points of several sizes."""
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=3, y_subdivisions=3, size=0.5, location=(x, 0.5, 0))
    item = bpy.context.object
    item.rotation_euler, item.scale = (0.2, 0.1, 0.3), (1.1, 1.1, 1.1)
    for number, vertex in enumerate(item.data.vertices):
        vertex.co.z = 0.03 * (number % 5)
    for name, kind in (("heat", "FLOAT_VECTOR"), ("size", "FLOAT")):
        item.data.attributes.new(name, kind, "POINT")
    heat, size = item.data.attributes["heat"], item.data.attributes["size"]
    for number in range(len(item.data.vertices)):
        heat.data[number].vector = (0.1 * number, 1 - 0.05 * number, 0.3)
        size.data[number].value = 0.03 + 0.005 * number
    modifier = item.modifiers.new("points", "NODES")
    tree = scenes.group("points", "NodeSocketGeometry", "NodeSocketGeometry", "GeometryNodeTree")
    nodes, links = tree.nodes, tree.links
    start, end = nodes.new("NodeGroupInput"), nodes.new("NodeGroupOutput")
    points, colored = nodes.new("GeometryNodeMeshToPoints"), nodes.new("GeometryNodeSetMaterial")
    named = nodes.new("GeometryNodeInputNamedAttribute")
    named.data_type, named.inputs["Name"].default_value = "FLOAT", "size"
    links.new(next(each for each in named.outputs if each.enabled), points.inputs["Radius"])
    colored.inputs["Material"].default_value = material(case)
    links.new(start.outputs[0], points.inputs[0])
    links.new(points.outputs[0], colored.inputs[0])
    links.new(colored.outputs[0], end.inputs[0])
    modifier.node_group = tree


if __name__ == "__main__":
    report = globals()["report"]  # given by the test
    scenes.empty_file()
    scene = bpy.context.scene
    scenes.plain_world((0.5, 0.5, 0.5))
    for number, case in enumerate(CASES):
        cloud(case, number + 0.5)
    sun = bpy.data.objects.new("sun", bpy.data.lights.new("sun", "SUN"))
    sun.data.energy, sun.rotation_euler = 3.0, (0.5, 0.4, 0)
    scene.collection.objects.link(sun)
    report(pictures=both_engines.pictures_of_squares(scene, CASES, PIXELS, 256, Path(sys.argv[1])))
