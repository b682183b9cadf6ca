"""Previews of materials, worlds and lamps in Blender's real window, as icons show them."""

import pytest
from test_window import TOOLS, window  # noqa: F401: a fixture

pytestmark = pytest.mark.skipif(bool(TOOLS), reason=f"not installed: {', '.join(TOOLS)}")

PREVIEWS = """
import numpy as np

shader = bpy.data.objects["Cube"].data.materials[0].node_tree.nodes["Principled BSDF"]
blocks = [bpy.data.objects["Cube"].data.materials[0], scene.world, bpy.data.objects["Light"].data]
scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.1, 0.3, 0.8, 1)

def pixels(block):
    "Of a finished preview; None before."
    preview = block.preview
    if preview is None or preview.image_size[0] == 0:
        return None
    values = np.array(preview.image_pixels_float[:], np.float32).reshape(-1, 4)
    return values if values.any() else None

def made(block, before=None):
    values = pixels(block)
    return values is not None and (before is None or not np.array_equal(values, before))

def steps():
    yield 0.5
    for block in blocks:
        block.asset_generate_preview()
        yield lambda: made(block)
    grey = pixels(blocks[0])
    shader.inputs["Base Color"].default_value = (0.8, 0.05, 0.05, 1)
    blocks[0].asset_generate_preview()
    yield lambda: made(blocks[0], grey)
    yield 0.5
    red, world, lamp = map(pixels, blocks)
    from rayleaf import preview
    report(red=(red - grey).mean(axis=0).tolist(), world=world.mean(axis=0).tolist(), lamp=float(lamp.std()),
           kept=len(preview._parts), told=rayleaf.last_statistics)

import rayleaf
drive(steps())
"""


def test_materials_worlds_and_lamps_have_previews(window):  # noqa: F811
    run = window(PREVIEWS, size="640x480")
    assert "Traceback" not in run.log
    red, green, blue, _ = run.report["red"]
    assert green < -0.02 and blue < -0.02 and red > green + 0.02  # the material is redder than it was
    red, green, blue, _ = run.report["world"]
    assert blue > green > red
    assert run.report["lamp"] > 0.005  # light and shadow
    assert run.report["kept"] >= 1
    assert run.report["told"] == {}  # a preview is no render that statistics are asked of
