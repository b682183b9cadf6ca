"""Makes still_life.blend: thick tinted glass, fruit and wax that light enters, bumps, lamps by temperature, and a sky."""

import sys
from pathlib import Path
from typing import Any

import bpy

sys.path.append(str(Path(__file__).resolve().parent))
from scene_meshes import add_ball, add_turned, rounded  # noqa: E402
from scene_tools import (  # noqa: E402
    NodeTree,
    add_camera,
    add_floor,
    add_lamp,
    color_ramp,
    save,
    start_empty,
)

# Radius and height, from the axis below round the outside to the axis above.
BOTTLE = ((0, 0), (0.3, 0), (0.46, 0.02), (0.5, 0.2), (0.5, 0.75), (0.46, 1.05), (0.2, 1.3), (0.15, 1.5), (0.15, 1.78))
BOTTLE_RIM = ((0.19, 1.82), (0.19, 1.9), (0.15, 1.94), (0.1, 1.9))
BOTTLE_INSIDE = (
    (0.09, 1.5),
    (0.13, 1.28),
    (0.38, 1.02),
    (0.42, 0.75),
    (0.42, 0.25),
    (0.36, 0.12),
    (0.1, 0.14),
    (0, 0.14),
)
TUMBLER = ((0, 0), (0.25, 0), (0.34, 0.02), (0.36, 0.1), (0.42, 0.78), (0.43, 0.84), (0.4, 0.86), (0.37, 0.8))
TUMBLER_INSIDE = ((0.32, 0.3), (0.28, 0.2), (0.1, 0.17), (0, 0.17))
CANDLE = ((0, 0), (0.15, 0), (0.27, 0.0), (0.28, 0.08), (0.28, 0.5), (0.28, 0.62), (0.24, 0.66), (0.12, 0.6), (0, 0.6))
PEAR = ((0, 0), (0.12, 0), (0.36, 0.1), (0.42, 0.36), (0.32, 0.66), (0.16, 0.86), (0.12, 1.0), (0.06, 1.08), (0, 1.06))


def tinted_glass(name: str, color: tuple[float, float, float], density: float, ior: float) -> Any:
    """Clear on its surface; what it absorbs grows with the way through it."""
    made = bpy.data.materials.new(name)
    tree = NodeTree(made)
    surface = tree.add("ShaderNodeBsdfGlass", {"Color": (1, 1, 1, 1), "Roughness": 0.0, "IOR": ior})
    inside = tree.add("ShaderNodeVolumeAbsorption", {"Color": (*color, 1), "Density": density})
    tree.add("ShaderNodeOutputMaterial", {"Surface": surface.outputs[0], "Volume": inside.outputs[0]})
    return made


def translucent(name: str, color: Any, radius: Any, subsurface: float, bumps: float, scale: float) -> Any:
    """Light goes in and comes out elsewhere; its surface is bent by noise."""
    made = bpy.data.materials.new(name)
    tree = NodeTree(made)
    place = tree.add("ShaderNodeTexCoord").outputs["Object"]
    noise = tree.add("ShaderNodeTexNoise", {"Vector": place, "Scale": scale, "Detail": 2.0})
    height = {"Height": noise.outputs[0], "Strength": bumps, "Distance": 0.05}
    normal = tree.add("ShaderNodeBump", height).outputs[0]
    body = {"Color": (*color, 1), "Radius": radius, "Scale": subsurface, "Normal": normal}
    inside = tree.add("ShaderNodeSubsurfaceScattering", body)
    coat = tree.add("ShaderNodeBsdfGlossy", {"Color": (1, 1, 1, 1), "Roughness": 0.3, "Normal": normal})
    share = tree.add("ShaderNodeFresnel", {"IOR": 1.4, "Normal": normal})
    both = tree.add("ShaderNodeMixShader", {0: share.outputs[0], 1: inside.outputs[0], 2: coat.outputs[0]})
    tree.add("ShaderNodeOutputMaterial", {"Surface": both.outputs[0]})
    return made


