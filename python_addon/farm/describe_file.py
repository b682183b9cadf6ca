"""Inside Blender: what the farm must know of the file, as one line of JSON behind FARM."""

import json

import bpy

scene = bpy.context.scene
samples = [layer.samples or scene.rayleaf.samples for layer in scene.view_layers if layer.use]
known = {"step": scene.frame_step, "samples": [min(samples, default=1), max(samples, default=1)]}
print("\nFARM", json.dumps(known), flush=True)
