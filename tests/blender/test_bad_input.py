"""What cannot be rendered is named, Blender lives, and everything else is in the picture."""

import json

import numpy as np
import plain_exr
import pytest

# A good quad fills the lower half of the picture, the bad thing would be in the upper half.
SCENE = """
import sys, math
import bpy, scenes, rayleaf
scene = scenes.half_filled_picture(sys.argv[1], 1)
render = scene.render
nan, inf = math.nan, math.inf

def bad_mesh(vertices, faces=[(0, 1, 2)]):
    return scenes.mesh(vertices, faces, "Bad")

def bad_surface(change):
    item = scenes.surface("Bad")
    for point in item.data.splines[0].points:
        point.co.x, point.co.y = point.co.x / 4, point.co.y / 4 + 0.5
    change(item.data.splines[0].points[5])
    return item

def raw(point, *values):
    "Set what a single assignment would clamp."
    points = point.id_data.splines[0].points
    everything = [x for each in points for x in each.co]
    everything[20:24] = values
    points.foreach_set("co", everything)

def shaded(name="Bad"):
    "A quad in the upper half, its material's tree and output."
    item = scenes.mesh([(-1, 0, 0), (1, 0, 0), (1, 1, 0), (-1, 1, 0)], [(0, 1, 2, 3)], "Quad")
    item.data.uv_layers.new()
    material, tree, output = scenes.material(name)
    item.data.materials.append(material)
    shader = tree.nodes.new("ShaderNodeEmission")
    tree.links.new(shader.outputs[0], output.inputs["Surface"])
    return tree, shader
"""
RENDER = """
bpy.ops.render.render(write_still=True)
report(messages=rayleaf.last_statistics["messages"], completed=rayleaf.last_statistics["completed"],
       left_out=rayleaf.last_statistics["export"]["left_out"])
"""

LEFT_OUT = {
    "a vertex that is not a number": "bad_mesh([(0, 0, 0), (nan, 0, 0), (0, 1, 0)])",
    "a vertex at infinity": "bad_mesh([(0, 0, 0), (1, 0, 0), (0, inf, 0)])",
    "a mesh without faces": "bad_mesh([(0, 0, 0), (1, 0, 0)], [])",
    "a mesh without vertices": "bad_mesh([], [])",
    "a control point that is not a number": "bad_surface(lambda point: raw(point, nan, 0, 0, 1))",
    "a control point at infinity": "bad_surface(lambda point: raw(point, 0, -inf, 0, 1))",
    "a weight of zero": "bad_surface(lambda point: setattr(point, 'co', (0, 0, 0, 0)))",
    "a negative weight": "bad_surface(lambda point: setattr(point, 'co', (0, 0, 0, -1)))",
    "a surface without splines": "scenes.add(bpy.data.curves.new('Bad', 'SURFACE'), 'Bad')",
    "a spline of one point": "scenes.add(bpy.data.curves.new('Bad', 'SURFACE'), 'Bad').data.splines.new('NURBS')",
    "a scale of zero": "bad_mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0)]).scale = (1, 0, 1)",
    "a place that is not a number": "bad_mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0)]).location.x = nan",
    "a lamp of infinite power": "scenes.add(bpy.data.lights.new('Bad', 'POINT'), 'Bad').data.energy = inf",
}


def check_good_half(path):
    """The good quad shines in the lower half."""
    picture = plain_exr.read(path)
    lower = np.stack([picture[channel][1:7, 1:15] for channel in "RGB"], axis=-1)
    assert np.allclose(lower, [1, 0.5, 0.25], atol=1e-5)
    assert all(np.isfinite(values).all() for values in picture.values())
    return picture


EVERY_CASE = """
import json, sys
import bpy, rayleaf
scene_text, cases, folder = open(sys.argv[1]).read(), json.load(open(sys.argv[2])), sys.argv[3]
for number, line in enumerate(cases.values()):
    sys.argv[1] = f"{folder}/{number}.exr"
    exec(scene_text + line)
    bpy.ops.render.render(write_still=True)
    report(**{str(number): [rayleaf.last_statistics["messages"], rayleaf.last_statistics["completed"]]})
"""


def test_what_cannot_be_rendered_is_left_out_by_name(run_blender, tmp_path):
    scene, cases = tmp_path / "scene.txt", tmp_path / "cases.json"
    scene.write_text(SCENE)
    cases.write_text(json.dumps(LEFT_OUT))
    run = run_blender(EVERY_CASE, scene, cases, tmp_path)
    for number, name in enumerate(LEFT_OUT):
        picture = check_good_half(tmp_path / f"{number}.exr")
        assert not picture["A"][9:].any(), name
        texts, completed = run.report[str(number)]
        assert completed, name
        assert len(texts) == 1 and "'Bad'" in texts[0] and "left out" in texts[0], (name, texts)
        assert texts[0] in run.log


