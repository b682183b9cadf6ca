"""Renders a small scene that needs every library, and prints its bytes' hash. Usage: render_scene.py ADDONS_FOLDER."""

import hashlib
import sys

import numpy as np

sys.path.insert(0, sys.argv[1])
from rayleaf import _core as core  # noqa: E402

scene = core.SceneDescription()
stripes = np.zeros((64, 64, 3), np.float32)
stripes[:, :32] = (0.1, 0.2, 0.9)
stripes[::3, 32:] = (1.0, 0.5, 0.2)
image = scene.add_image_pixels("stripes", stripes, "LINEAR")
program = core.Program("striped")
one = program.constant(1, 1, 1, 1)
program.operation("emission", [one, program.operation("image", [program.operation("generated")], [image, 0, 0]), one])
striped = scene.add_material_list([scene.add_material("striped", program)])

cube = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], np.float32)
quads = np.array([0, 1, 3, 2, 4, 6, 7, 5, 0, 4, 5, 1, 2, 3, 7, 6, 0, 2, 6, 4, 1, 5, 7, 3], np.int32)
creases = (np.array([[0, 1]], np.int32), np.array([2.0], np.float32))
cage = core.SubdivisionSurface("cage", cube, np.full(6, 4, np.int32), quads, *creases)
scene.add_instance("cage", scene.add_shape(cage), np.eye(4), striped)
triangle = scene.add_mesh("triangle", 3 * cube[:3], np.array([[0, 1, 2]], np.int32))
scene.add_instance("triangle", triangle, np.eye(4), striped)

camera = np.eye(4)
camera[:3, 3] = (0.2, 0.1, 6.0)
scene.set_camera("PERSPECTIVE", camera, (-0.5, -0.5), (0.5, 0.5), 0.1, 100.0)
session = core.Session(scene, core.Settings(width=48, height=48, samples=8, threads=2))
assert session.render()
pixels = session.pass_pixels("combined")
assert np.isfinite(pixels).all() and pixels[..., :3].std() > 0.1, "nothing to see"
print(hashlib.sha256(pixels.tobytes()).hexdigest())
