"""Runs inside Blender: Cycles and Rayleaf render the same bodies that light goes through, or the same tufts of hair, each
with a material of its own; reports each one's mean colour, converged, and what the noise of both leaves open.

Subsurface and shaders: bodies of flat faces, so that both have the same geometry. Hair: straight strands of even width, thick enough
to see.
"""

import math
import sys
from pathlib import Path

import both_engines
import bpy
import numpy as np
import scenes
from oracle_case import described
from spread_oracle_cases import hair_cases, shader_cases, subsurface_cases

PIXELS = 12
SAMPLES = {"subsurface": 256, "hair": 256, "shaders": 1024}


def sources(tree):
    """What cases link to by name: a normal that leans to a side, and a direction across strands."""
    geometry, lean, unit, across = (
        tree.nodes.new(f"ShaderNode{kind}") for kind in ("NewGeometry", "VectorMath", "VectorMath", "CombineXYZ")
    )
    lean.inputs[1].default_value, unit.operation = (0.5, 0.2, 0.0), "NORMALIZE"
    tree.links.new(geometry.outputs["Normal"], lean.inputs[0])
    tree.links.new(lean.outputs[0], unit.inputs[0])
    for value, each in zip((0.6, 0.3, 0.7), across.inputs):
        each.default_value = value
    return {"leaning": unit.outputs[0], "across": across.outputs[0]}


def build_material(case):
    """A material of a case's node, a value shines; and the output that is compared."""
    material, tree, output = scenes.material(case.name[:60])
    result = shown = case.add(tree, sources(tree))
    if result.type != "SHADER":
        emission, shift = tree.nodes.new("ShaderNodeEmission"), tree.nodes.new("ShaderNodeVectorMath")
        shift.inputs[1].default_value = (1.0, 1.0, 1.0)
        tree.links.new(result, shift.inputs[0])
        tree.links.new(shift.outputs[0], emission.inputs["Color"])
        shown = emission.outputs[0]
    tree.links.new(shown, output.inputs["Surface"])
    return material, result


def body(x, y, material):
    """A cut stone."""
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=2, radius=0.4, location=(x, y, 0), rotation=(0.3, 0.2, 0.1))
    bpy.context.object.data.materials.append(material)


def tuft(x, y, material):
    """Strands that stand on a square: its corners lie behind them."""
    half = 0.25
    corners = [
        (x - half, y - 0.4, -half),
        (x + half, y - 0.4, -half),
        (x + half, y - 0.4, half),
        (x - half, y - 0.4, half),
    ]
    skin = scenes.mesh(corners, [(0, 3, 2, 1)], "Skin")
    skin.data.materials.append(material)
    scenes.grow_strands(skin, 0.8, 0.05)
    skin.show_instancer_for_render = False


def set_up(columns, rows, samples, distribution):
    """An orthographic camera over unit squares, two suns, a dim world."""
    scenes.empty_file()
    scene = bpy.context.scene
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.data.type, camera.data.ortho_scale = "ORTHO", max(columns, rows)
    camera.location = (columns / 2, rows / 2, 5)
    scene.collection.objects.link(camera)
    scene.camera = camera
    for name, turn, power in (("Front", (0.1, 0.8, 0.0), 2.0), ("Back", (0.1, 2.6, 0.0), 3.0)):
        sun = bpy.data.objects.new(name, bpy.data.lights.new(name, "SUN"))
        sun.data.angle, sun.data.energy, sun.rotation_euler = 0.1, power, turn
        scene.collection.objects.link(sun)
    scene.render.film_transparent = True
    both_engines.sample_plainly(scene, samples)
    scene.cycles_curves.shape, scene.rayleaf.strand_shape = "THICK", "ROUND"
    # Distribution ray tracing follows one diffuse bounce.
    limits = {"diffuse_bounces": 1 if distribution else 4, "glossy_bounces": 12, "transmission_bounces": 12}
    both_engines.set_alike(scene, max_bounces=12, **limits)
    scene.render.resolution_x, scene.render.resolution_y = columns * PIXELS, rows * PIXELS
    if distribution:
        own = scene.rayleaf
        own.integrator, own.hemisphere_rays, own.light_rays = "DISTRIBUTION", 4, 2
        scene.cycles.samples = 4 * samples
    scenes.write_layers()
    return scene


# What is lit, and the cases.
KINDS = {"subsurface": (body, subsurface_cases), "hair": (tuft, hair_cases), "shaders": (body, shader_cases)}


def compared_nodes(kinds=tuple(KINDS)):
    """By case: the node as it is compared."""
    cases = [case for kind in kinds for case in KINDS[kind][1]()]
    return {case.name: [described(build_material(case)[1])] for case in cases}


def main(kind, integrator, folder):
    """Render both, each twice; means by case."""
    add, make_cases = KINDS[kind]
    cases = make_cases()
    columns = math.ceil(math.sqrt(len(cases)))
    rows = math.ceil(len(cases) / columns)
    scene = set_up(columns, rows, SAMPLES[kind], integrator == "distribution")
    for i, case in enumerate(cases):
        add(i % columns + 0.5, i // columns + 0.5, build_material(case)[0])
    pictures = {}
    for engine in ("CYCLES", "RAYLEAF"):
        for seed in (1, 2):
            scene.cycles.seed = scene.rayleaf.seed = seed
            pictures[engine, seed] = both_engines.picture(scene, engine, folder / f"{engine}{seed}.exr")
    found = {}
    for i, case in enumerate(cases):
        row, column = i // columns, i % columns
        part = np.s_[row * PIXELS : (row + 1) * PIXELS, column * PIXELS : (column + 1) * PIXELS]
        found[case.name] = {
            f"{engine} {seed}": each[part].mean(axis=(0, 1)).tolist() for (engine, seed), each in pictures.items()
        }
    return found


if __name__ == "__main__":
    report = globals()["report"]  # given by the test
    found_means = main(sys.argv[1], sys.argv[2], Path(sys.argv[3]))
    report(found=found_means, version=bpy.app.version, nodes=compared_nodes([sys.argv[1]]))
