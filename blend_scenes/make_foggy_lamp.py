"""Makes foggy_lamp.blend: a street lamp of a measured distribution (IES) in fog, a window's light by a texture, embers that
glow in their own smoke."""

import sys
from pathlib import Path
from typing import Any

import bpy

sys.path.append(str(Path(__file__).resolve().parent))
from scene_meshes import add_ball, add_box, add_turned, rounded  # noqa: E402
from scene_tools import (  # noqa: E402
    NodeTree,
    add_camera,
    add_floor,
    add_lamp,
    color_ramp,
    material,
    plain_world,
    save,
    start_empty,
)

# Candelas by the angle from straight down, alike all around: much below, a ring at sixty degrees, nothing above.
CANDELAS = ((0, 800), (15, 780), (30, 700), (45, 900), (60, 1400), (70, 700), (80, 120), (90, 0), (180, 0))
HAT = ((0, 2.52), (0.2, 2.52), (0.42, 2.5), (0.44, 2.52), (0.36, 2.62), (0.12, 2.72), (0.05, 2.84), (0, 2.84))


def distribution() -> Any:
    """The lamp's file, as a text of the scene."""
    text = bpy.data.texts.new("street lamp")
    counts = f"1 1000 1 {len(CANDELAS)} 1 1 2 0 0 0"
    angles, values = (" ".join(str(each[i]) for each in CANDELAS) for i in (0, 1))
    text.write(f"IESNA:LM-63-1995\nTILT=NONE\n{counts}\n1 1 100\n{angles}\n0\n{values}\n")
    return text


def add_street_lamp() -> None:
    """A post with a hat; the light hangs below it."""
    iron = material("iron", (0.05, 0.055, 0.06), 0.4, Metallic=0.6)
    add_box("post", (0.09, 0.09, 2.6), iron, (0, 0.3, 1.3))
    add_box("arm", (0.06, 0.5, 0.06), iron, (0, 0.12, 2.57))
    add_turned("hat", rounded(HAT), iron, (0, -0.1, -0.05), segments=48)
    lamp = add_lamp("street lamp", "POINT", (0, -0.1, 2.4), (0, -0.1, 0), 60, (1.0, 0.78, 0.5))
    lamp.rotation_euler = (0, 0, 0)
    lamp.data.shadow_soft_size = 0.08
    tree = NodeTree(lamp.data)
    shape = tree.add("ShaderNodeTexIES", {"Strength": 0.05}, mode="INTERNAL", ies=distribution())
    shine = tree.add("ShaderNodeEmission", {"Strength": shape.outputs[0]})
    tree.add("ShaderNodeOutputLight", {"Surface": shine.outputs[0]})


def add_window() -> None:
    """A spot through panes: its nodes see the direction of the light."""
    lamp = add_lamp("window", "SPOT", (-4.2, 1.8, 2.6), (-0.6, 0.2, 0.2), 700, (0.5, 0.7, 1.0))
    lamp.data.spot_size, lamp.data.spot_blend, lamp.data.shadow_soft_size = 0.7, 0.1, 0.03
    tree = NodeTree(lamp.data)
    direction = tree.add("ShaderNodeTexCoord").outputs["Normal"]
    flat = tree.add("ShaderNodeSeparateXYZ", {"Vector": direction})
    across = [
        tree.add("ShaderNodeMath", {0: flat.outputs[i], 1: flat.outputs[2]}, operation="DIVIDE").outputs[0]
        for i in (0, 1)
    ]
    place = tree.add("ShaderNodeCombineXYZ", {0: across[0], 1: across[1]}).outputs[0]
    panes = {"Vector": place, "Scale": 6.0, "Mortar Size": 0.04, "Color1": (1, 0.9, 0.6, 1), "Color2": (0.6, 0.8, 1, 1)}
    bricks = tree.add("ShaderNodeTexBrick", panes)
    shine = tree.add("ShaderNodeEmission", {"Color": bricks.outputs["Color"]})
    tree.add("ShaderNodeOutputLight", {"Surface": shine.outputs[0]})


def add_fog() -> None:
    """The same all over a box, and forward scattering."""
    fog = bpy.data.materials.new("fog")
    tree = NodeTree(fog)
    scatter = tree.add("ShaderNodeVolumeScatter", {"Color": (0.9, 0.94, 1, 1), "Density": 0.12, "Anisotropy": 0.3})
    tree.add("ShaderNodeOutputMaterial", {"Volume": scatter.outputs[0]})
    add_box("fog", (12, 12, 6), fog, (0, 1, 2.95))


def add_embers() -> None:
    """A ball of smoke that varies, and glows where it is thick."""
    smoke = bpy.data.materials.new("smoke")
    tree = NodeTree(smoke)
    place = tree.add("ShaderNodeTexCoord").outputs["Object"]
    noise = tree.add("ShaderNodeTexNoise", {"Vector": place, "Scale": 4.0, "Detail": 1.0})
    density = color_ramp(tree, noise.outputs[0], ((0.45, (0, 0, 0)), (0.6, (1, 1, 1)))).outputs[0]
    thick = tree.add("ShaderNodeMath", {0: density, 1: 8.0}, operation="MULTIPLY").outputs[0]
    heat = tree.add("ShaderNodeMath", {0: density, 1: 2.5}, operation="MULTIPLY").outputs[0]
    inputs = {
        "Color": (0.4, 0.4, 0.42, 1),
        "Density": thick,
        "Emission Strength": heat,
        "Emission Color": (1, 0.25, 0.06, 1),
    }
    inside = tree.add("ShaderNodeVolumePrincipled", inputs)
    tree.add("ShaderNodeOutputMaterial", {"Volume": inside.outputs[0]})
    add_ball("embers", 0.42, smoke, (1.35, -0.35, 0.55))
    add_turned(
        "basket",
        rounded(((0, 0.0), (0.2, 0.0), (0.32, 0.02), (0.36, 0.2), (0.33, 0.2), (0.28, 0.06), (0.1, 0.05), (0, 0.05))),
        material("rust", (0.2, 0.08, 0.04), 0.7),
        (1.35, -0.35, 0.001),
    )


def main() -> None:
    start_empty(width=640, height=480, samples=64)
    add_floor("pavement", (-12, -8), (12, 16), material("pavement", (0.22, 0.22, 0.23), 0.55))
    add_box("bench", (1.1, 0.35, 0.08), material("wood", (0.3, 0.16, 0.08), 0.6), (-1.1, 0.3, 0.42))
    for index, x in enumerate((-1.5, -0.7)):
        add_box(f"leg {index}", (0.07, 0.3, 0.38), material("iron legs", (0.05, 0.05, 0.06), 0.5), (x, 0.3, 0.19))
    add_street_lamp()
    add_window()
    add_fog()
    add_embers()
    plain_world((0.05, 0.08, 0.14), 0.3)
    scene = bpy.context.scene
    scene.rayleaf.max_bounces = 4
    scene.rayleaf.volume_bounces = 2
    if hasattr(scene, "cycles"):  # what it is compared with
        scene.cycles.max_bounces, scene.cycles.volume_bounces = 4, 2
    add_camera((0.7, -6.2, 1.5), (0.05, 0, 1.25), 38)
    save("foggy_lamp")


main()