def test_one_bad_spline_does_not_take_the_others_with_it(run_blender, tmp_path):
    path = tmp_path / "picture.exr"
    lines = """
item = bad_surface(lambda point: None)
bpy.context.view_layer.objects.active = item
bpy.ops.object.mode_set(mode="EDIT")
bpy.ops.surface.primitive_nurbs_surface_surface_add(location=(0, -5, 0))
bpy.ops.object.mode_set(mode="OBJECT")
item.data.splines[1].points[0].co.w = -1
"""
    run = run_blender(SCENE + lines + RENDER, path)
    assert check_good_half(path)["A"][11:13, 7:9].any()  # one sample a pixel may fall beside it
    (text,) = run.report["messages"]
    assert "'Bad', spline 2" in text and "left out" in text
    assert run.report["left_out"] == {}


def test_a_missing_image_is_pink_and_named_once_with_its_path(run_blender, tmp_path):
    path = tmp_path / "picture.exr"
    lines = """
tree, shader = shaded()
picture = bpy.data.images.new("Lost", 4, 4)
picture.source, picture.filepath = "FILE", "/nowhere/lost.png"
for socket in ("Color", "Strength"):
    node = tree.nodes.new("ShaderNodeTexImage")
    node.image = picture
    tree.links.new(node.outputs["Alpha" if socket == "Strength" else "Color"], shader.inputs[socket])
"""
    run = run_blender(SCENE + lines + RENDER, path)
    picture = check_good_half(path)
    assert [picture[channel][12, 8] for channel in "RGB"] == [1, 0, 1]
    (text,) = run.report["messages"]
    assert "'Lost'" in text and "/nowhere/lost.png" in text


def test_an_image_file_that_is_no_image_is_pink_and_named(run_blender, tmp_path):
    path, broken = tmp_path / "picture.exr", tmp_path / "broken.png"
    broken.write_bytes(b"no picture at all")
    lines = f"""
tree, shader = shaded()
node = tree.nodes.new("ShaderNodeTexImage")
node.image = bpy.data.images.new("Broken", 4, 4)
node.image.source, node.image.filepath = "FILE", {str(broken)!r}
tree.links.new(node.outputs["Color"], shader.inputs["Color"])
"""
    run = run_blender(SCENE + lines + RENDER, path)
    picture = check_good_half(path)
    assert [picture[channel][12, 8] for channel in "RGB"] == [1, 0, 1]
    (text,) = run.report["messages"]
    assert "'Broken'" in text


def test_a_loop_of_nodes_and_values_that_are_not_numbers_let_the_render_go_on(run_blender, tmp_path):
    path = tmp_path / "picture.exr"
    lines = """
tree, shader = shaded("Loop")
a, b = tree.nodes.new("ShaderNodeMath"), tree.nodes.new("ShaderNodeMath")
tree.links.new(a.outputs[0], b.inputs[0])
tree.links.new(b.outputs[0], a.inputs[0])
tree.links.new(a.outputs[0], shader.inputs["Strength"])
other, shader = shaded("No number")
shader.inputs["Strength"].default_value = nan
"""
    run = run_blender(SCENE + lines + RENDER, path)
    check_good_half(path)
    assert sorted(text.split("'")[1] for text in run.report["messages"]) == ["Loop", "No number"]


@pytest.mark.parametrize(
    "line, word",
    [
        (
            "import scenes; scene.camera.name = 'Odd';"
            "scenes.make_panoramic(scene.camera.data, 'EQUIANGULAR_CUBEMAP_FACE')",
            "Odd",
        ),
        ("scene.camera.name = 'Odd'; scene.camera.data.clip_start = scene.camera.data.clip_end = 1", "Camera 'Odd'"),
        ("scene.camera = None", "camera"),
        ("render.resolution_x, render.resolution_percentage = 4, 1", "small"),
    ],
    ids=["panoramic", "clip range", "no camera", "no pixels"],
)
def test_what_stops_a_render_is_an_error_and_the_next_render_works(run_blender, tmp_path, line, word):
    path = tmp_path / "picture.exr"
    lines = """
camera = scene.camera
{}
try:
    bpy.ops.render.render()
    report(error="")
except RuntimeError as error:
    report(error=str(error))
scene.camera, camera.data.type, camera.data.clip_start, camera.data.clip_end = camera, "ORTHO", 0.1, 100
render.resolution_x, render.resolution_percentage = 16, 100
"""
    run = run_blender(SCENE + lines.format(line) + RENDER, path)
    check_good_half(path)
    assert word in run.report["error"]


def test_deep_chains_of_nodes_are_named_and_the_rest_is_rendered(run_blender, tmp_path):
    path = tmp_path / "picture.exr"
    lines = """
tree, shader = shaded("Chain")
last = None
for _ in range(400):
    node = tree.nodes.new("ShaderNodeMath")
    if last:
        tree.links.new(last.outputs[0], node.inputs[0])
    last = node
tree.links.new(last.outputs[0], shader.inputs["Strength"])
"""
    run = run_blender(SCENE + lines + RENDER, path)
    check_good_half(path)
    assert all("'Chain'" in text for text in run.report["messages"])


def test_statistics_are_added_to_the_file_that_the_environment_names(run_blender, tmp_path):
    path, stats = tmp_path / "picture.exr", tmp_path / "stats.jsonl"
    run_blender(SCENE + RENDER + RENDER, path, env={"RAYLEAF_STATS": str(stats)})
    first, second = [json.loads(line) for line in stats.read_text().splitlines()]
    assert first["export"] == second["export"] and first["export"]["instances"] == 1
    assert first["core"]["geometry"]["triangles"] == 2
