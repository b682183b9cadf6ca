"""Makes paper_fish.blend: a red fish folded of Bezier patches hangs by a thread over blue water, all matte.

After a figure of *Effective curve primitive rendering in ray tracer*.
"""

import sys
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

sys.path.append(str(Path(__file__).resolve().parent))
from scene_curves import add_bezier, add_curve  # noqa: E402
from scene_tools import (  # noqa: E402
    add_camera,
    add_grid,
    add_lamp,
    add_surface,
    bezier_from_cubic_b_spline,
    matte,
    plain_world,
    save,
    start_empty,
)

PLEATS = 7  # of a fin


def add_patches(surface: Any, points: NDArray[np.float64]) -> None:
    """Append bicubic Bezier patches, (3 m + 1, 3 n + 1, 3) control points."""
    weights = np.ones((*points.shape[:2], 1))
    spline = add_grid(surface, np.concatenate([points, weights], axis=2), resolution=6)
    for direction in "uv":
        for flag in ("endpoint", "bezier"):
            setattr(spline, f"use_{flag}_{direction}", True)
        setattr(spline, f"order_{direction}", 4)


def side(sign: float) -> NDArray[np.float64]:
    """One side of the body, two patches long, from the mouth to the root of the tail; the sides meet in creases above and below."""
    x = np.array([-1.7, -1.35, -0.9, -0.35, 0.2, 0.7, 1.0])
    half_height = np.array([0.06, 0.5, 0.78, 0.78, 0.78, 0.36, 0.16])
    bulge = np.array([0.02, 0.3, 0.55, 0.52, 0.5, 0.2, 0.05])
    rows = []
    for height, depth in ((-1, 0), (-0.55, 1), (0.55, 1), (1, 0)):
        rows.append(np.stack([x, sign * depth * bulge, height * half_height + 0.05 * np.cos(1.6 * x)], axis=1))
    return np.stack(rows)


def fan(root: NDArray[np.float64], tip: NDArray[np.float64], depth: float) -> NDArray[np.float64]:
    """A pleated fin between two edges (4, 3 each): the root is flat, the tip is folded to and fro."""
    share = np.linspace(0, 1, 3 * PLEATS + 1)
    zigzag = depth * np.abs((share * PLEATS + 1) % 2 - 1) - depth / 2
    rows = []
    for along in np.linspace(0, 1, 4):
        edge_root = np.array([np.interp(share, np.linspace(0, 1, 4), root[:, axis]) for axis in range(3)]).T
        edge_tip = np.array([np.interp(share, np.linspace(0, 1, 4), tip[:, axis]) for axis in range(3)]).T
        row = edge_root * (1 - along) + edge_tip * along
        row[:, 1] += zigzag * along
        rows.append(row)
    return np.stack(rows)


def add_fish(red: Any) -> Any:
    """Body and fins, in one object."""
    fish = add_surface("fish", (0, 0, 1.75))
    for sign in (-1.0, 1.0):
        add_patches(fish, side(sign))
    tail_root = np.array([(0.98, 0, -0.16), (1.0, 0, -0.05), (1.0, 0, 0.05), (0.98, 0, 0.16)])
    tail_tip = np.array([(1.75, 0, -0.8), (1.55, 0, -0.25), (1.55, 0, 0.25), (1.75, 0, 0.8)])
    add_patches(fish, fan(tail_root, tail_tip, 0.22))
    back_root = np.array([(-0.75, 0, 0.72), (-0.45, 0, 0.77), (0.0, 0, 0.76), (0.35, 0, 0.62)])
    back_tip = np.array([(-0.5, 0, 1.12), (-0.1, 0, 1.32), (0.4, 0, 1.26), (0.75, 0, 0.9)])
    add_patches(fish, fan(back_root, back_tip, 0.14))
    belly_root = np.array([(-0.35, 0, -0.74), (-0.2, 0, -0.74), (0.0, 0, -0.73), (0.2, 0, -0.68)])
    belly_tip = np.array([(-0.1, 0, -1.08), (0.1, 0, -1.12), (0.3, 0, -1.06), (0.5, 0, -0.9)])
    add_patches(fish, fan(belly_root, belly_tip, 0.1))
    fish.data.materials.append(red)
    return fish


def add_eyes(fish: Any) -> None:
    """A white ring of thread and a black bead on either side."""
    white, black = matte("white", (0.85, 0.85, 0.82)), matte("black", (0.02, 0.02, 0.02))
    for name, y in (("left", -0.33), ("right", 0.33)):
        ring = add_curve(f"{name} eye", (-1.12, y, 0.2), bevel_depth=0.035)
        circle = [(0.12 * np.cos(a), 0, 0.12 * np.sin(a)) for a in np.arange(4) * np.pi / 2]
        add_bezier(ring, circle, use_cyclic_u=True)
        ring.data.materials.append(white)
        bpy.ops.surface.primitive_nurbs_surface_sphere_add(radius=0.085, location=(-1.12, y * 0.97, 0.2))
        bead = bpy.context.object
        bead.name = bead.data.name = f"{name} bead"
        bead.data.materials.append(black)
        for thing in (ring, bead):
            thing.parent = fish


def water() -> NDArray[np.float64]:
    """A sheet of gentle waves."""
    x, y = np.meshgrid(np.linspace(-14, 14, 23), np.linspace(-10, 22, 23))
    z = 0.11 * np.sin(1.1 * x + 0.4 * y) + 0.09 * np.cos(1.3 * y - 0.5 * x)
    control = np.stack([x, y, z], axis=2)
    return bezier_from_cubic_b_spline(bezier_from_cubic_b_spline(control, 0), 1)


def main() -> None:
    start_empty(width=640, height=560, samples=48)
    fish = add_fish(matte("red paper", (0.72, 0.07, 0.05)))
    add_eyes(fish)
    thread = add_curve("thread", (0, 0, 0), bevel_depth=0.012)
    add_bezier(thread, [(0.0, 0, 1.2), (0.12, 0.03, 2.6), (-0.05, 0, 5.0)])
    thread.data.materials.append(matte("thread", (0.8, 0.78, 0.7)))
    thread.parent = fish
    fish.rotation_euler = (0.06, -0.1, 0.5)
    sea = add_surface("water")
    add_patches(sea, water())
    sea.data.materials.append(matte("blue", (0.06, 0.2, 0.55)))
    plain_world((0.62, 0.74, 0.95), 0.45)
    add_lamp("sun", "SUN", (-4, -5, 8), (0, 0, 0), 2.6, (1.0, 0.93, 0.82)).data.angle = 0.03
    add_camera((-0.6, -7.6, 3.3), (0.08, 0, 1.72), 46)
    save("paper_fish")


main()
