"""Renders one scene by Cycles and by Rayleaf under several limits; reports every pass's mean over 2 x 2 parts."""

import sys
from pathlib import Path

import both_engines
import bpy
import scenes

SIZE, SAMPLES = 24, 1024
# Direct; one bounce; unlimited; each kind of bounce alone cut off.
VARIANTS = {
    "direct": dict(max_bounces=0),
    "one bounce": dict(max_bounces=1),
    "no limit": dict(),
    "no diffuse bounce": dict(diffuse_bounces=0),
    "no glossy bounce": dict(glossy_bounces=0),
    "one transmission": dict(transmission_bounces=1),
    "no transparent surface": dict(transparent_bounces=0),
    "one transparent surface": dict(transparent_bounces=1),
    "clear film": dict(film_transparent=True),
}
if bpy.app.version >= (5, 0, 0):
    # Cycles now counts a surface of the path before it is passed, and those of shadows after: 1 means 0 to a path, 1 to a
    # shadow. Ours means the same in all versions.
    del VARIANTS["one transparent surface"]


def material(name, kind, color, **inputs):
    """A material of one shader node."""
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    tree = made.node_tree
    tree.nodes.clear()
    shader, output = tree.nodes.new(kind), tree.nodes.new("ShaderNodeOutputMaterial")
    shader.inputs["Color"].default_value = (*color, 1)
    for key, value in inputs.items():
        shader.inputs[key].default_value = value
    if kind == "ShaderNodeBsdfGlossy":
        shader.distribution = "GGX"
    tree.links.new(shader.outputs[0], output.inputs[0])
    return made


def quad(name, corners, surface):
    """A quadrilateral object."""
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(corners, [], [(0, 1, 2, 3)])
    mesh.materials.append(surface)
    bpy.context.scene.collection.objects.link(bpy.data.objects.new(name, mesh))


def build():
    """A corner of diffuse walls with a glossy plate, a glass block, two tinted panes, a glowing strip and a lamp."""
    scenes.empty_file()
    scene = bpy.context.scene
    scene.world = bpy.data.worlds.new("grey")
    scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs[0].default_value = (0.2, 0.25, 0.3, 1)
    white, red = material("white", "ShaderNodeBsdfDiffuse", (0.8,) * 3), material(
        "red", "ShaderNodeBsdfDiffuse", (0.8, 0.2, 0.1)
    )
    quad("floor", [(-2, -2, 0), (2, -2, 0), (2, 2, 0), (-2, 2, 0)], white)
    quad("wall", [(-2, 2, 0), (2, 2, 0), (2, 2, 3), (-2, 2, 3)], red)
    plate = material("plate", "ShaderNodeBsdfGlossy", (0.9, 0.8, 0.5), Roughness=0.3)
    quad("plate", [(-1.8, -1.5, 0.05), (-0.2, -1.5, 0.05), (-0.2, 0, 0.4), (-1.8, 0, 0.4)], plate)
    tint = material("tint", "ShaderNodeBsdfTransparent", (0.9, 0.6, 0.3))
    for height in (1.0, 1.2):
        quad("pane", [(0.2, -1, height), (1.8, -1, height), (1.8, 1, height), (0.2, 1, height)], tint)
    glow = material("glow", "ShaderNodeEmission", (0.3, 0.6, 1.0), Strength=3.0)
    quad("glow", [(-1.5, 1.9, 0.5), (-0.5, 1.9, 0.5), (-0.5, 1.9, 1.0), (-1.5, 1.9, 1.0)], glow)
    bpy.ops.mesh.primitive_cube_add(size=0.8, location=(-0.6, 0.9, 0.6), rotation=(0.3, 0.2, 0.5))
    bpy.context.object.data.materials.append(
        material("glass", "ShaderNodeBsdfGlass", (1, 1, 1), Roughness=0.0, IOR=1.45)
    )
    lamp = bpy.data.objects.new("lamp", bpy.data.lights.new("lamp", "AREA"))
    lamp.data.energy, lamp.data.size, lamp.location, lamp.rotation_euler = 60, 1.0, (0.5, -0.5, 3), (0.1, 0.2, 0)
    scene.collection.objects.link(lamp)
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.location, camera.rotation_euler = (0.3, -6, 3.2), (1.15, 0, 0)
    scene.collection.objects.link(camera)
    scene.camera = camera
    scene.render.resolution_x = scene.render.resolution_y = SIZE
    scenes.write_layers()
    layer = scene.view_layers[0]
    for kind in ("diffuse", "glossy", "transmission"):
        for part in ("direct", "indirect", "color"):
            setattr(layer, f"use_pass_{kind}_{part}", True)
    layer.use_pass_emit = layer.use_pass_environment = True
    return scene


def set_limits(scene, values):
    """The same limits for both engines."""
    names = ("diffuse_bounces", "glossy_bounces", "transmission_bounces", "max_bounces")
    limits = {**dict.fromkeys(names, 64), "transparent_bounces": 64, **values}
    scene.render.film_transparent = limits.pop("film_transparent", False)
    scene.cycles.transparent_max_bounces = scene.rayleaf.transparent_bounces = limits.pop("transparent_bounces")
    both_engines.set_alike(scene, **limits)
    both_engines.sample_plainly(scene, SAMPLES)
    both_engines.without_blur(scene)
    both_engines.filter_by_box(scene)


def light_by_pass(scene, engine, path):
    """Light by pass, colours multiplied back in."""
    channels = both_engines.channels(scene, engine, path)

    def color(name):
        return both_engines.color(channels, name)

    light = {name: color(name) for name in ("Combined", "Emit", "Env")}
    light["Alpha"] = both_engines.color(channels, letters="A")
    for kind in ("Diff", "Gloss", "Trans"):
        for part in ("Dir", "Ind"):
            light[kind + part] = color(kind + part) * color(kind + "Col")
    return {name: both_engines.means(picture, SIZE // 2) for name, picture in light.items()}


if __name__ == "__main__":
    build_scene, folder = build(), Path(sys.argv[1])
    result = {}
    for variant, limits in VARIANTS.items():
        set_limits(build_scene, limits)
        result[variant] = {e: light_by_pass(build_scene, e, folder / f"{e}.exr") for e in ("CYCLES", "RAYLEAF")}
    report(result=result)  # noqa: F821: the runner's
