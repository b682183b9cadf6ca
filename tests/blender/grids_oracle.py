"""Runs inside Blender: Cycles and Rayleaf render a cloud of grids on a floor; reports means over parts of the picture."""

import sys
from pathlib import Path

import both_engines
import bpy
import scenes
from oracle_case import described_nodes
from grids_oracle_cases import CASES

SIZE, SAMPLES = 24, 128


def textures(tree):
    """Nodes by the names that cases give them."""
    made = {}
    for name, kind in (("AttributeDensity", "Attribute"), ("AttributeColor", "Attribute"), ("Info", "VolumeInfo")):
        made[name] = tree.nodes.new(f"ShaderNode{kind}")
    made["AttributeDensity"].attribute_name, made["AttributeColor"].attribute_name = "density", "color"
    ramp = made["Ramp"] = tree.nodes.new("ShaderNodeValToRGB")
    tree.links.new(made["Info"].outputs["Density"], ramp.inputs["Fac"])
    ramp.color_ramp.elements[0].position, ramp.color_ramp.elements[1].position = 0.2, 0.5
    ramp.color_ramp.elements[1].color = (3.0, 3.0, 3.0, 1.0)
    return made


def cloud_material(case):
    """What fills the cloud."""
    material = bpy.data.materials.new("cloud")
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    output, shader = tree.nodes.new("ShaderNodeOutputMaterial"), tree.nodes.new(f"ShaderNode{case.shader}")
    tree.links.new(shader.outputs[0], output.inputs["Surface" if case.shader == "None" else "Volume"])
    named = textures(tree)
    for name, value in case.inputs.items():
        if isinstance(value, tuple) and isinstance(value[0], str):
            tree.links.new(named[value[0]].outputs[value[1]], shader.inputs[name])
        else:
            shader.inputs[name].default_value = value
    return material


def cloud_object(case, folder):
    """A Volume object, of a file or of a modifier."""
    volume = bpy.data.volumes.new("cloud")
    cloud = scenes.add(volume, "cloud")
    if case.made:
        bpy.ops.mesh.primitive_ico_sphere_add(radius=0.8, subdivisions=4, location=(0.2, 0, 1.1))
        ball = bpy.context.object
        ball.hide_render = True
        modifier = cloud.modifiers.new("made", "MESH_TO_VOLUME")
        modifier.object, modifier.voxel_amount, modifier.density = ball, 24, 0.7
    elif case.frame > 1:
        volume.filepath, volume.is_sequence = str(folder / "cloud_0001.vdb"), True
        volume.frame_start, volume.frame_duration = 1, 2
    else:
        volume.filepath = str(folder / "cloud_0001.vdb")
    volume.render.space = case.space
    cloud.location = (0, 0, 0) if case.made else (0.1, 0.0, 1.1)
    cloud.rotation_euler, cloud.scale = (0.2, 0.1, 0.4), (case.scale,) * 3
    if case.material:
        volume.materials.append(cloud_material(case))
    return cloud


def build(case, folder):
    """A cloud over a floor under a lamp and a grey sky."""
    scenes.empty_file()
    scene = bpy.context.scene
    scenes.plain_world((0.2, 0.25, 0.3))
    bpy.ops.mesh.primitive_plane_add(size=8)
    material, tree, _ = scenes.material("floor")
    scenes.diffuse_alone(tree).inputs[0].default_value = (0.7, 0.7, 0.7, 1)
    bpy.context.object.data.materials.append(material)
    cloud_object(case, folder)
    point = scenes.add(bpy.data.lights.new("point", "POINT"))
    point.data.energy, point.data.shadow_soft_size, point.location = 150, 0.0, (1.5, -1.5, 3.0)
    camera = scenes.add(bpy.data.cameras.new("camera"))
    camera.location, camera.rotation_euler = (0.0, -4.5, 2.4), (1.25, 0, 0)
    if case.camera_inside:  # nothing is seen nearer than where clipping ends, the cloud neither
        camera.data.clip_start = case.clip_start
        camera.location, camera.rotation_euler = (0.1, 0.0, 1.0), (1.1, 0, 0.3)
    scene.camera = camera
    scene.frame_set(case.frame)
    scene.render.resolution_x = scene.render.resolution_y = SIZE
    scenes.write_layers()
    both_engines.set_alike(scene, **{"max_bounces": 8, "volume_bounces": 0, "diffuse_bounces": 1, **case.settings})
    both_engines.sample_plainly(scene, SAMPLES)
    both_engines.without_blur(scene)
    both_engines.filter_by_box(scene)
    scene.cycles.volume_step_rate = 0.4
    return scene


# What clouds are made of and read.
_KINDS = ("VolumeAbsorption", "VolumeScatter", "VolumePrincipled", "VolumeInfo", "Attribute", "ValToRGB", "Emission")


def compared_nodes():
    """By case: the nodes of the cloud as they are compared."""
    scenes.empty_file()
    kinds = [f"ShaderNode{kind}" for kind in _KINDS]
    with_material = {name: case for name, case in CASES.items() if case.material}
    return {name: described_nodes(cloud_material(case).node_tree, kinds) for name, case in with_material.items()}


if __name__ == "__main__":
    report = globals()["report"]  # given by the test
    files, results, result = Path(sys.argv[1]), Path(sys.argv[2]), {}
    for case_name in sys.argv[3:] or list(CASES):
        built = build(CASES[case_name], files)
        pictures = {e: both_engines.picture(built, e, results / "picture.exr") for e in ("CYCLES", "RAYLEAF")}
        result[case_name] = {e: both_engines.means(each[..., :3], SIZE // 3) for e, each in pictures.items()}
    report(result=result, nodes=compared_nodes())
