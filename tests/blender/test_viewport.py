"""Rendered shading in Blender's real window: what it shows after edits, camera moves, and switches of shading."""

import pytest
from test_window import TOOLS, window  # noqa: F401: a fixture

pytestmark = pytest.mark.skipif(bool(TOOLS), reason=f"not installed: {', '.join(TOOLS)}")

SMALL = "640x480"
VIEW = """
import numpy as np

scene.rayleaf.preview_samples = 2
scene.rayleaf.max_bounces = 2
area = next(area for area in bpy.context.screen.areas if area.type == "VIEW_3D")
space = area.spaces[0]

def viewports():
    from rayleaf import engine
    return list(engine._VIEWPORTS.values())

def shown():
    "The finished picture of the view, or None."
    for viewport in viewports():
        picture = viewport._drawn
        if picture is not None and picture.samples == scene.rayleaf.preview_samples and viewport._worker.is_idle():
            return picture.pixels
    return None

def switch(kind):
    space.shading.type = kind

def rendered():
    area.tag_redraw()
    return shown() is not None
"""

EDITS = """
def material(color):
    made = bpy.data.materials.new("plain")
    made.use_nodes = True
    made.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = (*color, 1)
    return made

cube = bpy.data.objects["Cube"]
bpy.ops.surface.primitive_nurbs_surface_torus_add(location=(0, 0, 1.5))
torus = bpy.context.object

def move():
    cube.location.x += 1.0

def recolor():
    cube.data.materials[0] = material((0.8, 0.1, 0.1))

def edit_node():
    cube.data.materials[0].node_tree.nodes["Principled BSDF"].inputs["Roughness"].default_value = 0.1

def control_point():
    torus.data.splines[0].points[3].co.z += 0.4

def vertex():
    cube.data.vertices[0].co.x += 0.5
    cube.data.update()

def lamp():
    bpy.data.objects["Light"].data.energy *= 2

def world():
    scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.1, 0.3, 0.6, 1)

def hide():
    cube.hide_set(True)

def show():
    cube.hide_set(False)

def delete():
    bpy.data.objects.remove(torus)

def modifier():
    cube.modifiers.new("subdivision", "SUBSURF")

def orbit():
    space.region_3d.view_rotation.rotate(__import__("mathutils").Euler((0, 0, 0.4)))

def orthographic():
    space.region_3d.view_perspective = "ORTHO"

def camera():
    space.region_3d.view_perspective = "CAMERA"

def depth_of_field():
    scene.camera.data.dof.use_dof = True
    scene.camera.data.dof.aperture_fstop = 0.5

EDITS = [move, recolor, edit_node, control_point, vertex, lamp, world, hide, show, modifier, orbit, orthographic, camera,
         depth_of_field, delete]

"""

COMPARE = """
def steps():
    yield 0.3
    switch("RENDERED")
    yield rendered
    differences = {}
    first, end = map(int, sys.argv[2:4])
    for edit in EDITS[:first]:
        edit()
        bpy.context.view_layer.update()
        yield 0.1
    for edit in EDITS[first:end]:
        yield rendered
        before = shown()
        edit()
        bpy.context.view_layer.update()
        yield 0.15
        yield rendered
        edited = shown().copy()
        switch("SOLID")
        yield 0.1
        switch("RENDERED")
        yield 0.15
        yield rendered
        fresh = shown()
        changed = before.shape != edited.shape or bool((before != edited).any())
        differences[edit.__name__] = [changed, int((edited != fresh).sum()), bool(np.isfinite(edited).all())]
    bpy.ops.screen.screenshot(filepath=sys.argv[1])
    report(differences=differences)

drive(steps())
"""


def test_after_each_edit_a_view_shows_what_a_fresh_one_does(window, tmp_path):  # noqa: F811
    run = window(VIEW + EDITS + COMPARE, tmp_path / "view.png", 0, 15, size=SMALL)
    assert "Traceback" not in run.log
    differences = run.report["differences"]
    assert len(differences) == 15
    check(differences)


def check(differences):
    """Each edit was seen, and shows what a fresh view does."""
    for edit, (changed, different, finite) in differences.items():
        assert changed and finite and different == 0, (edit, differences)


SWITCHES = """
import threading

def steps():
    yield 0.3
    for number in range(25):
        switch("RENDERED")
        yield (0.0, 0.05, 0.3)[number % 3]
        switch("SOLID")
        yield 0.02
    switch("RENDERED")
    yield rendered
    press("F12")
    yield lambda: "complete" in times
    yield 0.2
    yield rendered
    switch("SOLID")
    yield 0.3
    names = [thread.name for thread in threading.enumerate()]
    report(threads=names.count("rayleaf viewport"), open=len(viewports()))

drive(steps())
"""


def test_switching_of_shading_leaves_no_threads_and_a_final_render_goes_on(window):  # noqa: F811
    run = window("preferences.view.render_display_type = 'NONE'\n" + VIEW + SWITCHES, size=SMALL)
    assert "Traceback" not in run.log
    assert run.report == {"threads": 0, "open": 0}


WRONG = """
def steps():
    yield 0.3
    switch("RENDERED")
    yield rendered
    cube = bpy.data.objects["Cube"]
    cube.scale = (0, 0, 0)  # no object that can be rendered
    yield 0.2
    yield rendered
    cube.scale = (1, 1, 1)
    yield 0.2
    yield rendered
    for obj in list(bpy.data.objects):
        bpy.data.objects.remove(obj)
    yield 0.2
    yield rendered
    report(done=True)

drive(steps())
"""


def test_an_object_scaled_to_nothing_and_an_empty_scene_are_shown(window):  # noqa: F811
    run = window(VIEW + WRONG, size=SMALL)
    assert "Traceback" not in run.log and run.report["done"]


QUIT = """
def steps():
    yield 0.3
    switch("RENDERED")
    scene.rayleaf.preview_samples = 1 << 20
    yield 1.5
    if sys.argv[1] == "disable":
        import addon_utils
        addon_utils.disable("rayleaf")
        yield 0.3
        import threading
        assert "rayleaf viewport" not in [thread.name for thread in threading.enumerate()]
    report(alive=True)
    bpy.ops.wm.quit_blender()
    yield 20

drive(steps())
"""


@pytest.mark.parametrize("how", ["disable", "quit"])
def test_blender_ends_while_a_view_is_rendered(window, how):  # noqa: F811
    run = window(VIEW + QUIT, how, size=SMALL)
    assert run.report["alive"] and "Traceback" not in run.log and "SIGSEGV" not in run.log
