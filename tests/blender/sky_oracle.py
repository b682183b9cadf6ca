"""Runs inside Blender: a camera looks at the sun of Sky Textures, by Cycles and by Rayleaf; one sample in each pixel's middle."""

import math
import sys
from pathlib import Path

import bpy
import numpy as np
import plain_exr
import scenes

report = globals()["report"]  # given by the test
# Names of Blender 3 and of 5.
NISHITA, DUST = ("NISHITA", "dust_density") if bpy.app.version < (5, 0, 0) else ("SINGLE_SCATTERING", "aerosol_density")
SUNS = (
    {"sun_elevation": 0.5, "sun_rotation": 0.7, "sun_size": 0.2},
    {"sun_elevation": 0.3, "sun_rotation": -2.0, "sun_size": 0.3, "sun_intensity": 0.4, DUST: 3.0},
)


def look(scene, engine, path):
    """Colours as the engine sees them."""
    scene.render.engine, scene.render.filepath = engine, str(path)
    bpy.ops.render.render(write_still=True)
    channels = plain_exr.read(path)
    return np.stack([channels[f"ViewLayer.Combined.{letter}"] for letter in "RGB"], -1).astype(np.float64)


def main(folder):
    """Render both and report each sun's differences, relative to each pixel's brightest channel."""
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
    sky.sky_type = NISHITA
    tree.links.new(sky.outputs[0], tree.nodes["Background"].inputs["Color"])
    found = []
    for sun in SUNS:
        for name, value in sun.items():
            setattr(sky, name, value)
        scene.camera.data.angle = 2.0 * sun["sun_size"]
        scene.camera.rotation_euler = (0.5 * math.pi + sun["sun_elevation"], 0.0, -sun["sun_rotation"])
        cycles, rayleaf = (look(scene, engine, folder / f"{engine}.exr") for engine in ("CYCLES", "RAYLEAF"))
        difference = np.abs(rayleaf - cycles) / np.maximum(cycles.max(axis=-1, keepdims=True), 1.0)
        inside = cycles[..., 0] > 100.0
        found.append([np.sort(difference.max(axis=-1).ravel()).tolist(), float(inside.mean())])
    report(found=found, version=bpy.app.version[0])


main(Path(sys.argv[1]))
