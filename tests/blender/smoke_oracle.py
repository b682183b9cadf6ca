"""Runs inside Blender: simulates smoke and fire, and renders them by Cycles and Rayleaf; reports means over parts of the picture."""

import os
import sys
from pathlib import Path

import both_engines
import bpy
import scenes
from oracle_case import described_nodes

SIZE, SAMPLES, FRAMES = 24, 384, 9
SMOKE = {"Density": 6.0, "Color": (0.9, 0.9, 0.9, 1), "Color Attribute": "color"}
FIRE = {"Density": 3.0, "Blackbody Intensity": 1.0, "Temperature": 1200.0, "Temperature Attribute": "flame"}
# By name: the Principled Volume, and what is set of the simulation.
CASES = {
    "smoke": (SMOKE, {}),
    "fire": (FIRE, {}),
    "fine smoke in a box that adapts": (SMOKE, {"use_adaptive_domain": True, "use_noise": True}),
}


def smoke_material(principled):
    """What fills the box."""
    material, tree, output = scenes.material("smoke")
    shader = tree.nodes.new("ShaderNodeVolumePrincipled")
    tree.links.new(shader.outputs[0], output.inputs["Volume"])
    for name, value in principled.items():
        shader.inputs[name].default_value = value
    return material


def simulate(folder, principled, settings):
    """A burning ball in a box."""
    bpy.ops.mesh.primitive_ico_sphere_add(radius=0.4, location=(0, 0, 0.5))
    ball = bpy.context.object
    ball.hide_render = True
    flow = ball.modifiers.new("flow", "FLUID")
    flow.fluid_type = "FLOW"
    flow.flow_settings.flow_type, flow.flow_settings.flow_behavior = "BOTH", "INFLOW"
    flow.flow_settings.smoke_color = (0.9, 0.4, 0.2)
    bpy.ops.mesh.primitive_cube_add(size=2, location=(0, 0, 1.1), rotation=(0, 0, 0.3))
    box = bpy.context.object
    box.name, box.scale = "box", (0.8, 0.8, 1.0)
    modifier = box.modifiers.new("domain", "FLUID")
    modifier.fluid_type = "DOMAIN"
    domain = modifier.domain_settings
    domain.domain_type, domain.resolution_max, domain.cache_type = "GAS", 20, "REPLAY"
    domain.cache_directory, domain.cache_frame_end = str(folder), FRAMES
    for name, value in settings.items():
        setattr(domain, name, value)
    box.data.materials.append(smoke_material(principled))
    for frame in range(1, FRAMES + 1):
        bpy.context.scene.frame_set(frame)


def build(folder, principled, settings):
    """Smoke over a floor under a lamp and a grey sky."""
    scenes.empty_file()
    scene = bpy.context.scene
    scenes.plain_world((0.2, 0.25, 0.3))
    bpy.ops.mesh.primitive_plane_add(size=8)
    material, tree, _ = scenes.material("floor")
    scenes.diffuse_alone(tree).inputs[0].default_value = (0.7, 0.7, 0.7, 1)
    bpy.context.object.data.materials.append(material)
    simulate(folder, principled, settings)
    point = scenes.add(bpy.data.lights.new("point", "POINT"))
    point.data.energy, point.data.shadow_soft_size, point.location = 150, 0.0, (1.5, -1.5, 3.0)
    scene.camera = scenes.add(bpy.data.cameras.new("camera"))
    scene.camera.location, scene.camera.rotation_euler = (0.0, -4.5, 2.4), (1.25, 0, 0)
    scene.render.resolution_x = scene.render.resolution_y = SIZE
    scenes.write_layers()
    both_engines.set_alike(scene, max_bounces=8, volume_bounces=1, diffuse_bounces=1)
    both_engines.sample_plainly(scene, SAMPLES)
    both_engines.without_blur(scene)
    both_engines.filter_by_box(scene)
    scene.cycles.volume_step_rate = 0.4
    return scene


def compared_nodes():
    """By case: the node as it is compared."""
    kinds = ("ShaderNodeVolumePrincipled",)
    return {name: described_nodes(smoke_material(inputs).node_tree, kinds) for name, (inputs, _) in CASES.items()}


if __name__ == "__main__":
    report = globals()["report"]  # given by the test
    os.chdir(sys.argv[1])  # simulations leave a file of noise wherever they run
    result = {}
    for number, (case_name, case) in enumerate(CASES.items()):
        cache = Path(sys.argv[1]) / f"cache{number}"
        cache.mkdir()
        built = build(cache, *case)
        pictures = {e: both_engines.picture(built, e, cache / "picture.exr") for e in ("CYCLES", "RAYLEAF")}
        result[case_name] = {e: both_engines.means(each[..., :3], SIZE // 3) for e, each in pictures.items()}
    report(result=result, nodes=compared_nodes())
