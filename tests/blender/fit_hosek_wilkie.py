"""Refines the coefficients of export/hosek_wilkie.py, and prints them. Not a test: to be run by hand, inside Blender, where
SciPy is (python3-scipy): `rayleaf blender --background --python tests/blender/fit_hosek_wilkie.py`.

For each turbidity, albedo and channel of XYZ the formula is fitted to skies of Cycles at thirteen elevations of the sun
together, by relative least squares, and begins with the coefficients that are there. The first ones began with fits of
single elevations, and with those of neighbours.
"""

import math
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))

import bpy  # noqa: E402
import numpy as np  # noqa: E402
import plain_exr  # noqa: E402
import scenes  # noqa: E402
from rayleaf.export.atmosphere import FROM_XYZ  # noqa: E402
from rayleaf.export.hosek_wilkie import POINTS, bernstein  # noqa: E402
from scipy.optimize import least_squares  # noqa: E402

SIZE = 48
ELEVATIONS = np.linspace(0.0, 1.0, 13) ** 3 * 0.5 * math.pi

rows = (np.arange(SIZE) + 0.5) / SIZE * 0.5 * math.pi
columns = ((np.arange(SIZE) + 0.5) / SIZE - 0.5) * 2.0 * math.pi
rows, columns = (each.ravel() for each in np.meshgrid(rows[::2], columns[: SIZE // 2 : 2], indexing="ij"))
cosine = np.tile(np.sin(rows), len(ELEVATIONS))
near = np.sin(rows) * np.sin(ELEVATIONS)[:, None] + np.cos(rows) * np.cos(ELEVATIONS)[:, None] * np.cos(columns)
near = np.clip(near, -1.0, 1.0).ravel()
weights = np.repeat(bernstein(ELEVATIONS), len(rows), axis=0)


def formula(points):
    """The radiance, and its derivatives by the ten coefficients."""
    a, b, c, d, e, f, g, i, h, factor = (weights @ points.reshape(6, 10)).T
    h = np.clip(h, -0.99, 0.99)
    along, angle = cosine + 0.01, np.arccos(near)
    denominator = 1.0 + h * h - 2.0 * h * near
    mie = (1.0 + near**2) / denominator**1.5
    dim, glow = np.exp(np.clip(b / along, -60.0, 20.0)), np.exp(np.clip(e * angle, -60.0, 20.0))
    x, y = 1.0 + a * dim, c + d * glow + f * near**2 + g * mie + i * np.sqrt(cosine)
    by = [dim * y, a * dim / along * y, x, x * glow, x * d * glow * angle, x * near**2, x * mie, x * np.sqrt(cosine)]
    by += [x * g * mie * 3.0 * (near - h) / denominator, x * y / factor]
    return factor * x * y, factor * np.array(by)


def fit(measured, start):
    """Control points, and the error."""

    def residuals(points):
        return formula(points)[0] / measured - 1.0

    def jacobian(points):
        by = formula(points)[1] / measured
        return (weights[:, :, None] * by.T[:, None, :]).reshape(len(measured), 60)

    found = least_squares(residuals, start, jacobian, x_scale="jac", max_nfev=25)
    return found.x, float(np.sqrt(np.mean(found.fun**2)))


def build():
    """A camera that sees all around, from the horizon to the zenith, the sun in the middle; scene and node."""
    scene = scenes.empty_scene()
    camera = scene.camera.data
    camera.type = "PANO"
    scene.camera.rotation_euler = (0.5 * math.pi, 0.0, 0.0)
    for owner in (camera, camera.cycles):  # Blender 5 has them at the camera
        if hasattr(owner, "longitude_min"):
            owner.panorama_type = "EQUIRECTANGULAR"
            owner.latitude_min, owner.latitude_max = 0.0, 0.5 * math.pi
            owner.longitude_min, owner.longitude_max = -math.pi, math.pi
    scene.render.resolution_x = scene.render.resolution_y = SIZE
    scene.cycles.use_adaptive_sampling = scene.cycles.use_denoising = False
    scene.cycles.pixel_filter_type = "BOX"
    scene.cycles.samples, scene.cycles.filter_width = 1, 0.01
    scenes.write_layers()
    scene.world = bpy.data.worlds.new("World")
    scene.world.use_nodes = True
    scene.world.cycles.sampling_method = "NONE"
    tree = scene.world.node_tree
    sky = tree.nodes.new("ShaderNodeTexSky")
    sky.sky_type = "HOSEK_WILKIE"
    tree.links.new(sky.outputs[0], tree.nodes["Background"].inputs["Color"])
    return scene, sky


def turn_to(sky, turbidity, albedo, elevation):
    sky.turbidity, sky.ground_albedo = turbidity, albedo
    sky.sun_direction = (0.0, math.cos(elevation), math.sin(elevation))


def look(scene, path):
    """(rows from the lowest up, columns, rgb)."""
    scene.render.engine, scene.render.filepath = "CYCLES", str(path)
    bpy.ops.render.render(write_still=True)
    channels = plain_exr.read(path)
    return np.stack([channels[f"ViewLayer.Combined.{letter}"] for letter in "RGB"], -1).astype(np.float64)


def measure():
    """(turbidity, albedo, xyz, directions by elevations)."""
    scene, sky = build()
    path = Path(tempfile.mkdtemp()) / "sky.exr"
    result = np.empty((10, 2, 3, len(cosine)))
    for turbidity in range(10):
        for albedo in range(2):
            seen = []
            for elevation in ELEVATIONS:
                turn_to(sky, turbidity + 1.0, albedo, elevation)
                rgb = look(scene, path)[::2, : SIZE // 2 : 2].reshape(-1, 3)
                seen.append(rgb @ np.linalg.inv(FROM_XYZ).T)
            result[turbidity, albedo] = np.concatenate(seen).T
    return result


def main():
    measured, worst = measure(), 0.0
    for which in np.ndindex(10, 2, 3):
        points, error = fit(measured[which], POINTS[which].ravel())
        worst = max(worst, error)
        print(" ".join(f"{each:.5g}" for each in points))
    print("largest root mean square of a relative error:", worst, file=sys.stderr)


main()