def wood() -> Any:
    """Bands of a wave, darker and lower where they are late wood."""
    made = bpy.data.materials.new("wood")
    tree = NodeTree(made)
    place = tree.add("ShaderNodeTexCoord").outputs["Object"]
    along = tree.add("ShaderNodeMapping", {"Vector": place, "Scale": (0.35, 2.2, 1.0)}).outputs[0]
    bands = tree.add(
        "ShaderNodeTexWave", {"Vector": along, "Scale": 0.9, "Distortion": 6.0, "Detail": 2.0}, bands_direction="Y"
    )
    colors = color_ramp(tree, bands.outputs["Fac"], ((0.0, (0.16, 0.07, 0.03)), (1.0, (0.42, 0.23, 0.11))))
    bump = {"Height": bands.outputs["Fac"], "Strength": 0.4, "Distance": 0.05}
    normal = tree.add("ShaderNodeBump", bump).outputs[0]
    look = {"Base Color": colors.outputs[0], "Roughness": 0.45, "Normal": normal}
    shader = tree.add("ShaderNodeBsdfPrincipled", look)
    tree.add("ShaderNodeOutputMaterial", {"Surface": shader.outputs[0]})
    return made


def add_things() -> None:
    """On the table."""
    bottle = rounded(BOTTLE + BOTTLE_RIM + BOTTLE_INSIDE)
    add_turned("bottle", bottle, tinted_glass("green glass", (0.25, 0.75, 0.4), 3.0, 1.5), (-0.75, 0.5, 0.002))
    tumbler = rounded(TUMBLER + TUMBLER_INSIDE)
    add_turned("tumbler", tumbler, tinted_glass("amber glass", (0.95, 0.55, 0.2), 2.5, 1.5), (0.95, -0.35, 0.002))
    wax = translucent("wax", (0.9, 0.78, 0.55), (1.0, 0.6, 0.3), 0.1, 0.15, 6.0)
    add_turned("candle", rounded(CANDLE), wax, (0.35, 0.75, 0.002))
    skin = translucent("pear", (0.7, 0.72, 0.2), (0.6, 0.4, 0.1), 0.06, 0.3, 14.0)
    add_turned("pear", rounded(PEAR), skin, (0.1, -0.3, 0.002))
    peel = translucent("lemon", (0.9, 0.7, 0.08), (0.6, 0.4, 0.05), 0.05, 0.6, 22.0)
    lemon = add_ball("lemon", 0.3, peel, (-0.62, -0.62, 0.285), (1.3, 1, 0.95))
    lemon.rotation_euler = (0, 0, 0.6)


def add_lamp_by_temperature(name: str, location: Any, size: float, power: float, temperature: float) -> None:
    """An area lamp of a black body's colour."""
    lamp = add_lamp(name, "AREA", location, (0, 0, 0.5), power)
    lamp.data.shape, lamp.data.size = "DISK", size
    lamp.data.use_nodes = True
    tree = NodeTree(lamp.data)
    color = tree.add("ShaderNodeBlackbody", {"Temperature": temperature})
    shine = tree.add("ShaderNodeEmission", {"Color": color.outputs[0]})
    tree.add("ShaderNodeOutputLight", {"Surface": shine.outputs[0]})


def add_sky() -> None:
    """Evening, the sun below the picture's brightness: its disc is left out."""
    world = bpy.data.worlds.new("sky")
    bpy.context.scene.world = world
    tree = NodeTree(world)
    sky = tree.add("ShaderNodeTexSky", sky_type="NISHITA", sun_disc=False, sun_elevation=0.25, sun_rotation=2.2)
    background = tree.add("ShaderNodeBackground", {"Color": sky.outputs[0], "Strength": 0.35})
    tree.add("ShaderNodeOutputWorld", {"Surface": background.outputs[0]})


def main() -> None:
    start_empty(width=640, height=480, samples=64)
    add_things()
    add_floor("table", (-6, -4), (6, 6), wood())
    add_sky()
    add_lamp_by_temperature("window", (-2.6, -1.2, 3.2), 2.0, 90, 6500)
    add_lamp_by_temperature("bulb", (2.6, 1.4, 2.2), 0.9, 60, 2700)
    add_camera((0.35, -4.6, 1.75), (0.05, 0, 0.62), 50)
    save("still_life")


main()
