"""Makes glass_vase.blend: a turned vase, one closed shell of glass with a hollow inside, on a checkered table."""

import sys
from pathlib import Path

import bpy
import numpy as np

sys.path.append(str(Path(__file__).resolve().parent))
from scene_tools import (  # noqa: E402
    add_camera,
    add_floor,
    add_grid,
    add_lamp,
    add_surface,
    checkered,
    glass,
    graded_world,
    lathe,
    look_at,
    make_circle_of_u,
    material,
    save,
    start_empty,
)

# Brightens towards a warm horizon.
SKY = ((0.0, (0.95, 0.62, 0.36)), (0.12, (0.75, 0.6, 0.52)), (0.35, (0.3, 0.42, 0.6)), (1.0, (0.08, 0.16, 0.36)))
# Radius and height of the control points, from the middle of the foot up the outside, over the rim, and down the inside.
OUTSIDE = (
    (0, 0.05),
    (0.3, 0.05),
    (0.5, 0.0),
    (0.72, 0.0),
    (0.8, 0.1),
    (1.3, 0.75),
    (1.25, 1.6),
    (0.55, 2.15),
    (0.38, 2.7),
)
RIM = ((0.5, 3.15), (0.86, 3.34), (0.9, 3.42), (0.84, 3.44))
INSIDE = ((0.42, 3.2), (0.28, 2.7), (0.46, 2.1), (1.12, 1.56), (1.16, 0.82), (0.7, 0.3), (0.3, 0.24), (0, 0.24))


def add_vase() -> None:
    """The shell: outside, rim and inside in one surface whose ends meet the axis."""
    vase = add_surface("vase", (0, 0, 0.001))
    spline = add_grid(vase, lathe(np.array(OUTSIDE + RIM + INSIDE)), resolution=6)
    make_circle_of_u(spline)
    spline.use_endpoint_v = True
    spline.order_v = 4
    vase.data.materials.append(glass("green glass", (0.8, 0.97, 0.9), 1.5))


def add_marbles() -> None:
    """Three small balls of NURBS: more glass, gold and chalk."""
    places = (
        ((1.75, -0.75, 0.32), 0.32, glass("clear glass", (1, 1, 1), 1.5)),
        ((-1.5, -1.0, 0.26), 0.26, material("gold", (1.0, 0.66, 0.24), 0.12, Metallic=1.0)),
        ((1.1, -1.6, 0.2), 0.2, material("chalk", (0.75, 0.16, 0.1), 0.6)),
    )
    for location, radius, look in places:
        bpy.ops.surface.primitive_nurbs_surface_sphere_add(radius=radius, location=location)
        ball = bpy.context.object
        ball.name = ball.data.name = f"ball of {look.name}"
        ball.data.materials.append(look)


def main() -> None:
    start_empty(width=540, height=640, samples=40)
    add_vase()
    add_marbles()
    checks = checkered("table", (0.72, 0.66, 0.56), (0.06, 0.1, 0.12), 1.6, 0.35)
    add_floor("table", (-9, -6), (9, 12), checks)
    graded_world("evening", SKY, 0.6)
    key = add_lamp("window", "AREA", (-3.6, -1.0, 4.4), (0, 0, 1.2), 320, (1.0, 0.93, 0.84))
    key.data.shape, key.data.size, key.data.size_y = "RECTANGLE", 2.2, 3.0
    rim = add_lamp("back", "AREA", (3.4, 3.6, 3.4), (0, 0, 1.6), 160, (0.75, 0.86, 1.0))
    rim.data.shape, rim.data.size = "DISK", 1.8
    camera = add_camera((0.6, -7.6, 3.1), (0.12, 0, 1.42), 50)
    look_at(camera, (0.12, 0, 1.42))
    save("glass_vase")


main()
