"""The pixels' way into Blender's render result, seen with a stand-in for the core whose pixels say where they belong."""

import json

import numpy as np
import plain_exr
import pytest

WIDTH, HEIGHT = 40, 30
SETUP = f"""
import sys, bpy, recording_core, scenes
core = recording_core.install()
scene = bpy.context.scene
render = scene.render
render.engine = "RAYLEAF"
render.resolution_x, render.resolution_y, render.resolution_percentage = {WIDTH}, {HEIGHT}, 100
scenes.write_layers()
render.filepath = sys.argv[1]
"""
RENDER = "\nbpy.ops.render.render(write_still=True)\n"


def expected(width, height, channel, x=0, y=0):
    """What the stand-in renders into a channel."""
    columns, rows = np.arange(x, x + width), np.arange(y, y + height)
    return (columns[None, :] + 1000 * rows[:, None] + 1_000_000 * channel).astype(np.float32)


def test_every_pass_arrives_with_all_its_channels_upright(run_blender, tmp_path):
    path = tmp_path / "all.exr"
    script = """
from rayleaf import passes
for entry in passes.table():
    if entry.switch and not entry.is_hidden:
        setattr(*entry.place(bpy.context.view_layer), True)
report(passes=[[entry.name, entry.channels] for entry in passes.table() if not entry.is_hidden])
"""
    run = run_blender(SETUP + script + RENDER, path)
    picture = plain_exr.read(path)
    for name, channels in run.report["passes"]:
        for index, letter in enumerate(channels):
            values = picture[f"ViewLayer.{name}.{letter}"]
            assert np.array_equal(values, expected(WIDTH, HEIGHT, index)), (name, letter)


def test_a_pass_of_blender_that_rayleaf_lacks_takes_no_room(run_blender, tmp_path):
    path = tmp_path / "shadow.exr"
    run_blender(SETUP + "bpy.context.view_layer.use_pass_shadow = True" + RENDER, path)
    assert set(plain_exr.read(path)) == {f"ViewLayer.Combined.{letter}" for letter in "RGBA"}


BORDER = """
render.use_border, render.use_crop_to_border = True, {crop}
render.border_min_x, render.border_max_x = 0.25, 0.75
render.border_min_y, render.border_max_y = 0.5, 0.9
"""


def test_a_cropped_border_gives_that_part_alone(run_blender, tmp_path):
    path = tmp_path / "crop.exr"
    run_blender(SETUP + BORDER.format(crop=True) + RENDER, path)
    picture = plain_exr.read(path)
    assert np.array_equal(picture["ViewLayer.Combined.R"], expected(20, 12, 0, x=10, y=15))


def test_a_border_without_crop_is_placed_in_the_whole_picture(run_blender, tmp_path):
    path = tmp_path / "border.exr"
    run_blender(SETUP + BORDER.format(crop=False) + RENDER, path)
    red = plain_exr.read(path)["ViewLayer.Combined.R"]
    assert red.shape == (HEIGHT, WIDTH)
    assert np.array_equal(red[15:27, 10:30], expected(20, 12, 0, x=10, y=15))
    red[15:27, 10:30] = 0
    assert not red.any()


def test_the_resolution_percentage_and_odd_sizes_agree_with_blenders_result(run_blender, tmp_path):
    path = tmp_path / "half.exr"
    run_blender(SETUP + "render.resolution_x, render.resolution_percentage = 41, 50" + RENDER, path)
    assert np.array_equal(plain_exr.read(path)["ViewLayer.Combined.R"], expected(20, 15, 0))


@pytest.mark.parametrize("border", [(0.013, 0.517, 0.291, 0.849), (0.1, 0.9, 0.3, 0.7), (0.33, 0.345, 0.5, 0.6)])
def test_borders_that_fall_between_pixels_agree_with_blenders_result(run_blender, tmp_path, border):
    path = tmp_path / "between.exr"
    lines = """
render.use_border, render.use_crop_to_border = True, False
render.border_min_x, render.border_max_x, render.border_min_y, render.border_max_y = {}
render.resolution_x, render.resolution_y = 97, 61
""".format(
        border
    )
    run_blender(SETUP + lines + RENDER, path)
    red = plain_exr.read(path)["ViewLayer.Combined.R"]
    rows, columns = np.nonzero(red)
    assert rows.size
    assert np.array_equal(red[rows, columns], (columns + 1000 * rows).astype(np.float32))
    assert np.array_equal(
        np.count_nonzero(red), (np.ptp(rows) + 1) * (np.ptp(columns) + 1) - (rows.min() + columns.min() == 0)
    )


