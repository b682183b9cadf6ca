"""Makes random_volumes_xray.blend: the bodies of random_volumes.blend as an x-ray, density times the length of rays."""

import sys
from pathlib import Path

import bpy

sys.path.append(str(Path(__file__).resolve().parent))
from scene_shapes import random_volumes  # noqa: E402
from scene_tools import add_camera, add_parts, plain_world, save, seed_argument, start_empty  # noqa: E402

SEED, BODIES, SIDE = 7, 10, 6.0
DENSITY = 0.3  # per unit of length


def main() -> None:
    start_empty(width=640, height=640, samples=24)
    scene = bpy.context.scene
    scene.rayleaf.ray_interpolation.mode = "AUTO"
    bpy.context.view_layer.rayleaf.use_pass_path_length = True
    look = bpy.data.materials.new("x-ray")
    look.rayleaf.use_volume = True
    look.rayleaf.volume_kind = "EMISSION"
    look.rayleaf.volume_density = DENSITY
    look.rayleaf.volume_color = (0.75, 0.86, 1.0)
    for index, body in enumerate(random_volumes(seed_argument(SEED), BODIES, SIDE)):
        add_parts(f"body {index}", [body]).data.materials.append(look)
    plain_world((0.002, 0.004, 0.01))
    add_camera((6.5, -9.5, 4.6), (0.0, 0.0, -0.1), 46)
    save("random_volumes_xray")


main()
