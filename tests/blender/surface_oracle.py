"""Runs inside Blender: Cycles and Rayleaf render the same balls, each with a node whose result shines, or a lit shader.

Emission and one sun without size are free of noise, so pixels are compared one by one. Both engines sample within a
hundredth of a pixel of its middle.
"""

import math
import sys
from pathlib import Path

import both_engines
import bpy
import numpy as np
import scenes
from oracle_case import described
from surface_oracle_cases import CASES

PIXELS, OFFSET = 48, 4.0
# Pixels that are compared: so far from a square's middle, of its side. The balls reach to 0.36 at least.
INSIDE = 0.27
DISPLACING = ("ShaderNodeDisplacement", "ShaderNodeVectorDisplacement")


def sources(tree):
    """What cases link to by name: coordinates, and a smooth height."""
    nodes, links = tree.nodes, tree.links
    place, separate, noise = (nodes.new(f"ShaderNode{kind}") for kind in ("TexCoord", "SeparateXYZ", "TexNoise"))
    links.new(place.outputs["Object"], separate.inputs[0])
    links.new(place.outputs["Object"], noise.inputs["Vector"])
    noise.inputs["Scale"].default_value, noise.inputs["Detail"].default_value = 0.6, 0.0
    tangent, bump = nodes.new("ShaderNodeTangent"), nodes.new("ShaderNodeBump")
    tangent.direction_type, tangent.axis = "RADIAL", "X"
    bump.inputs["Distance"].default_value = 0.4
    links.new(noise.outputs["Fac"], bump.inputs["Height"])
    found = {name: separate.outputs[i] for i, name in enumerate("xyz")}
    return found | {
        "object": place.outputs["Object"],
        "generated": place.outputs["Generated"],
        "uv": place.outputs["UV"],
        "height": noise.outputs["Fac"],
        "radial": tangent.outputs[0],
        "bumped": bump.outputs[0],
    }


def build_material(case):
    """A material of a case's node, values shine with an offset that keeps them positive; and the output that is compared."""
    material = bpy.data.materials.new(case.name[:60])
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    result = case.add(tree, sources(tree))
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    if case.node in DISPLACING:  # bump only, which is what a new material has
        tree.links.new(result, output.inputs["Displacement"])
        shader = tree.nodes.new("ShaderNodeBsdfDiffuse")
        tree.links.new(shader.outputs[0], output.inputs["Surface"])
        return material, result
    if result.type == "SHADER":
        tree.links.new(result, output.inputs["Surface"])
        return material, result
    shifted, emission = tree.nodes.new("ShaderNodeVectorMath"), tree.nodes.new("ShaderNodeEmission")
    tree.links.new(result, shifted.inputs[0])
    shifted.inputs[1].default_value = (OFFSET, OFFSET, OFFSET)
    tree.links.new(shifted.outputs[0], emission.inputs["Color"])
    tree.links.new(emission.outputs[0], output.inputs["Surface"])
    return material, result


def paint(mesh):
    """Two color attributes, of points and of corners; the first is the active one."""
    for name, domain, shift in (("Paint", "POINT", 0.0), ("Other paint", "CORNER", 1.0)):
        layer = mesh.color_attributes.new(name, "FLOAT_COLOR", domain)
        angle = np.arange(len(layer.data)) * (0.01 + 0.02 * shift) + shift
        values = np.stack([0.5 + 0.4 * np.sin(angle * k + shift) for k in (1, 2, 3, 4)], -1)
        layer.data.foreach_set("color", values.astype(np.float32).ravel())
    wear = mesh.attributes.new("Wear", "FLOAT_VECTOR", "EDGE")
    angle = np.arange(3 * len(wear.data)) * 0.07
    wear.data.foreach_set("vector", (0.5 + 0.4 * np.sin(angle)).astype(np.float32))
    mesh.color_attributes.active_color_index = mesh.color_attributes.render_color_index = 0


