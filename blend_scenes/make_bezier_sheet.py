"""Makes bezier_sheet.blend: a waved mirror of 10 x 10 bicubic patches inside a large sphere with a procedural texture."""

import sys
from pathlib import Path

import bpy
import numpy as np

sys.path.append(str(Path(__file__).resolve().parent))
from scene_tools import (  # noqa: E402
    NodeTree,
    add_camera,
    add_grid,
    add_surface,
    bezier_from_cubic_b_spline,
    painted_sky,
    save,
    start_empty,
)

PATCHES = 10  # along each side
SIDE = 10.0  # of the sheet
SPHERE = 30.0  # radius


def sheet_points() -> np.ndarray:
    """Bezier points of a sheet that is smooth to the second derivative: a cubic B-spline, split at its knots."""
    count = PATCHES + 3
    steps = (np.arange(count) - (count - 1) / 2) * SIDE / PATCHES
    x, y = np.meshgrid(steps, steps)
    height = (
        0.42 * np.sin(0.9 * x + 0.5 * y) + 0.3 * np.cos(1.25 * y - 0.6 * x + 1) + 0.16 * np.sin(2.0 * x - 1.4 * y + 2)
    )
    control = np.stack([x, y, height, np.ones_like(x)], axis=-1)
    return bezier_from_cubic_b_spline(bezier_from_cubic_b_spline(control, 0), 1)


def mirror() -> bpy.types.Material:
    """A perfect mirror, very slightly golden."""
    made = bpy.data.materials.new("mirror")
    tree = NodeTree(made)
    shader = tree.add("ShaderNodeBsdfGlossy", {"Color": (0.95, 0.93, 0.88, 1), "Roughness": 0.0})
    tree.add("ShaderNodeOutputMaterial", {"Surface": shader.outputs[0]})
    return made


def main() -> None:
    start_empty(width=800, height=450, samples=32)
    sheet = add_surface("sheet")
    spline = add_grid(sheet, sheet_points())
    spline.use_endpoint_u = spline.use_endpoint_v = True
    spline.use_bezier_u = spline.use_bezier_v = True
    spline.order_u = spline.order_v = 4
    sheet.data.materials.append(mirror())

    bpy.ops.surface.primitive_nurbs_surface_sphere_add(radius=SPHERE)
    sphere = bpy.context.object
    sphere.name = sphere.data.name = "sphere"
    sphere.data.materials.append(painted_sky())

    add_camera((0.0, -9.5, 4.2), (0.0, -0.6, -0.4), 32)
    bpy.context.scene.world = None
    save("bezier_sheet")


main()
