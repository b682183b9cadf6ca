"""Prints hashes of pictures whose rays run in packets through many instances. Usage: processor_pictures.py ADDONS_FOLDER."""

import hashlib
import sys

import numpy as np

sys.path.insert(0, sys.argv[1])
import path_scenes  # noqa: E402
from rayleaf import _core as core  # noqa: E402
from scenes import matrix, sphere_spline  # noqa: E402

rng = np.random.default_rng(5)
scene = path_scenes.varied_scene(core)
corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], np.float32)
triangles = rng.permuted(np.tile(np.arange(8, dtype=np.int32), (9, 1)), axis=1)[:, :3].copy()
shapes = [scene.add_mesh("tatters", corners, triangles), scene.add_surface("small ball", [sphere_spline(core)])]
materials = path_scenes.material(core, scene, ("diffuse", 0.6, 0.5), ("glossy", 0.4, 0.9, 0.3, "GGX"), name="lacquer")
for number in range(40):
    place = matrix(rng.uniform((-1.5, -1.5, 0), (1.5, 1.5, 1)), rng.uniform(0.05, 0.2))
    scene.add_instance(f"body {number}", shapes[number % 2], place, materials)
for megabytes in (-1.0, 0.0):  # facets in memory; all through the cache
    pixels = path_scenes.picture(core, scene, width=40, height=24, samples=2, resident_megabytes=megabytes)
    assert np.isfinite(pixels).all() and pixels.std() > 0.01, "nothing to see"
    print(hashlib.sha256(pixels.tobytes()).hexdigest())
