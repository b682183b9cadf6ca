"""Makes spiral.blend: a green spiral of one Bezier curve over a blue ground, matte, under a lamp that is a ball of light.

After the figures of *Effective curve primitive rendering in ray tracer*, which show such curves as chains of spheres, of triangles and of
quadrangles.
"""

import sys
from pathlib import Path

import bpy
import numpy as np

sys.path.append(str(Path(__file__).resolve().parent))
from scene_curves import add_bezier, add_curve  # noqa: E402
from scene_tools import NodeTree, add_camera, add_floor, add_lamp, matte, plain_world, save, start_empty  # noqa: E402

TURNS, POINTS_A_TURN = 5, 8


def lamp(name: str, color: tuple[float, float, float], strength: float) -> bpy.types.Material:
    """A surface that shines."""
    made = bpy.data.materials.new(name)
    tree = NodeTree(made)
    shader = tree.add("ShaderNodeEmission", {"Color": (*color, 1), "Strength": strength})
    tree.add("ShaderNodeOutputMaterial", {"Surface": shader.outputs[0]})
    return made


def spiral_points() -> tuple[np.ndarray, np.ndarray]:
    """Points and radii: wide at the ground, narrow at the top."""
    count = TURNS * POINTS_A_TURN + 1
    share = np.arange(count) / (count - 1)
    angle = share * TURNS * 2 * np.pi
    wide = 1.75 * (1 - share) ** 0.8 + 0.12
    points = np.stack([wide * np.cos(angle), wide * np.sin(angle), 0.24 + 2.9 * share**1.15], axis=1)
    return points, 1.25 - 0.95 * share


def main() -> None:
    start_empty(width=560, height=600, samples=48)
    points, radii = spiral_points()
    spiral = add_curve("spiral", bevel_depth=0.17, use_fill_caps=True)
    add_bezier(spiral, points, radii=radii, radius_interpolation="CARDINAL")
    spiral.data.materials.append(matte("green", (0.13, 0.55, 0.12)))
    add_floor("ground", (-12, -8), (12, 16), matte("blue", (0.07, 0.16, 0.5)))
    bpy.ops.surface.primitive_nurbs_surface_sphere_add(radius=0.42, location=(-1.75, 0.5, 3.3))
    ball = bpy.context.object
    ball.name = ball.data.name = "ball of light"
    ball.data.materials.append(lamp("warm light", (1.0, 0.9, 0.72), 60.0))
    plain_world((0.5, 0.62, 0.85), 0.35)
    add_lamp("fill", "SUN", (4, -3, 6), (0, 0, 0), 0.6, (0.8, 0.88, 1.0)).data.angle = 0.2
    add_camera((1.6, -7.4, 3.9), (0.0, 0, 1.42), 50)
    save("spiral")


main()
