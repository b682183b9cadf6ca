"""Stereoscopic frames by `rayleaf render`: the files of their views, at once and from parts."""

from pathlib import Path

import numpy as np
import plain_exr

RENDER = (Path(__file__).resolve().parents[2] / "python_addon" / "render_file.py").as_posix()

SCRIPT = f"""
import json, runpy, sys
import bpy
import scenes
folder, views_format, *orders = sys.argv[1:]
bpy.ops.wm.read_factory_settings()
import addon_utils
addon_utils.enable("rayleaf")
from rayleaf import versions
scene = bpy.context.scene
scene.render.engine = "RAYLEAF"
scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 32, 24, 100
scene.rayleaf.samples = 4
scene.render.use_multiview = True
scene.camera.data.stereo.interocular_distance = 0.5
bpy.context.view_layer.use_pass_z = True
settings = scene.render.image_settings
versions.choose_file_format(settings, "OPEN_EXR_MULTILAYER")
settings.exr_codec = "NONE"
if views_format == "STEREO_3D":
    versions.choose_file_format(settings, "PNG")
settings.views_format = views_format
bpy.ops.wm.save_as_mainfile(filepath=folder + "/file.blend")
for order in orders:
    sys.argv = ["render", "--", "--output", folder + "/" + order.split()[0], *order.split()[1:]]
    runpy.run_path({RENDER!r}, run_name="__main__")
"""


def test_parts_of_all_views_put_together_are_the_frame(run_blender, tmp_path):
    parts = [f"cut --tile {i}/2 --sample-range {j}/2" for i in (1, 2) for j in (1, 2)]
    run_blender(SCRIPT, tmp_path, "INDIVIDUAL", f"whole --stats {tmp_path}/stats.json", *parts, "cut --merge")
    whole, merged = (plain_exr.read(tmp_path / f"{name}.exr") for name in ("whole", "cut"))
    assert set(merged) == set(whole)
    for name, pixels in whole.items():
        np.testing.assert_array_equal(merged[name], pixels, err_msg=name)
    views = [whole[f"ViewLayer.Depth.{view}.Z"] for view in ("left", "right")]
    assert (views[0] != views[1]).any()
    pictures = sorted(path.name for path in tmp_path.glob("*.png"))
    assert pictures == ["cut_L.png", "cut_R.png", "whole_L.png", "whole_R.png"]
    assert '"view": "left"' in (tmp_path / "stats.json").read_text()


def test_both_eyes_in_one_picture_are_one_file(run_blender, tmp_path):
    run_blender(SCRIPT, tmp_path, "STEREO_3D", "whole")
    assert [path.name for path in tmp_path.glob("*.png")] == ["whole.png"]
    assert (tmp_path / "whole.exr").is_file()
