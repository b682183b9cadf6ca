"""The files of many textures: they are open all at the same time."""

import os
import resource
import subprocess
import sys
from pathlib import Path

import pytest

# Three hundred small quads, each with a picture of one colour of its own, that many threads look up at once. With few
# descriptors a process keeps none for most of them.
CODE = """
import resource, sys
descriptors = int(sys.argv[1])
resource.setrlimit(resource.RLIMIT_NOFILE, (descriptors, resource.getrlimit(resource.RLIMIT_NOFILE)[1]))
import numpy as np
import scenes
from rayleaf import _core as core

SIDE = 18
scene = core.SceneDescription()
square = scenes.quad(scene, "square", size=0.5)
colors = np.random.default_rng(0).integers(1, 256, (SIDE, SIDE, 3)) / 256
for row in range(SIDE):
    for column in range(SIDE):
        pixels = np.broadcast_to(colors[row, column], (70, 70, 3)).astype(np.float32)
        name = f"{row} {column}"
        image = scene.add_image_pixels(name, np.ascontiguousarray(pixels), "LINEAR")
        program = core.Program(name)
        color = program.operation("image", [program.operation("position")], [image, 0, 0])
        program.operation("emission", [program.constant(1, 1, 1, 1), color, program.constant(1, 1, 1, 1)])
        materials = scene.add_material_list([scene.add_material(name, program)])
        place = scenes.matrix((column - SIDE / 2 + 0.5, row - SIDE / 2 + 0.5, 0))
        scene.add_instance(name, square, place, materials)
half = SIDE / 2
scene.set_camera("ORTHOGRAPHIC", scenes.matrix((0, 0, 5)), (-half, -half), (half, half), 0.01, 100.0)
size = 4 * SIDE
picture = scenes.render(core, scene, width=size, height=size, samples=4, threads=16)["combined"]
shown = picture[2::4, 2::4, :3]
assert np.allclose(shown, colors, atol=2e-3), np.abs(shown - colors).max()
"""


@pytest.mark.parametrize("descriptors", (32, 1024))
def test_threads_that_look_up_hundreds_of_files_do_not_wait_for_each_other(addons, descriptors):
    if resource.getrlimit(resource.RLIMIT_NOFILE)[1] < descriptors:
        pytest.skip("not so many descriptors on this machine")
    environment = os.environ | {"PYTHONPATH": f"{addons}:{Path(__file__).parent}"}
    done = subprocess.run(
        [sys.executable, "-c", CODE, str(descriptors)], env=environment, timeout=60, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