def test_each_view_layer_gets_its_own_passes_and_its_own_objects(run_blender, tmp_path):
    path, stats = tmp_path / "layers.exr", tmp_path / "stats.jsonl"
    script = """
first = bpy.context.view_layer
second = scene.view_layers.new("Second")
first.use_pass_z, second.use_pass_normal = True, True
hidden = bpy.data.collections.new("Hidden in the second")
scene.collection.children.link(hidden)
bpy.ops.mesh.primitive_cube_add()
cube = bpy.context.object
hidden.objects.link(cube)
for collection in list(cube.users_collection):
    if collection != hidden:
        collection.objects.unlink(cube)
second.layer_collection.children[hidden.name].exclude = True
"""
    run_blender(SETUP + script + RENDER, path, env={"RAYLEAF_STATS": str(stats)})
    picture = plain_exr.read(path)
    assert {"ViewLayer.Depth.Z", "Second.Normal.X"} <= set(picture)
    assert not {"ViewLayer.Normal.X", "Second.Depth.Z"} & set(picture)
    first, second = [json.loads(line) for line in stats.read_text().splitlines()]
    assert (first["view_layer"], second["view_layer"]) == ("ViewLayer", "Second")
    assert first["export"]["instances"] == second["export"]["instances"] + 1


def test_each_frame_of_an_animation_is_rendered_with_that_frames_scene(run_blender, tmp_path):
    stats = tmp_path / "stats.jsonl"
    script = """
scene.frame_start, scene.frame_end = 3, 5
cube = bpy.data.objects["Cube"]
for frame in (3, 5):
    cube.location.x = frame
    cube.keyframe_insert("location", index=0, frame=frame)
from rayleaf.versions import animation_curves
for curve in animation_curves(cube):
    for point in curve.keyframe_points:
        point.interpolation = "LINEAR"
bpy.ops.render.render(animation=True)
report(places=[d.instances["matrices"][0][0][3] for d in recording_core.RECORDED])
"""
    run = run_blender(SETUP + script, tmp_path / "frame_####.exr", env={"RAYLEAF_STATS": str(stats)})
    assert run.report["places"] == pytest.approx([3, 4, 5])
    assert [json.loads(line)["frame"] for line in stats.read_text().splitlines()] == [3, 4, 5]
    assert len(list(tmp_path.glob("frame_*.exr"))) == 3


def test_the_compositor_finds_a_socket_for_every_pass(run_blender):
    script = """
import bpy, scenes
from rayleaf import passes
scene = bpy.context.scene
scene.render.engine = "RAYLEAF"
for entry in passes.table():
    if entry.switch and not entry.is_hidden:
        setattr(*entry.place(bpy.context.view_layer), True)
tree = scenes.compositor(scene)
bpy.context.view_layer.update()
node = next(node for node in tree.nodes if node.bl_idname == "CompositorNodeRLayers")
report(sockets=[s.name for s in node.outputs if s.enabled], passes=[entry.name for entry in passes.enabled(bpy.context.view_layer)])
"""
    run = run_blender(script)
    sockets = run.report["sockets"]
    assert "Image" in sockets
    assert set(run.report["passes"]) - {"Combined"} <= set(sockets)


def test_a_shader_output_with_the_name_of_another_pass_is_left_out_and_the_rest_rendered(run_blender):
    script = """
import bpy
from rayleaf import passes, versions
scene = bpy.context.scene
scene.render.engine = "RAYLEAF"
scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 16, 16, 100
scene.rayleaf.samples, scene.rayleaf.use_denoising = 1, True
layer = bpy.context.view_layer
layer.use_pass_diffuse_direct = True
for name in (versions.pass_name("DiffDir"), "Noisy Image", "Own"):
    layer.aovs.add().name = name
bpy.ops.render.render()  # which fails where Blender is given two passes of one name
report(outputs=list(passes.Slots.of(layer).aovs), left_out=len(passes.Slots.of(layer).left_out))
"""
    assert run_blender(script).report == {"outputs": ["Own"], "left_out": 2}
