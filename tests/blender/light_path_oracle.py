"""Runs inside Blender: a plate that shines, and a pane that light goes through, by each output of Light Path, seen straight, in a
mirror, through glass and by what a matte floor shows of them; in both engines. Reports means over parts of the picture."""

import sys
from pathlib import Path

import both_engines
import bpy
import scenes
from oracle_case import described_nodes

SIZE, SAMPLES = 24, 256
KIND = "ShaderNodeLightPath"


def outputs():
    """All that the node has in this Blender."""
    tree = bpy.data.node_groups.new("Tree", "ShaderNodeTree")
    return [output.identifier for output in tree.nodes.new(KIND).outputs if output.enabled]


def cases():
    """By name: what is made by the node, and by which output."""
    return {f"{thing}, {output}": (thing, output) for thing in ("plate", "pane") for output in outputs()}


def ruled(thing, output):
    """The material of the plate or the pane, ruled by an output; without one a plain one."""
    material, tree, made = scenes.material(thing)
    shader = tree.nodes.new("ShaderNodeEmission" if thing == "plate" else "ShaderNodeBsdfTransparent")
    shader.inputs["Color"].default_value = (0.9, 0.6, 0.4, 1)
    if output:
        value = tree.nodes.new(KIND).outputs[output]
        limited = tree.nodes.new("ShaderNodeMath")  # lengths and depths become less than one
        limited.operation, limited.inputs[1].default_value = (
            "MULTIPLY",
            0.15 if "Depth" in output or "Length" in output else 1,
        )
        tree.links.new(value, limited.inputs[0])
        tree.links.new(limited.outputs[0], shader.inputs["Strength" if thing == "plate" else "Color"])
    tree.links.new(shader.outputs[0], made.inputs["Surface"])
    return material


def plane(material, size, location, rotation=(0, 0, 0)):
    """A square."""
    bpy.ops.mesh.primitive_plane_add(size=size, location=location, rotation=rotation)
    bpy.context.object.data.materials.append(material)


def build(thing, output):
    """A floor with a mirror, a block of glass, a pane and a plate, under a lamp."""
    scenes.empty_file()
    scene = bpy.context.scene
    scenes.plain_world((0.2, 0.2, 0.2))
    plane(scenes.of_one_shader("floor", "BsdfDiffuse", Color=(0.7, 0.7, 0.7, 1)), 6, (0, 0, 0))
    plane(scenes.of_one_shader("mirror", "BsdfAnisotropic", Roughness=0.3), 1.4, (-1.2, -0.6, 0.02))
    bpy.ops.mesh.primitive_cube_add(size=0.7, location=(0.1, -0.8, 0.4), rotation=(0.2, 0.1, 0.5))
    bpy.context.object.data.materials.append(scenes.of_one_shader("glass", "BsdfGlass", Roughness=0.0, IOR=1.3))
    plane(ruled("plate", output if thing == "plate" else ""), 1.6, (-0.6, 1.4, 0.9), (1.4, 0, 0.2))
    plane(ruled("pane", output if thing == "pane" else ""), 1.2, (1.3, 0.1, 0.9), (0.6, 0.1, 0))
    lamp = scenes.add(bpy.data.lights.new("lamp", "POINT"))
    lamp.data.energy, lamp.data.shadow_soft_size, lamp.location = 100, 0.0, (1.5, -0.8, 3.0)
    scene.camera = scenes.add(bpy.data.cameras.new("camera"))
    scene.camera.location, scene.camera.rotation_euler = (0.0, -5.0, 3.2), (1.02, 0, 0)
    scene.render.resolution_x = scene.render.resolution_y = SIZE
    scenes.write_layers()
    both_engines.set_alike(scene, max_bounces=6, diffuse_bounces=2, glossy_bounces=3, transmission_bounces=6)
    both_engines.sample_plainly(scene, SAMPLES)
    both_engines.without_blur(scene)
    both_engines.filter_by_box(scene)
    return scene


def compared_nodes():
    """By case: the node as it is compared."""
    scenes.empty_file()
    return {name: described_nodes(ruled(*case).node_tree, (KIND,)) for name, case in cases().items()}


if __name__ == "__main__":
    folder, found = Path(sys.argv[1]), {}
    for case_name, case in cases().items():
        shown = build(*case)
        pictures = {e: both_engines.picture(shown, e, folder / "picture.exr") for e in ("CYCLES", "RAYLEAF")}
        found[case_name] = {e: both_engines.means(each[..., :3], SIZE // 4) for e, each in pictures.items()}
    globals()["report"](found=found, nodes=compared_nodes())
