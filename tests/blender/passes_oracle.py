"""Runs inside Blender: Cycles and Rayleaf render the same file with passes that are listed by name, mist, volumes and
denoisers' guides; what they give is left in two EXR files."""

import sys
from pathlib import Path

import bpy
import scenes
from rayleaf.versions import choose_file_format

report = globals()["report"]  # given by the test
SIZE, SAMPLES = 32, 512


def shine(owner, color, strength):
    """An emission as nodes of a material."""
    owner.use_nodes = True
    tree = owner.node_tree
    tree.nodes.clear()
    output, emission = tree.nodes.new("ShaderNodeOutputMaterial"), tree.nodes.new("ShaderNodeEmission")
    emission.inputs["Color"].default_value, emission.inputs["Strength"].default_value = color, strength
    tree.links.new(emission.outputs[0], output.inputs["Surface"])


def painted(name, kind, **inputs):
    """A material of one shader that also writes to both AOVs."""
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    output, shader = tree.nodes.new("ShaderNodeOutputMaterial"), tree.nodes.new(f"ShaderNode{kind}")
    for socket, value in inputs.items():
        shader.inputs[socket].default_value = value
    tree.links.new(shader.outputs[0], output.inputs["Surface"])
    place = tree.nodes.new("ShaderNodeNewGeometry")
    for aov, socket, source in (("Where", "Color", "Position"), ("Facing", "Value", "Backfacing")):
        node = tree.nodes.new("ShaderNodeOutputAOV")
        scenes.set_aov(node, aov)
        tree.links.new(place.outputs[source], node.inputs[socket])
    return material


def add(kind, name, material, **arguments):
    """A primitive of Blender's."""
    getattr(bpy.ops.mesh, f"primitive_{kind}_add")(**arguments)
    item = bpy.context.object
    item.name = name
    item.data.materials.append(material)
    return item


def build():
    """Bodies of several materials on a floor, one of them a child; lights in groups, and mist before a grey sky."""
    scenes.empty_file()
    scene = bpy.context.scene
    add("plane", "Floor", painted("matte", "BsdfDiffuse", Color=(0.7, 0.6, 0.5, 1)), size=12)
    add(
        "cube",
        'Ünder "quotes"',
        painted("red", "BsdfDiffuse", Color=(0.8, 0.2, 0.1, 1)),
        size=1.2,
        location=(-1, 0, 0.6),
    )
    pane = painted("pane", "BsdfTransparent", Color=(0.5, 0.5, 0.5, 1))
    add("plane", "Pane", pane, size=1.4, location=(0.9, -1.2, 0.7), rotation=(1.4, 0, 0))
    ball = add(
        "uv_sphere",
        "Ball",
        painted("blue", "BsdfDiffuse", Color=(0.1, 0.3, 0.8, 1)),
        radius=0.6,
        location=(1, 0.5, 0.6),
    )
    ball.parent = bpy.data.objects["Floor"]
    glow = add("cube", "Glow", bpy.data.materials.new("glow"), size=0.3, location=(0, -1, 1.6))
    shine(glow.active_material, (1, 0.5, 0.2, 1), 12.0)
    glow.lightgroup = "warm"
    lamp = scenes.add(bpy.data.lights.new("lamp", "POINT"))
    lamp.data.energy, lamp.data.shadow_soft_size, lamp.location, lamp.lightgroup = 200, 0.0, (2, -2, 3.5), "cold"
    world = scene.world = bpy.data.worlds.new("grey")
    world.use_nodes = True
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.2, 0.25, 0.3, 1)
    world.mist_settings.start, world.mist_settings.depth, world.mist_settings.falloff = 4.0, 6.0, "LINEAR"
    fog = add("cube", "Fog", bpy.data.materials.new("fog"), size=3.5, location=(0, 0, 1.76))
    tree = fog.active_material
    tree.use_nodes = True
    tree = tree.node_tree
    tree.nodes.clear()
    output, scatter = tree.nodes.new("ShaderNodeOutputMaterial"), tree.nodes.new("ShaderNodeVolumeScatter")
    scatter.inputs["Density"].default_value = 0.08
    tree.links.new(scatter.outputs[0], output.inputs["Volume"])
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.location, camera.rotation_euler = (0.0, -6.5, 2.6), (1.25, 0, 0)
    scene.collection.objects.link(camera)
    scene.camera = camera
    scene.render.resolution_x = scene.render.resolution_y = SIZE
    scenes.write_layers()
    return scene


def ask(layer):
    """For the passes that are compared."""
    layer.use_pass_mist = layer.use_pass_cryptomatte_object = True
    layer.use_pass_cryptomatte_material = layer.use_pass_cryptomatte_asset = True
    layer.pass_cryptomatte_depth = 6
    layer.cycles.use_pass_volume_direct = layer.cycles.use_pass_volume_indirect = True
    layer.cycles.denoising_store_passes = True
    for name, kind in (("Where", "COLOR"), ("Facing", "VALUE")):
        output = layer.aovs.add()
        output.name, output.type = name, kind
    for name in ("warm", "cold"):
        layer.lightgroups.add(name=name)


def set_up(scene):
    """The same for both engines."""
    for own in (scene.cycles, scene.rayleaf):
        own.samples, own.max_bounces, own.diffuse_bounces, own.volume_bounces = SAMPLES, 6, 3, 2
    scene.cycles.use_adaptive_sampling = scene.cycles.use_denoising = False
    scene.cycles.sample_clamp_indirect = scene.rayleaf.clamp_indirect = 0.0
    scene.cycles.blur_glossy = 0.0
    scene.cycles.pixel_filter_type = scene.rayleaf.filter_type = "BOX"
    scene.rayleaf.filter_width = 1.0


if __name__ == "__main__":
    folder = Path(sys.argv[1])
    made = build()
    ask(bpy.context.view_layer)
    set_up(made)
    for engine in ("CYCLES", "RAYLEAF"):
        made.render.engine, made.render.filepath = engine, str(folder / f"{engine}.exr")
        bpy.ops.render.render(write_still=True)
    tree = scenes.compositor(made)
    matte = tree.nodes.new("CompositorNodeCryptomatteV2")
    matte.scene, matte.layer_name, matte.matte_id = made, "ViewLayer.CryptoObject", "Ball"
    out = scenes.compositor_output(tree)
    tree.links.new(matte.outputs["Matte"], out.inputs[0])
    made.render.filepath = str(folder / "matte.exr")
    choose_file_format(made.render.image_settings, "OPEN_EXR")
    made.render.image_settings.color_depth, made.render.image_settings.exr_codec = "32", "NONE"  # 5.2 forgets them
    bpy.ops.render.render(write_still=True)
    report(version=bpy.app.version)
