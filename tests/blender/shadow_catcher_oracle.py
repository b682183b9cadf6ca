"""Runs inside Blender: Cycles and Rayleaf render shadow catchers with transparent and opaque film, in the picture and as a
pass of its own; what they give is left in EXR files."""

import sys
from pathlib import Path

import bpy
import both_engines
import scenes

report = globals()["report"]  # given by the test
SIZE, SAMPLES = 48, 2048
# By name: whether the film is transparent, whether the shadow is a pass of its own.
CASES = {"alpha": (True, False), "pass": (True, True), "opaque": (False, False), "opaque_pass": (False, True)}


def matte(name, color):
    """A diffuse material."""
    material, tree, _ = scenes.material(name)
    scenes.diffuse_alone(tree).inputs[0].default_value = (*color, 1)
    return material


def glowing(name, color, strength):
    """A material that shines and does nothing else."""
    material, tree, output = scenes.material(name)
    emission = tree.nodes.new("ShaderNodeEmission")
    emission.inputs["Color"].default_value, emission.inputs["Strength"].default_value = (*color, 1), strength
    tree.links.new(emission.outputs[0], output.inputs["Surface"])
    return material


def add(kind, material, **arguments):
    """A primitive of Blender's."""
    getattr(bpy.ops.mesh, f"primitive_{kind}_add")(**arguments)
    item = bpy.context.object
    item.data.materials.append(material)
    return item


def build():
    """A floor and a post of the footage; bodies that throw shadows on them, colour them and shine on them."""
    scenes.empty_file()
    scene = bpy.context.scene
    scenes.plain_world((0.2, 0.3, 0.4))
    floor = add("plane", matte("floor", (0.7, 0.6, 0.5)), size=5)
    post = add("cube", matte("post", (0.3, 0.6, 0.3)), size=0.6, location=(-1.2, 1.2, 0.3))
    floor.is_shadow_catcher = post.is_shadow_catcher = True
    add("uv_sphere", matte("ball", (0.9, 0.2, 0.1)), radius=0.7, location=(0.3, 0.2, 0.7))
    add("cube", glowing("glow", (0.2, 0.4, 1.0), 6.0), size=0.4, location=(1.4, -0.6, 0.4))
    sun = scenes.add(bpy.data.lights.new("sun", "SUN"))
    sun.data.energy, sun.data.angle, sun.rotation_euler = 3.0, 0.1, (0.6, 0.5, 0)
    added = scenes.add(bpy.data.lights.new("added", "POINT"))  # lights the floor with the added objects alone
    added.data.energy, added.data.shadow_soft_size, added.location = 40.0, 0.2, (-1.6, -1.2, 1.0)
    found = sun.is_shadow_catcher
    sun.is_shadow_catcher, added.is_shadow_catcher = True, False
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.location, camera.rotation_euler = (0.0, -6.0, 4.5), (0.93, 0, 0)
    scene.collection.objects.link(camera)
    scene.camera = camera
    scene.render.resolution_x = scene.render.resolution_y = SIZE
    scenes.write_layers()
    return scene, found


if __name__ == "__main__":
    folder = Path(sys.argv[1])
    made, lamps_are_in_footage = build()
    both_engines.sample_plainly(made, SAMPLES)
    both_engines.without_blur(made)
    both_engines.filter_by_box(made)
    both_engines.set_alike(made, max_bounces=4, diffuse_bounces=4)
    for case, (transparent, own_pass) in CASES.items():
        made.render.film_transparent = transparent
        bpy.context.view_layer.cycles.use_pass_shadow_catcher = own_pass
        for engine in ("CYCLES", "RAYLEAF"):
            both_engines.channels(made, engine, folder / f"{case}_{engine}.exr")
    report(version=bpy.app.version, lamps_are_in_footage=lamps_are_in_footage)
