"""Runs inside Blender: a camera looks at the sun of Sky Textures, by Cycles and by Rayleaf; one sample in each pixel's middle.
Then at a diffuse ground under them.
"""

import math
import sys
from pathlib import Path

import bpy
import numpy as np
import plain_exr
import scenes
from oracle_case import described_nodes

# Names of Blender 3 and of 5.
KINDS, DUST = (
    (["NISHITA"], "dust_density")
    if bpy.app.version < (5, 0, 0)
    else (["SINGLE_SCATTERING", "MULTIPLE_SCATTERING"], "aerosol_density")
)
SUNS = [
    {"sky_type": kind, **sun}
    for kind in KINDS
    for sun in (
        {"sun_elevation": 0.5, "sun_rotation": 0.7, "sun_size": 0.2},
        {"sun_elevation": 0.3, "sun_rotation": -2.0, "sun_size": 0.3, "sun_intensity": 0.4, DUST: 3.0},
    )
]


def look(scene, engine, path):
    """Colours as the engine sees them."""
    scene.render.engine, scene.render.filepath = engine, str(path)
    bpy.ops.render.render(write_still=True)
    channels = plain_exr.read(path)
    return np.stack([channels[f"ViewLayer.Combined.{letter}"] for letter in "RGB"], -1).astype(np.float64)


def build():
    """A world with a sky, and a camera; the scene and the sky's node."""
    scene = scenes.empty_scene()
    scene.render.resolution_x = scene.render.resolution_y = 40
    scene.cycles.use_adaptive_sampling = scene.cycles.use_denoising = False
    scene.cycles.pixel_filter_type = scene.rayleaf.filter_type = "BOX"
    for own in (scene.cycles, scene.rayleaf):
        own.samples, own.filter_width, own.film_exposure = 1, 0.01, 1.0
    scenes.write_layers()
    scene.world = bpy.data.worlds.new("World")
    scene.world.use_nodes = True
    tree = scene.world.node_tree
    sky = tree.nodes.new("ShaderNodeTexSky")
    tree.links.new(sky.outputs[0], tree.nodes["Background"].inputs["Color"])
    tree.nodes["Background"].inputs["Strength"].default_value = 0.7
    return scene, sky


def turn_to(scene, sky, sun):
    """Set a sun, and look at it."""
    for name, value in sun.items():
        setattr(sky, name, value)
    scene.camera.data.angle = 2.0 * sun["sun_size"]
    scene.camera.rotation_euler = (0.5 * math.pi + sun["sun_elevation"], 0.0, -sun["sun_rotation"])


def light_on_ground(scene, sky, sun, folder):
    """The mean colour of a diffuse ground under a sun, by Cycles and by Rayleaf."""
    for name, value in sun.items():
        setattr(sky, name, value)
    bpy.ops.mesh.primitive_plane_add(size=100.0)
    material = bpy.data.materials.new("Ground")
    material.use_nodes = True
    nodes = material.node_tree.nodes
    diffuse = nodes.new("ShaderNodeBsdfDiffuse")
    material.node_tree.links.new(diffuse.outputs[0], nodes["Material Output"].inputs["Surface"])
    ground = bpy.context.object
    ground.data.materials.append(material)
    ground.location = (0.0, 0.0, -1.0)
    scene.camera.rotation_euler = (0.0, 0.0, 0.0)
    scene.camera.data.angle = 0.5
    found = []
    for engine in ("CYCLES", "RAYLEAF"):
        scene.cycles.samples = scene.rayleaf.samples = 16
        found.append(look(scene, engine, folder / f"ground_{engine}.exr").mean((0, 1)).tolist())
    bpy.data.objects.remove(ground)
    return found


def compared_nodes():
    """By case: the nodes as they are compared."""
    scene, sky = build()
    found = {}
    for number, sun in enumerate(SUNS):
        turn_to(scene, sky, sun)
        found[f"sun {number + 1}"] = described_nodes(sky.id_data, ("ShaderNodeTexSky", "ShaderNodeBackground"))
    return found


def main(folder):
    """Render both; each sun's differences, relative to each pixel's brightest channel."""
    scene, sky = build()
    found = []
    for sun in SUNS:
        turn_to(scene, sky, sun)
        cycles, rayleaf = (look(scene, engine, folder / f"{engine}.exr") for engine in ("CYCLES", "RAYLEAF"))
        difference = np.abs(rayleaf - cycles) / np.maximum(cycles.max(axis=-1, keepdims=True), 1.0)
        inside = cycles[..., 0] > 100.0
        found.append([np.sort(difference.max(axis=-1).ravel()).tolist(), float(inside.mean())])
    return found


def ground(folder):
    """Under suns as small as the true one, which are a hundred thousand times as bright as the sky."""
    scene, sky = build()
    return [light_on_ground(scene, sky, {**sun, "sun_size": math.radians(0.5)}, folder) for sun in SUNS]


if __name__ == "__main__":
    report = globals()["report"]  # given by the test
    report(
        found=main(Path(sys.argv[1])),
        ground=ground(Path(sys.argv[1])),
        kinds=[sun["sky_type"] for sun in SUNS],
        nodes=compared_nodes(),
    )
