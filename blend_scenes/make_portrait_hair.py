"""Makes portrait_hair.blend: a head of skin with blonde hair by melanin, dyed strands, and a brow of a colour given directly."""

import sys
from pathlib import Path
from typing import Any

import bpy

sys.path.append(str(Path(__file__).resolve().parent))
from scene_meshes import add_ball, add_turned, rounded  # noqa: E402
from scene_tools import (  # noqa: E402
    NodeTree,
    add_camera,
    add_lamp,
    graded_world,
    material,
    save,
    start_empty,
)

SKY = ((0.0, (0.32, 0.3, 0.3)), (0.4, (0.2, 0.22, 0.28)), (1.0, (0.1, 0.12, 0.2)))
BUST = (
    (0, 0),
    (0.6, 0),
    (0.85, 0.04),
    (0.8, 0.3),
    (0.45, 0.46),
    (0.27, 0.56),
    (0.25, 0.75),
    (0.26, 0.9),
    (0.1, 1.0),
    (0, 1),
)
CHILDREN = 40  # of each parent


def skin() -> Any:
    """Light goes some millimetres into it."""
    made = bpy.data.materials.new("skin")
    tree = NodeTree(made)
    inputs = {
        "Base Color": (0.76, 0.5, 0.4, 1),
        "Subsurface": 1.0,
        "Subsurface Color": (0.76, 0.5, 0.4, 1),
        "Subsurface Radius": (0.08, 0.03, 0.015),
        "Roughness": 0.45,
        "Specular": 0.4,
    }
    shader = tree.add("ShaderNodeBsdfPrincipled", inputs)
    tree.add("ShaderNodeOutputMaterial", {"Surface": shader.outputs[0]})
    return made


def hair(name: str, **inputs: Any) -> Any:
    """Principled Hair; `parametrization` and inputs by their names, `_` for a space."""
    made = bpy.data.materials.new(name)
    tree = NodeTree(made)
    parametrization = inputs.pop("parametrization")
    values = {key.replace("_", " "): value for key, value in inputs.items()}
    shader = tree.add("ShaderNodeBsdfHairPrincipled", values, parametrization=parametrization)
    tree.add("ShaderNodeOutputMaterial", {"Surface": shader.outputs[0]})
    return made


def grow(owner: Any, look: Any, slot: int, seed: int, **settings: Any) -> Any:
    """Particle hair of a material that its owner gets in that slot."""
    owner.data.materials.append(look)
    owner.modifiers.new(look.name, "PARTICLE_SYSTEM")
    system = owner.particle_systems[-1]
    system.seed = seed
    own = system.settings
    own.name, own.type, own.material, own.hair_step = look.name, "HAIR", slot, 6
    own.render_step = own.display_step = 3
    own.root_radius, own.tip_radius = 1.0, 0.2
    own.display_percentage = 1
    for name, value in settings.items():
        setattr(own, name, value)
    return system


def group(owner: Any, name: str, wanted: Any) -> str:
    """A vertex group of the vertices that are wanted, by their places."""
    made = owner.vertex_groups.new(name=name)
    made.add([vertex.index for vertex in owner.data.vertices if wanted(vertex.co)], 1.0, "REPLACE")
    return made.name


def add_head() -> None:
    """An egg with hair above and behind its face."""
    head = add_ball("head", 0.5, skin(), (0, 0, 1.32), (0.82, 0.95, 1.1))
    scalp = group(head, "scalp", lambda at: at.z > 0.12 + 0.35 * max(0.0, -at.y) or (at.y > 0.1 and at.z > -0.25))
    brows = group(head, "brows", lambda at: at.y < -0.4 and 0.08 < at.z < 0.15 and 0.08 < abs(at.x) < 0.26)
    blonde = hair(
        "blonde", parametrization="MELANIN", Melanin=0.35, Melanin_Redness=0.4, Roughness=0.25, Radial_Roughness=0.3
    )
    children = "child_nbr" if bpy.app.version < (4, 0, 0) else "child_percent"
    system = grow(
        head,
        blonde,
        2,
        5,
        count=260,
        hair_length=0.62,
        brownian_factor=0.03,
        child_type="SIMPLE",
        rendered_child_count=CHILDREN,
        child_radius=0.09,
        child_roundness=0.6,
        clump_factor=0.4,
        roughness_2=0.02,
        radius_scale=0.006,
        tangent_factor=0.1,
        **{children: 1},
    )
    system.settings.effector_weights.gravity = 1.0
    system.settings.normal_factor = 0.02
    system.settings.object_align_factor = (0, 0.06, -0.05)
    system.vertex_group_density = scalp
    dark = hair("brow", parametrization="COLOR", Color=(0.12, 0.05, 0.02, 1), Roughness=0.35, Coat=0.3)
    system = grow(head, dark, 3, 2, count=300, hair_length=0.05, radius_scale=0.007, brownian_factor=0.004)
    system.vertex_group_density = brows


def main() -> None:
    start_empty(width=480, height=560, samples=64)
    add_head()
    add_turned("bust", rounded(BUST), material("cloth", (0.12, 0.16, 0.22), 0.8))
    graded_world("room", SKY, 0.7)
    key = add_lamp("key", "AREA", (-2.2, -2.4, 2.9), (0, 0, 1.3), 120, (1.0, 0.93, 0.85))
    key.data.shape, key.data.size = "DISK", 1.4
    rim = add_lamp("rim", "AREA", (1.8, 2.0, 2.5), (0, 0, 1.4), 150, (0.8, 0.88, 1.0))
    rim.data.shape, rim.data.size = "DISK", 1.0
    scene = bpy.context.scene
    scene.cycles_curves.shape = "THICK"
    add_camera((0.5, -3.9, 1.45), (0, 0, 1.18), 62)
    save("portrait_hair")


main()
