"""Runs inside Blender: a floor in the shadow of a translucent wall that the sun shines on, in both engines and integrators."""

import math
import sys
from pathlib import Path

import both_engines
import bpy
import scenes
from spread_oracle_cases import FIXED


def shaded(item, node, **inputs):
    """Gives an object a material of one node."""
    material, tree, output = scenes.material(item.name)
    shader = tree.nodes.new(node)
    for name, value in inputs.items():
        shader.inputs[name].default_value = value
    tree.links.new(shader.outputs[0], output.inputs["Surface"])
    item.data.materials.append(material)
    return shader


def build():
    """The camera sees the floor alone."""
    scenes.empty_file()
    scene = bpy.context.scene
    bpy.ops.mesh.primitive_plane_add(size=4, location=(2.05, 0, 0))
    shaded(bpy.context.object, "ShaderNodeBsdfDiffuse", Color=(0.8, 0.8, 0.8, 1))
    bpy.ops.mesh.primitive_cube_add(size=2, location=(-0.1, 0, 1), scale=(0.1, 4, 2))
    color = {"Color": (0.8, 0.5, 0.3, 1), "Radius": (1, 1, 1), "Scale": 2.0}
    shaded(bpy.context.object, "ShaderNodeSubsurfaceScattering", **color).falloff = FIXED
    sun = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
    sun.data.energy, sun.rotation_euler = 3.0, (0, -math.radians(70), 0)
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.data.angle, camera.location = 0.1, (0.8, 0, 3)
    for each in (sun, camera):
        scene.collection.objects.link(each)
    scene.camera = camera
    both_engines.sample_plainly(scene, 256)
    scene.render.resolution_x = scene.render.resolution_y = 16
    scenes.write_layers()
    return scene


if __name__ == "__main__":
    report = globals()["report"]  # given by the test
    folder, scene, found = Path(sys.argv[1]), build(), {}
    for name, integrator in (("CYCLES", "PATH"), ("RAYLEAF", "PATH"), ("RAYLEAF", "DISTRIBUTION")):
        scene.rayleaf.integrator = integrator
        picture = both_engines.picture(scene, name, folder / "picture.exr")[..., :3]
        found[f"{name} {integrator}"] = picture.mean(axis=(0, 1)).tolist()
    report(found=found, version=bpy.app.version)
