"""Runs inside Blender: panoramic cameras see a world painted by direction, and bodies around; Cycles and Rayleaf."""

import math
import sys
from pathlib import Path

import both_engines
import bpy
import numpy as np
import scenes

report = globals()["report"]  # given by the test
HALF = math.pi / 2
# By name: the type, its settings, the picture's size, and settings of the camera.
CASES = {
    "all around": ("EQUIRECTANGULAR", {}, (48, 24), {}),
    "a part": (
        "EQUIRECTANGULAR",
        dict(longitude_min=-0.7, longitude_max=1.4, latitude_min=-0.3, latitude_max=1.2),
        (32, 32),
        {},
    ),
    "equidistant": ("FISHEYE_EQUIDISTANT", dict(fisheye_fov=math.pi), (32, 32), {}),
    "equidistant, wide, in a wide picture": ("FISHEYE_EQUIDISTANT", dict(fisheye_fov=5.0), (48, 24), {}),
    "equisolid": ("FISHEYE_EQUISOLID", dict(fisheye_fov=math.pi, fisheye_lens=10.5), (32, 32), {}),
    "equisolid in a wide picture": ("FISHEYE_EQUISOLID", dict(fisheye_fov=2.5, fisheye_lens=15.0), (48, 24), {}),
    "equisolid in a tall picture": ("FISHEYE_EQUISOLID", dict(fisheye_fov=3.5, fisheye_lens=12.0), (24, 48), {}),
    "equisolid, vertical fit": ("FISHEYE_EQUISOLID", dict(fisheye_lens=12.0), (48, 32), dict(sensor_fit="VERTICAL")),
    "mirror ball": ("MIRRORBALL", {}, (32, 32), {}),
}


def paint_world(scene):
    """Colours that vary with the direction, no two directions alike."""
    world = scene.world = bpy.data.worlds.new("painted")
    world.use_nodes = True
    tree = world.node_tree
    place, scale = tree.nodes.new("ShaderNodeTexCoord"), tree.nodes.new("ShaderNodeVectorMath")
    scale.operation = "MULTIPLY_ADD"
    scale.inputs[1].default_value = scale.inputs[2].default_value = (0.5, 0.5, 0.5)
    tree.links.new(place.outputs["Generated"], scale.inputs[0])
    tree.links.new(scale.outputs["Vector"], tree.nodes["Background"].inputs["Color"])


def build(kind, settings, size, more):
    """A camera that is turned, in the middle of the world, with a cube on either side."""
    scenes.empty_file()
    scene = bpy.context.scene
    paint_world(scene)
    for place in ((2, 3, 0.5), (-3, 1, -0.5)):
        bpy.ops.mesh.primitive_cube_add(size=1.5, location=place)
    camera = bpy.data.cameras.new("camera")
    scene.camera = scenes.add(camera)
    scene.camera.rotation_euler = (1.2, 0.2, 0.4)
    scenes.make_panoramic(camera, kind, **settings)
    for name, value in more.items():
        setattr(camera, name, value)
    scene.render.resolution_x, scene.render.resolution_y = size
    both_engines.sample_plainly(scene, 64)
    both_engines.set_alike(scene, max_bounces=1)
    both_engines.filter_by_box(scene)
    bpy.context.view_layer.use_pass_z = True
    scenes.write_layers()
    return scene


if __name__ == "__main__":
    folder, result = Path(sys.argv[1]), {}
    for name, case in CASES.items():
        made = build(*case)
        found = [both_engines.channels(made, engine, folder / "picture.exr") for engine in ("CYCLES", "RAYLEAF")]
        colors = [both_engines.color(each, letters="RGBA") for each in found]
        depths = [each["ViewLayer.Depth.Z"] for each in found]
        near = (depths[0] < 100) & (depths[1] < 100)
        result[name] = dict(
            mean=float(np.abs(colors[0] - colors[1]).mean()),
            empty=[float((each[..., :3] == 0).all(-1).mean()) for each in colors],
            depth=float(np.median(np.abs(depths[0] - depths[1])[near])) if near.any() else None,
        )
    report(result=result)
