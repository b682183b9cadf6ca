"""The nodes Ambient Occlusion, Bevel and Raycast in both engines: bodies on a floor that glow by what the node says. Inside
Blender."""

import sys
from pathlib import Path

import both_engines
import bpy
import scenes
from oracle_case import described_nodes

SIZE, SAMPLES = 48, 32
# Node, its properties, its inputs; linked: what a wave bends the normal by.
CASES = {
    "occlusion": ("AmbientOcclusion", {"samples": 8}, {"Distance": 1.0}, False),
    "near": ("AmbientOcclusion", {"samples": 4}, {"Distance": 0.25}, False),
    "without distance": ("AmbientOcclusion", {"samples": 8}, {"Distance": 0.0}, False),
    "inside": ("AmbientOcclusion", {"samples": 8, "inside": True}, {"Distance": 0.6}, False),
    "local": ("AmbientOcclusion", {"samples": 8, "only_local": True}, {"Distance": 1.0}, False),
    "bent": ("AmbientOcclusion", {"samples": 8}, {"Distance": 1.0}, True),
    "tinted": ("AmbientOcclusion", {"samples": 3}, {"Distance": 1.0, "Color": (0.9, 0.5, 0.1, 1)}, False),
    "bevel": ("Bevel", {"samples": 8}, {"Radius": 0.15}, False),
    "wide bevel": ("Bevel", {"samples": 4}, {"Radius": 0.5}, False),
    "bent bevel": ("Bevel", {"samples": 8}, {"Radius": 0.2}, True),
    "no bevel": ("Bevel", {"samples": 2}, {"Radius": 0.0}, False),
}
SLANTED, INWARDS = ({"Direction": way, "Length": 1.4} for way in ((0.9, -0.5, 0.7), (0.3, -0.2, -1.2)))
# Since 5.1: the node's properties, its inputs, and the output.
RAYCASTS = {
    "along the normal": ({}, {"Length": 2.0}, "Is Hit"),
    "slanted": ({}, SLANTED, "Is Hit"),
    "local": ({"only_local": True}, INWARDS, "Is Hit"),
    "self": ({}, INWARDS, "Self Hit"),
    "distance": ({}, SLANTED, "Hit Distance"),
    "place": ({}, SLANTED, "Hit Position"),
    "normal there": ({}, SLANTED, "Hit Normal"),
    "from below": ({}, {"Position": (0.1, 0.0, -2.0), "Direction": "normal", "Length": 5.0}, "Hit Normal"),
}


def bend(tree, node):
    """A normal that leans along the x axis by half."""
    geometry, lean = tree.nodes.new("ShaderNodeNewGeometry"), tree.nodes.new("ShaderNodeVectorMath")
    lean.operation, lean.inputs[1].default_value = "ADD", (0.5, 0.0, 0.0)
    unit = tree.nodes.new("ShaderNodeVectorMath")
    unit.operation = "NORMALIZE"
    tree.links.new(geometry.outputs["Normal"], lean.inputs[0])
    tree.links.new(lean.outputs[0], unit.inputs[0])
    tree.links.new(unit.outputs[0], node.inputs["Normal"])


def glow(kind, properties, inputs, bent):
    """A material that shines by the node's answer; vectors are brought to 0..1."""
    material, tree, output = scenes.material(kind)
    node = tree.nodes.new(f"ShaderNode{kind}")
    for name, value in properties.items():
        setattr(node, name, value)
    for name, value in inputs.items():
        node.inputs[name].default_value = value
    if bent:
        bend(tree, node)
    answer = node.outputs["Color" if "Color" in inputs else "AO"] if kind == "AmbientOcclusion" else node.outputs[0]
    if kind == "Bevel":
        scaled = tree.nodes.new("ShaderNodeVectorMath")
        scaled.operation = "MULTIPLY_ADD"
        scaled.inputs[1].default_value = scaled.inputs[2].default_value = (0.5, 0.5, 0.5)
        tree.links.new(answer, scaled.inputs[0])
        answer = scaled.outputs[0]
    shine = tree.nodes.new("ShaderNodeEmission")
    tree.links.new(answer, shine.inputs["Color"])
    tree.links.new(shine.outputs[0], output.inputs["Surface"])
    return material


def cast(properties, inputs, output_name):
    """A material that shines by what a ray meets, brought to 0..1."""
    material, tree, output = scenes.material("Raycast")
    node, shine = tree.nodes.new("ShaderNodeRaycast"), tree.nodes.new("ShaderNodeEmission")
    for name, value in properties.items():
        setattr(node, name, value)
    for name, value in inputs.items():
        if value == "normal":
            source = tree.nodes.new("ShaderNodeNewGeometry").outputs["Normal"]
        elif name == "Length":
            node.inputs[name].default_value = value
            continue
        else:
            made = tree.nodes.new("ShaderNodeCombineXYZ")
            for socket, number in zip(made.inputs, value):
                socket.default_value = number
            source = made.outputs[0]
        tree.links.new(source, node.inputs[name])
    scaled = tree.nodes.new("ShaderNodeVectorMath")
    scaled.operation = "MULTIPLY_ADD"
    scaled.inputs[1].default_value, scaled.inputs[2].default_value = (0.3, 0.3, 0.3), (0.5, 0.5, 0.5)
    tree.links.new(node.outputs[output_name], scaled.inputs[0])
    tree.links.new(scaled.outputs[0], shine.inputs["Color"])
    tree.links.new(shine.outputs[0], output.inputs["Surface"])
    return material


def materials():
    """By case: what makes its material."""
    found = {case: (glow, described) for case, described in CASES.items()}
    if hasattr(bpy.types, "ShaderNodeRaycast"):
        found |= {f"raycast {case}": (cast, described) for case, described in RAYCASTS.items()}
    return found


def build():
    """A floor, a turned block that stands on it, and a smooth head."""
    scenes.empty_file()
    both_engines.white_floor(4.0)
    scene = bpy.context.scene
    scene.camera.location, scene.camera.rotation_euler = (2, -6, 5), (0.9, 0, 0.32)
    bpy.ops.mesh.primitive_cube_add(size=1.2, location=(-0.5, 0, 0.6), rotation=(0, 0, 0.5))
    bpy.ops.mesh.primitive_monkey_add(size=1.4, location=(0.8, 0.2, 0.65), rotation=(-0.3, 0, 0.3))
    bpy.ops.object.shade_smooth()
    both_engines.show_direct_light(scene, SIZE, SAMPLES)
    return scene


def compared_nodes():
    """By case: the node as it is compared."""
    scenes.empty_file()
    kinds = ("ShaderNodeAmbientOcclusion", "ShaderNodeBevel", "ShaderNodeRaycast")
    return {case: described_nodes(make(*described).node_tree, kinds) for case, (make, described) in materials().items()}


if __name__ == "__main__":
    report = globals()["report"]  # given by the test
    scene_of_all, folder, found = build(), Path(sys.argv[1]), {}
    things = [item for item in scene_of_all.objects if item.type == "MESH"]
    for case, (make, described) in materials().items():
        shining = make(*described)
        for thing in things:
            thing.data.materials.clear()
            thing.data.materials.append(shining)
        found[case] = {}
        for engine in ("CYCLES", "RAYLEAF"):
            path = folder / f"{engine} {case}.exr"
            found[case][engine] = both_engines.means(both_engines.picture(scene_of_all, engine, path)[..., :3], 8)
    report(found=found, nodes=compared_nodes())
