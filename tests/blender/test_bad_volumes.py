"""Files and grids that are missing or broken are named, Blender lives, and everything else is in the picture."""

import numpy as np
import plain_exr
import pyopenvdb
import pytest
from core.vdb_files import make_grid, write

# A good quad fills the lower half of the picture, the cloud would be in the upper half.
SCRIPT = """
import sys
import bpy, scenes, rayleaf
scene = scenes.half_filled_picture(sys.argv[1], 4)
volume = bpy.data.volumes.new("Cloud")
cloud = scenes.add(volume, "Cloud")
cloud.location, cloud.scale = (0, 0.5, 0), (0.4, 0.4, 0.4)
volume.filepath = sys.argv[2]
material, tree, output = scenes.material("Smoke")
tree.nodes.clear()
smoke, output = tree.nodes.new("ShaderNodeVolumePrincipled"), tree.nodes.new("ShaderNodeOutputMaterial")
smoke.inputs["Density"].default_value = 20
tree.links.new(smoke.outputs[0], output.inputs["Volume"])
volume.materials.append(material)
"""
RENDER = """
bpy.ops.render.render(write_still=True)
report(messages=rayleaf.last_statistics["messages"], left_out=rayleaf.last_statistics["export"]["left_out"])
"""


def ball(x, y, z):
    return np.clip(1.0 - np.sqrt(x * x + y * y + z * z), 0.0, None)


def rendered(run_blender, tmp_path, path, change=""):
    """Messages, what was left out, the means of the good quad and of the alpha above it."""
    run = run_blender(SCRIPT + change + RENDER, tmp_path / "picture.exr", path)
    channels = plain_exr.read(tmp_path / "picture.exr")
    colors = np.stack([channels[name] for name in "RGB"], -1)[2:6, 2:14]
    np.testing.assert_allclose(colors, np.broadcast_to([1, 0.5, 0.25], colors.shape), rtol=1e-3)
    return run.report["messages"], run.report["left_out"], channels["A"][9:].mean()


def only(messages):
    (message,) = messages
    return message


def test_a_good_cloud_is_seen_and_nothing_is_said(run_blender, tmp_path):
    path = write(tmp_path / "cloud.vdb", make_grid("density", ball, 16))
    messages, left_out, alpha = rendered(run_blender, tmp_path, path)
    assert messages == [] and left_out == {} and 0.1 < alpha < 0.9


@pytest.mark.parametrize("content", [None, b"", b"not a volume" * 100], ids=["missing", "empty", "text"])
def test_files_that_are_missing_or_of_another_kind_are_named(run_blender, tmp_path, content):
    path = tmp_path / "cloud.vdb"
    if content is not None:
        path.write_bytes(content)
    messages, left_out, alpha = rendered(run_blender, tmp_path, path)
    message = only(messages)
    assert "Cloud" in message and "cloud.vdb" in message and list(left_out) == ["Cloud"] and alpha == 0.0


def test_an_empty_grid_is_named(run_blender, tmp_path):
    empty = pyopenvdb.FloatGrid()
    empty.name = "density"
    messages, left_out, alpha = rendered(run_blender, tmp_path, write(tmp_path / "cloud.vdb", empty))
    message = only(messages)
    assert "Cloud" in message and "'density'" in message and list(left_out) == ["Cloud"] and alpha == 0.0


def test_a_grid_that_is_absent_is_named_and_the_others_are_seen(run_blender, tmp_path):
    path = write(tmp_path / "cloud.vdb", make_grid("density", ball, 16))
    change = "smoke.inputs['Color Attribute'].default_value = 'hue'\n"
    messages, left_out, alpha = rendered(run_blender, tmp_path, path, change)
    message = only(messages)
    assert "Cloud" in message and "'hue'" in message and left_out == {} and alpha > 0.1
    change = "smoke.inputs['Density Attribute'].default_value = 'fog'\n"
    messages, left_out, alpha = rendered(run_blender, tmp_path, path, change)
    message = only(messages)
    assert "Cloud" in message and "fog" in message and list(left_out) == ["Cloud"] and alpha == 0.0


def test_numbers_that_are_none_are_named_and_the_others_are_seen(run_blender, tmp_path):
    bad = make_grid("density", ball, 16)
    bad.getAccessor().setValueOn((8, 8, 8), float("nan"))
    messages, left_out, alpha = rendered(run_blender, tmp_path, write(tmp_path / "cloud.vdb", bad))
    message = only(messages)
    assert "Cloud" in message and "'density'" in message and "1 " in message and left_out == {} and alpha > 0.1


def test_billions_of_voxels_of_one_value_are_seen_in_little_memory(run_blender, tmp_path):
    vast = pyopenvdb.FloatGrid()
    vast.name = "density"
    vast.fill((0, 0, 0), (1535, 1535, 1535), 1.0)
    vast.transform = pyopenvdb.createLinearTransform(1e-3)
    messages, left_out, alpha = rendered(run_blender, tmp_path, write(tmp_path / "cloud.vdb", vast))
    assert messages == [] and left_out == {} and alpha > 0.1


def test_a_volume_of_which_nothing_is_read_is_named(run_blender, tmp_path):
    path = write(tmp_path / "cloud.vdb", make_grid("density", ball, 16))
    change = "smoke.inputs['Density Attribute'].default_value = ''\n"
    messages, left_out, alpha = rendered(run_blender, tmp_path, path, change)
    assert "Cloud" in only(messages) and list(left_out) == ["Cloud"] and alpha == 0.0


def test_settings_that_are_not_followed_are_named_and_layers_may_hide_volumes(run_blender, tmp_path):
    path = write(tmp_path / "cloud.vdb", make_grid("density", ball, 16))
    change = "import addon_utils; addon_utils.enable('cycles'); material.cycles.volume_interpolation = 'CUBIC'\n"
    messages, left_out, alpha = rendered(run_blender, tmp_path, path, change)
    assert "'Smoke'" in only(messages) and "cubic" in only(messages) and left_out == {} and alpha > 0.1
    messages, left_out, alpha = rendered(run_blender, tmp_path, path, "bpy.context.view_layer.use_volumes = False\n")
    assert messages == [] and left_out == {} and alpha == 0.0