def ball(x, y, index, material, side):
    """An ellipsoid at the middle of a square, turned, mirrored where `side` is -1; smooth, with two UV maps and a colour of
    its own."""
    bpy.ops.mesh.primitive_uv_sphere_add(segments=24, ring_count=12, radius=1, location=(x, y, 0.1))
    item = bpy.context.object
    item.name = f"Ball {index:04}"
    item.rotation_euler, item.scale = (0.4, 0.3, 0.9), (0.42 * side, 0.36, 0.45)
    bpy.ops.object.shade_smooth()
    item.color, item.pass_index = (0.2, 0.5, 0.7, 0.4), 3
    item["weight"], item["tint"] = 0.625, (0.25, 0.5, 0.75)
    other = item.data.uv_layers.new(name="Other")
    first = item.data.uv_layers[0]
    for target, source in zip(other.data, first.data):
        target.uv = (source.uv[1] * 2 - source.uv[0] * 0.3, source.uv[0])
    paint(item.data)
    item.data.materials.append(material)


def set_up(columns, rows):
    """An orthographic camera over unit squares, a sun, the same settings for both engines."""
    scenes.empty_file()
    scene = bpy.context.scene
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.data.type, camera.data.ortho_scale = "ORTHO", max(columns, rows)
    camera.data.clip_start = 1e-3  # Cycles measures rays from there
    camera.location = (columns / 2, rows / 2, 5)
    scene.collection.objects.link(camera)
    scene.camera = camera
    sun = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
    sun.data.angle, sun.data.energy, sun.rotation_euler = 0.0, 3.0, (0.4, 0.3, 0.0)
    scene.collection.objects.link(sun)
    scene.render.film_transparent = True
    both_engines.sample_plainly(scene, 1)
    both_engines.filter_by_box(scene)
    both_engines.set_alike(scene, max_bounces=0, filter_width=0.01)
    scene.render.resolution_x, scene.render.resolution_y = columns * PIXELS, rows * PIXELS
    scenes.write_layers()
    return scene


def make_image():
    """A small smooth picture."""
    image = bpy.data.images.new("Picture", 8, 8, alpha=False)
    image.colorspace_settings.name = "Non-Color"
    y, x = np.mgrid[:8, :8] / 8 * 2 * math.pi
    values = np.stack([0.5 + 0.4 * np.sin(x), 0.5 + 0.4 * np.cos(y), 0.5 + 0.3 * np.sin(x + y), 0 * x + 1], -1)
    image.pixels.foreach_set(values.astype(np.float32).ravel())
    image.update()


def compared_nodes():
    """By case: the node as it is compared."""
    set_up(1, 1)
    make_image()
    return {case.name: [described(build_material(case)[1])] for case in CASES}


def compare(folder, side):
    """Render both; the differences by case."""
    columns = math.ceil(math.sqrt(len(CASES)))
    rows = math.ceil(len(CASES) / columns)
    scene = set_up(columns, rows)
    make_image()
    for i, case in enumerate(CASES):
        ball(i % columns + 0.5, i // columns + 0.5, i, build_material(case)[0], side)
    # What shines would light the rest, by chance.
    pictures = {engine: 0.0 for engine in ("CYCLES", "RAYLEAF")}
    for lit in (False, True):
        for case, item in zip(CASES, sorted(b.name for b in bpy.data.objects if b.name.startswith("Ball"))):
            is_shader = case.node.startswith("ShaderNodeBsdf") or case.node in DISPLACING
            bpy.data.objects[item].hide_render = is_shader != lit
        for engine in pictures:
            pictures[engine] = pictures[engine] + both_engines.picture(scene, engine, folder / f"{engine}.exr")
    # Negative light is Cycles' alone.
    cycles, rayleaf = np.maximum(pictures["CYCLES"], 0.0), pictures["RAYLEAF"]
    y, x = (np.mgrid[:PIXELS, :PIXELS] + 0.5) / PIXELS - 0.5
    inside = x * x + y * y < INSIDE * INSIDE
    differences, ranges = {}, {}
    for i, case in enumerate(CASES):
        row = i // columns
        part = np.s_[row * PIXELS : (row + 1) * PIXELS, (i % columns) * PIXELS : (i % columns + 1) * PIXELS]
        expected, found = cycles[part][inside], rayleaf[part][inside]
        difference = np.abs(found - expected) / np.maximum(1.0, np.abs(expected))
        differences[case.name] = np.sort(difference.max(axis=1)).tolist()
        ranges[case.name] = [float(expected[:, :3].min()), float(expected[:, :3].max())]
    return {"differences": differences, "ranges": ranges}


if __name__ == "__main__":
    report = globals()["report"]  # given by the test
    report(plain=compare(Path(sys.argv[1]), 1), mirrored=compare(Path(sys.argv[1]), -1), nodes=compared_nodes())
