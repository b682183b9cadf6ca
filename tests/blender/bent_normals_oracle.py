"""Runs inside Blender: squares that are seen at grazing angles, their normals bent further, under suns of several colours, in both
engines; reports the mean colour of each."""

import math
import sys
from pathlib import Path

import both_engines
import bpy
import numpy as np
import scenes
from mathutils import Vector

PIXELS, SAMPLES = 12, 1024
TILT = math.radians(70)  # of the squares, whose own normal is (0, -0.94, 0.34)
NORMALS = {
    "own": None,
    "level": (0.0, -1.0, 0.0),
    "away": (0.1, -0.94, -0.33),
    "aside": (0.8, -0.55, 0.2),
}
SUNS = {
    (1.0, 0.05, 0.05): (0.3, -0.9, 0.3),
    (0.05, 1.0, 0.05): (-0.6, -0.5, 0.6),
    (0.05, 0.05, 1.0): (0.05, 0.15, 0.98),
    (0.3, 0.3, 0.5): (-0.2, 0.6, -0.5),
}
# Without Refraction and Glass: through rough ones Cycles lets lamps shine where no facet refracts.
NODES = {
    "Diffuse": ("ShaderNodeBsdfDiffuse", {}),
    "rough Diffuse": ("ShaderNodeBsdfDiffuse", {"Roughness": 0.7}),
    "Translucent": ("ShaderNodeBsdfTranslucent", {}),
    "Glossy": ("ShaderNodeBsdfAnisotropic", {"Roughness": 0.5}),
    "Velvet": ("ShaderNodeBsdfVelvet", {"Sigma": 0.8}),
    "Sheen": ("ShaderNodeBsdfSheen", {"Roughness": 0.5}),
    "Toon": ("ShaderNodeBsdfToon", {"Size": 0.6, "Smooth": 0.3}),
    "plastic": ("ShaderNodeBsdfPrincipled", {"Roughness": 0.5}),
    "metal": ("ShaderNodeBsdfPrincipled", {"Roughness": 0.5, "Metallic": 1.0}),
    "coat": ("ShaderNodeBsdfPrincipled", {"Roughness": 0.8, "Coat Weight": 0.8, "Coat Roughness": 0.5}),
    "sheen": ("ShaderNodeBsdfPrincipled", {"Roughness": 0.8, "Sheen Weight": 1.0}),
}


def all_cases():
    """By name: the node, its inputs, the normal (a number or "bumped": of a Bump node), whether bumps are corrected."""
    trial, tree, _ = scenes.material("trial")
    found = {}
    for name, (node, inputs) in NODES.items():
        if hasattr(bpy.types, node) and set(inputs) <= set(tree.nodes.new(node).inputs.keys()):
            found |= {f"{name}, {kind}": (node, inputs, normal, True) for kind, normal in NORMALS.items()}
    for name in ("Diffuse", "Glossy", "plastic"):
        found[f"{name}, bumped"] = (*NODES[name], "bumped", True)
        # Ridges that are 1.4 pixels apart: what they look like depends on how far heights are compared.
        has_width = "Filter Width" in tree.nodes.new("ShaderNodeBump").inputs  # 4.5
        for width in (0.1, 0.6, 1.0) if has_width else (1.0,):
            found[f"{name}, ridged {width}"] = (*NODES[name], width, True)
        if hasattr(trial.cycles, "use_bump_map_correction"):  # 4.1
            found[f"{name}, as bent"] = (*NODES[name], NORMALS["away"], False)
    return found


def ridged(tree, width):
    """The normal of a Bump node over ridges that are 1.4 pixels apart."""
    bump, place, parts = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("Bump", "NewGeometry", "SeparateXYZ"))
    scaled, sine = tree.nodes.new("ShaderNodeMath"), tree.nodes.new("ShaderNodeMath")
    scaled.operation, sine.operation = "MULTIPLY", "SINE"
    scaled.inputs[1].default_value = 2 * math.pi * PIXELS / 1.4
    if "Filter Width" in bump.inputs:
        bump.inputs["Filter Width"].default_value = width
    bump.inputs["Distance"].default_value = 0.02
    for source, target in (
        (place.outputs["Position"], parts.inputs[0]),
        (parts.outputs["X"], scaled.inputs[0]),
        (scaled.outputs[0], sine.inputs[0]),
        (sine.outputs[0], bump.inputs["Height"]),
    ):
        tree.links.new(source, target)
    return bump.outputs[0]


def bent(tree, normal):
    """A normal: a constant, or that of a Bump node whose heights rise along the square, or are ridges across it."""
    if isinstance(normal, float):
        return ridged(tree, normal)
    combined = tree.nodes.new("ShaderNodeCombineXYZ")
    if normal != "bumped":
        for socket, value in zip(combined.inputs, normal):
            socket.default_value = value
        return combined.outputs[0]
    bump, place, parts = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("Bump", "NewGeometry", "SeparateXYZ"))
    bump.inputs["Distance"].default_value = 3.0
    tree.links.new(place.outputs["Position"], parts.inputs[0])
    tree.links.new(parts.outputs["Y"], bump.inputs["Height"])
    return bump.outputs[0]


def show(number, name, node, inputs, normal, is_corrected):
    """A square with a case's material in its column of the picture."""
    material, tree, output = scenes.material(name)
    if not is_corrected:
        material.cycles.use_bump_map_correction = False
    shader = tree.nodes.new(node)
    if node == "ShaderNodeBsdfAnisotropic":
        shader.distribution = "GGX"
    for socket, value in inputs.items():
        shader.inputs[socket].default_value = value
    if normal is not None:
        tree.links.new(bent(tree, normal), shader.inputs["Normal"])
    tree.links.new(shader.outputs[0], output.inputs["Surface"])
    square = scenes.quad(name)
    square.data.materials.append(material)
    square.location, square.rotation_euler = (number, 0, 0), (TILT, 0, 0)


def build(cases):
    """The squares side by side, and the suns, of some width each."""
    scenes.empty_file()
    scenes.plain_world((0, 0, 0))
    for number, (name, case) in enumerate(cases.items()):
        show(number, name, *case)
    for color, towards in SUNS.items():
        lamp = bpy.data.lights.new("sun", "SUN")
        lamp.energy, lamp.angle, lamp.color = 2.0, 0.3, color
        lamp.use_shadow = True
        scenes.add(lamp).rotation_euler = Vector(towards).to_track_quat("Z", "Y").to_euler()
    scene = bpy.context.scene
    both_engines.set_alike(scene, max_bounces=0)
    return scene


if __name__ == "__main__":
    report = globals()["report"]  # given by the test
    chosen = all_cases()
    pictures = both_engines.pictures_of_squares(build(chosen), chosen, PIXELS, SAMPLES, Path(sys.argv[1]))
    colors = {name: [np.mean(each, (0, 1))[:3].tolist() for each in pair] for name, pair in pictures.items()}
    report(colors=colors, version=bpy.app.version)
