"""Rendered shading where Blender says less than has changed, where an update fails, and while a final render runs."""

import pytest
from test_viewport import COMPARE, SMALL, VIEW, check
from test_window import TOOLS, window  # noqa: F401: a fixture

pytestmark = pytest.mark.skipif(bool(TOOLS), reason=f"not installed: {', '.join(TOOLS)}")

# What an edit of nodes asks for beside what was exported, what follows a control, another pass, and Edit Mode.
HIDDEN_CHANGES = """
import bmesh

scene.render.preview_pixel_size = "4"
cube, lamp = bpy.data.objects["Cube"], bpy.data.objects["Light"]
tree = cube.data.materials[0].node_tree
color = tree.nodes["Principled BSDF"].inputs["Base Color"]
control = bpy.data.objects.new("control", None)
scene.collection.objects.link(control)
cube.parent = lamp.parent = control

def follow(block, path, expression, *index):
    driver = block.driver_add(path, *index).driver
    variable = driver.variables.new()
    variable.name, variable.type = "x", "TRANSFORMS"
    variable.targets[0].id, variable.targets[0].transform_type = control, "LOC_X"
    driver.type, driver.expression = "SCRIPTED", expression

def link(kind, output):
    node = tree.nodes.new(kind)
    tree.links.new(node.outputs[output], color)
    return node

def uv_of_a_map():
    link("ShaderNodeUVMap", "UV").uv_map = "UVMap"

def driven_color():
    link("ShaderNodeObjectInfo", "Color")
    follow(cube, "color", "x", 1)

def move_what_drives_it():
    control.location.x = 0.4

def property_of_the_object():
    cube.driver_remove("color")
    node = link("ShaderNodeAttribute", "Vector")
    node.attribute_type, node.attribute_name = "OBJECT", "location"

def move_it():
    cube.location.z = 0.6

def property_of_the_scene():
    scene["tint"] = (0.1, 0.6, 0.9)
    node = link("ShaderNodeAttribute", "Color")
    node.attribute_type, node.attribute_name = "VIEW_LAYER", "tint"

def change_it():
    scene["tint"] = (0.9, 0.2, 0.1)
    scene.update_tag()

def driven_lamp():
    follow(lamp, "hide_viewport", "x > 1")
    lamp.data.energy *= 2

def move_what_hides_it():
    control.location.x = 1.5

def pass_of_coordinates():
    space.shading.rayleaf.render_pass = "uv"

def edit_mode():
    window = bpy.context.window_manager.windows[0]
    region = next(region for region in area.regions if region.type == "WINDOW")
    with bpy.context.temp_override(window=window, area=area, region=region):
        bpy.ops.object.mode_set(mode="EDIT")
    edited = bmesh.from_edit_mesh(cube.data)
    edited.verts.ensure_lookup_table()
    edited.verts[0].co.x += 1
    bmesh.update_edit_mesh(cube.data)

EDITS = [uv_of_a_map, driven_color, move_what_drives_it, property_of_the_object, move_it, property_of_the_scene,
         change_it, driven_lamp, move_what_hides_it, pass_of_coordinates, edit_mode]
"""


def test_a_view_shows_what_blender_does_not_tell(window, tmp_path):  # noqa: F811
    run = window(VIEW + HIDDEN_CHANGES + COMPARE, tmp_path / "hidden.png", 0, 11, size=SMALL)
    assert "Traceback" not in run.log
    assert len(run.report["differences"]) == 11
    check(run.report["differences"])


FAILING = """
from rayleaf.viewport import sync
from rayleaf.viewport import viewport as module
update, draw_texture, drawn = sync.SceneSync.update, module.draw_texture_2d, []

def fail(*_):
    raise RuntimeError("wrong as planned")

def draw(*arguments):
    drawn.append(True)
    draw_texture(*arguments)

def move():
    bpy.data.objects["Cube"].location.x += 0.5

def steps():
    yield 0.3
    module.draw_texture_2d = draw
    switch("RENDERED")
    yield rendered
    sync.SceneSync.update = fail
    move()
    yield 0.3
    drawn.clear()
    area.tag_redraw()
    yield 0.3
    report(problem=viewports()[0]._problem, drawn=len(drawn))
    sync.SceneSync.update = update
    move()
    yield 0.3
    yield rendered
    yield lambda: len(drawn) > 0
    report(later=viewports()[0]._problem)

drive(steps())
"""


def test_an_update_that_fails_shows_why_and_no_old_picture(window):  # noqa: F811
    run = window(VIEW + FAILING, size=SMALL)
    assert "RuntimeError: wrong as planned" in run.report["problem"]
    assert run.report["drawn"] == 0 and run.report["later"] == ""
    assert run.log.count("Traceback") == 1


MEANWHILE = """
preferences.view.render_display_type = "NONE"
render.resolution_x, render.resolution_y = 320, 240
render.threads_mode, render.threads = "FIXED", 1
scene.rayleaf.samples = 512

def steps():
    yield 0.5
    press("F12")
    yield lambda: "init" in times
    yield 0.2
    switch("RENDERED")
    yield lambda: len(viewports()) > 0
    yield 0.5
    report(during=[viewports()[0]._worker._paused, viewports()[0]._worker.picture() is None, "complete" in times])
    yield lambda: "complete" in times
    yield rendered
    report(done=True)

drive(steps())
"""


def test_a_view_that_is_opened_while_a_final_render_runs_waits_for_its_end(window):  # noqa: F811
    run = window(VIEW + MEANWHILE, size=SMALL)
    assert "Traceback" not in run.log
    assert run.report == {"during": [True, True, False], "done": True}
