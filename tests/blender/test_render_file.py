"""`rayleaf render` on files whose pictures are not those of the open scene's view layers."""

import json
from pathlib import Path

import pytest

RENDER = (Path(__file__).resolve().parents[2] / "python_addon" / "render_file.py").as_posix()

SCRIPT = f"""
import runpy, sys
import bpy, scenes
folder, kind, *orders = sys.argv[1:]
scene = bpy.context.scene
scene.render.engine = "RAYLEAF"
scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 32, 24, 100
scene.rayleaf.samples = 1
other = scene.copy()
other.name, other.view_layers[0].name = "Other", "Shot"

def strips():
    editor = scene.sequence_editor_create()
    return editor.strips if hasattr(editor, "strips") else editor.sequences

def color_strip():
    strips().new_effect("colour", "COLOR", 1, frame_start=1, **{{"length" if bpy.app.version >= (5, 0, 0) else "frame_end": 9}})

def scene_strip():
    strips().new_scene("shot", other, 1, 1)

tree = scenes.compositor(scene)
node = next(node for node in tree.nodes if node.bl_idname == "CompositorNodeRLayers")
shown = scenes.compositor_output(tree).inputs[0]
tree.links.new(node.outputs["Image"], shown)

def other_scene():
    node.scene, node.layer = other, "Shot"

def without_layers():
    tree.nodes.remove(node)
    tree.links.new(tree.nodes.new("CompositorNodeRGB").outputs[0], shown)

def failing():
    other_scene()
    from rayleaf import engine
    def fail(*_):
        raise RuntimeError("as planned")
    engine.core_module.load = fail

globals()[kind]()
bpy.ops.wm.save_as_mainfile(filepath=folder + "/file.blend")
for order in orders:
    sys.argv = ["render", "--", "--output", folder + "/" + order.split()[0], *order.split()[1:]]
    runpy.run_path({RENDER!r}, run_name="__main__")
"""


@pytest.mark.parametrize(
    ("kind", "layers"),
    [("other_scene", ["Shot"]), ("scene_strip", ["Shot"]), ("color_strip", []), ("without_layers", [])],
)
def test_a_picture_that_is_made_of_something_else_is_written(run_blender, tmp_path, kind, layers):
    run_blender(SCRIPT, tmp_path, kind, f"a --stats {tmp_path}/stats.json")
    (frame,) = json.loads((tmp_path / "stats.json").read_text())["frames"]
    assert [layer["view_layer"] for layer in frame["view_layers"]] == layers
    assert (tmp_path / "a.png").is_file() and (tmp_path / "a.exr").is_file()


def test_parts_of_another_scenes_picture_are_put_together(run_blender, tmp_path):
    run_blender(SCRIPT, tmp_path, "other_scene", "a --tile 1/2", "a --tile 2/2", "a --merge")
    assert (tmp_path / "a.png").is_file() and not (tmp_path / "a.parts").exists()


def test_a_layer_that_fails_is_named_and_what_has_no_parts_is_refused(run_blender, tmp_path):
    run = run_blender(SCRIPT, tmp_path, "failing", "a", check=False)
    assert run.code != 0 and "as planned" in run.log
    run = run_blender(SCRIPT, tmp_path, "color_strip", "a --tile 1/2", check=False)
    assert run.code != 0 and "it has no parts" in run.log
    assert not (tmp_path / "a.png").exists() and not (tmp_path / "a.parts").exists()
