"""The scene of every oddity of the export: a square that fills the picture. Inside Blender."""

import addon_utils
import both_engines
import bpy
import numpy as np
import scenes

SIZE, SAMPLES = 16, 64
CASES = {}


def case(function):
    """Keeps a scene: a function of the material's tree and its emission shader, on a square that fills the picture."""
    CASES[function.__name__.replace("_", " ")] = function
    return function


def build():
    """The square, its material's tree and the shader that shines."""
    scene = scenes.empty_scene()
    addon_utils.enable("cycles")
    scene.camera.location, scene.camera.data.type, scene.camera.data.ortho_scale = (0, 0, 5), "ORTHO", 2
    scenes.plain_world((0.2, 0.2, 0.2))
    item = square("Square", 1)
    tree, shader = shine(item)
    both_engines.show_direct_light(scene, SIZE, SAMPLES)
    both_engines.set_alike(scene, max_bounces=1)
    return scene, item, tree, shader


def square(name, half):
    """In the middle of the picture, with a UV map of 0 to 2."""
    item = scenes.mesh([(-half, -half, 0), (half, -half, 0), (half, half, 0), (-half, half, 0)], [(0, 1, 2, 3)], name)
    layer = item.data.uv_layers.new(name="UVMap")
    layer.data.foreach_set("uv", [0, 0, 2, 0, 2, 2, 0, 2])
    return item


def shine(item, color=(1, 1, 1)):
    """The tree of a new material that shines, and its shader."""
    material, tree, output = scenes.material(f"of {item.name}")
    shader = tree.nodes.new("ShaderNodeEmission")
    shader.inputs["Color"].default_value = (*color, 1)
    tree.links.new(shader.outputs[0], output.inputs["Surface"])
    item.data.materials.append(material)
    return tree, shader


def lay_floor(item):
    """A white matte material in place of one that shines."""
    material, tree, _ = scenes.material("Floor")
    item.data.materials[0] = material
    return scenes.diffuse_alone(tree)


def save_picture(path, color):
    """A file of one colour."""
    image = bpy.data.images.new("Made", 4, 4)
    image.pixels.foreach_set(np.tile([*color, 1], 16).astype(np.float32))
    image.filepath_raw, image.file_format = str(path), "PNG"
    image.save()
    bpy.data.images.remove(image)


def link_image(tree, shader, image):
    """Shows an image."""
    node = tree.nodes.new("ShaderNodeTexImage")
    node.image, node.interpolation = image, "Closest"
    tree.links.new(node.outputs["Color"], shader.inputs["Color"])
    return node
