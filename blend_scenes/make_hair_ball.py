"""Makes hair_ball.blend: a ball of 100,000 strands, particle hair whose colour, from root to tip, is the strand's own.

Another number of strands may follow FOLDER.
"""

import sys
from pathlib import Path
from typing import Any

import bpy

sys.path.append(str(Path(__file__).resolve().parent))
from scene_tools import (  # noqa: E402
    NodeTree,
    add_camera,
    add_floor,
    add_lamp,
    arguments,
    color_ramp,
    graded_world,
    matte,
    save,
    start_empty,
)

STRANDS = 100_000
CHILDREN = 100  # of each parent
SKY = ((0.0, (0.55, 0.6, 0.7)), (0.4, (0.2, 0.26, 0.38)), (1.0, (0.06, 0.08, 0.14)))


def hair() -> Any:
    """Dark at the root, and at the tip a colour between rust and cream that chance gives the strand."""
    made = bpy.data.materials.new("hair")
    tree = NodeTree(made)
    info = tree.add("ShaderNodeHairInfo")
    tips = color_ramp(
        tree,
        info.outputs["Random"],
        ((0.0, (0.36, 0.07, 0.02)), (0.5, (0.72, 0.26, 0.06)), (0.8, (0.85, 0.48, 0.16)), (1.0, (0.95, 0.8, 0.58))),
    )
    root = (0.07, 0.015, 0.01, 1)
    share = tree.add("ShaderNodeMath", {0: info.outputs["Intercept"], 1: 0.7}, operation="POWER")
    color = tree.add("ShaderNodeMixRGB", {"Fac": share.outputs[0], "Color1": root, "Color2": tips.outputs["Color"]})
    shader = tree.add("ShaderNodeBsdfPrincipled", {"Base Color": color.outputs[0], "Roughness": 0.38, "Specular": 0.35})
    tree.add("ShaderNodeOutputMaterial", {"Surface": shader.outputs[0]})
    made.diffuse_color = (0.6, 0.2, 0.05, 1)
    return made


def add_ball(strands: int) -> None:
    """The ball and its hair."""
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=4, radius=1.0, location=(0, 0, 1.62))
    ball = bpy.context.object
    ball.name = ball.data.name = "ball"
    ball.data.materials.append(matte("skin", (0.05, 0.012, 0.01)))
    ball.data.materials.append(hair())
    ball.modifiers.new("hair", "PARTICLE_SYSTEM")
    system = ball.particle_systems[0]
    system.seed = 3
    settings = system.settings
    settings.name = "hair"
    settings.type = "HAIR"
    settings.count = max(1, strands // CHILDREN)
    settings.hair_length = 0.62
    settings.hair_step = 5
    settings.brownian_factor = 0.06
    settings.effector_weights.gravity = 0.35
    settings.material = 2
    settings.child_type = "SIMPLE"
    setattr(settings, "child_nbr" if bpy.app.version < (4, 0, 0) else "child_percent", 1)
    settings.rendered_child_count = CHILDREN
    settings.child_radius = 0.12
    settings.child_roundness = 1.0
    settings.clump_factor = 0.55
    settings.clump_shape = 0.25
    settings.roughness_2 = 0.03
    settings.roughness_endpoint = 0.02
    settings.child_length = 1.0
    settings.child_length_threshold = 0.0
    settings.render_step = settings.display_step = 3
    settings.kink = "CURL"
    settings.kink_amplitude = 0.035
    settings.kink_frequency = 2.0
    settings.root_radius, settings.tip_radius = 1.0, 0.15
    settings.radius_scale = 0.006
    settings.display_percentage = 1


def main() -> None:
    start_empty(width=620, height=600, samples=48)
    add_ball(int(arguments()[1]) if len(arguments()) > 1 else STRANDS)
    add_floor("ground", (-16, -10), (16, 22), matte("ground", (0.3, 0.34, 0.36)))
    graded_world("sky", SKY, 0.8)
    key = add_lamp("key", "AREA", (-4.2, -4.0, 5.6), (0, 0, 1.6), 700, (1.0, 0.93, 0.84))
    key.data.shape, key.data.size = "DISK", 1.6
    rim = add_lamp("rim", "AREA", (3.8, 3.6, 4.4), (0, 0, 1.8), 600, (0.7, 0.84, 1.0))
    rim.data.shape, rim.data.size = "DISK", 1.4
    add_camera((0.4, -7.6, 2.9), (0.0, 0, 1.52), 62)
    save("hair_ball")


main()
