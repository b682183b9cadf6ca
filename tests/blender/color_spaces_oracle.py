"""Runs inside Blender: an image of every colour space that the configuration has, of bytes and of floats, in both engines."""

import sys
from pathlib import Path

import both_engines
import bpy
import numpy as np
import scenes

SIDE = 12
KINDS = {"bytes": ("PNG", "8"), "floats": ("OPEN_EXR", "32"), "with alpha": ("PNG", "8"), "packed": ("PNG", "8")}


def image_file(kind, folder):
    """Its numbers are in the file as they are here."""
    path = folder / f"{kind}.{'png' if KINDS[kind][0] == 'PNG' else 'exr'}"
    made = bpy.data.images.new(kind, SIDE, SIDE, alpha=True, float_buffer=kind == "floats", is_data=True)
    numbers = np.random.default_rng(2).uniform(0.05, 0.95, (SIDE, SIDE, 4)).astype(np.float32)
    if kind != "with alpha":
        numbers[..., 3] = 1.0
    made.pixels.foreach_set(numbers.ravel())
    made.filepath_raw, made.file_format = str(path), KINDS[kind][0]
    made.save()
    return path


def build(kind, space, folder):
    """A plane that fills the view and shines in the image's colours."""
    scenes.empty_file()
    scene = bpy.context.scene
    scenes.plain_world((0, 0, 0))
    image = bpy.data.images.load(str(image_file(kind, folder)))
    image.colorspace_settings.name = space
    if kind == "packed":
        image.pack()
    bpy.ops.mesh.primitive_plane_add(size=2)
    material, tree, output = scenes.material("shining")
    tree.nodes.clear()
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    emission, texture = tree.nodes.new("ShaderNodeEmission"), tree.nodes.new("ShaderNodeTexImage")
    texture.image, texture.interpolation = image, "Closest"
    tree.links.new(texture.outputs["Color"], emission.inputs["Color"])
    tree.links.new(emission.outputs[0], output.inputs["Surface"])
    bpy.context.object.data.materials.append(material)
    camera = bpy.data.cameras.new("camera")
    camera.type, camera.ortho_scale = "ORTHO", 2.0
    scene.camera = scenes.add(camera)
    scene.camera.location = (0, 0, 3)
    scene.render.resolution_x = scene.render.resolution_y = SIDE
    scenes.write_layers()
    both_engines.sample_plainly(scene, 1)
    both_engines.filter_by_box(scene, 0.1)
    return scene


def spaces():
    """By name, as an image may be set to them."""
    listed = bpy.types.ColorManagedInputColorspaceSettings.bl_rna.properties["name"].enum_items
    return [item.identifier for item in listed]


if __name__ == "__main__":
    report = globals()["report"]  # given by the test
    folder, found = Path(sys.argv[1]), {}
    for kind in KINDS:
        for space in spaces() if kind in ("bytes", "floats") else ("sRGB", "XYZ", "Filmic Log"):
            if space not in spaces():
                continue
            scene = build(kind, space, folder)
            pictures = [both_engines.picture(scene, e, folder / "picture.exr")[..., :3] for e in ("CYCLES", "RAYLEAF")]
            found[f"{kind}, {space}"] = [picture.ravel().tolist() for picture in pictures]
    report(found=found)
