"""Rendered shading after more kinds of edits, and how each is exported."""

import pytest
from test_viewport import COMPARE, SMALL, VIEW, check
from test_window import TOOLS, window  # noqa: F401: a fixture

pytestmark = pytest.mark.skipif(bool(TOOLS), reason=f"not installed: {', '.join(TOOLS)}")

MORE_EDITS = """
scene.render.preview_pixel_size = "4"

def material(color):
    made = bpy.data.materials.new("plain")
    made.use_nodes = True
    made.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = (*color, 1)
    return made

cube, lamp = bpy.data.objects["Cube"], bpy.data.objects["Light"]
tree = cube.data.materials[0].node_tree
image = bpy.data.images.new("noise", 8, 8)
group = bpy.data.node_groups.new("group", "ShaderNodeTree")
bpy.ops.curve.primitive_bezier_curve_add(location=(0, 2, 0))
curve = bpy.context.object
curve.data.bevel_depth = 0.2
bpy.ops.mesh.primitive_uv_sphere_add(location=(-3, 0, 0), segments=12, ring_count=8)
ball = bpy.context.object
crowd = bpy.data.collections.new("crowd")
crowd.objects.link(ball)
keyed = bpy.data.objects.new("empty", None)
scene.collection.objects.link(keyed)

def add_image():
    node = tree.nodes.new("ShaderNodeTexImage")
    node.image = image
    tree.links.new(node.outputs[0], tree.nodes["Principled BSDF"].inputs["Base Color"])

def change_pixels():
    image.pixels.foreach_set(np.random.default_rng(1).uniform(0, 1, 8 * 8 * 4).astype(np.float32))
    image.update()
    cube.data.materials[0].node_tree.update_tag()  # Blender tells nobody of pixels that scripts set
    cube.data.materials[0].update_tag()

def coordinates_of_an_object():
    node = tree.nodes.new("ShaderNodeTexCoord")
    node.object = keyed
    tree.links.new(node.outputs["Object"], tree.nodes["Image Texture"].inputs[0])

def move_that_object():
    keyed.location = (0.3, 0.4, 0.1)

def add_group():
    value = group.nodes.new("ShaderNodeRGB")
    if hasattr(group, "interface"):  # 4.0
        group.interface.new_socket("color", in_out="OUTPUT", socket_type="NodeSocketColor")
    else:
        group.outputs.new("NodeSocketColor", "color")
    group.links.new(value.outputs[0], group.nodes.new("NodeGroupOutput").inputs[0])
    node = tree.nodes.new("ShaderNodeGroup")
    node.node_tree = group
    inputs = tree.nodes["Principled BSDF"].inputs
    inputs["Emission Strength"].default_value = 1  # 0 since 4.0
    tree.links.new(node.outputs[0], next(each for each in inputs if each.name in ("Emission", "Emission Color")))

def change_group():
    next(each for each in group.nodes if each.bl_idname == "ShaderNodeRGB").outputs[0].default_value = (0.1, 0.2, 0.6, 1)

def own_slot():
    ball.data.materials.append(None)
    ball.material_slots[0].link = "OBJECT"
    ball.material_slots[0].material = material((0.1, 0.7, 0.2))

def move_lamp():
    lamp.location.z = 2

def kind_of_lamp():
    lamp.data.type = "SUN"

def no_world():
    scene.world = None

def bevel():
    curve.data.bevel_depth = 0.35

def move_curve():
    curve.location.z = 0.5

def linked_copy():
    copy = cube.copy()
    copy.location = (3, 1, 0)
    scene.collection.objects.link(copy)

def mesh_of_both():
    cube.data.vertices[6].co.z += 1
    cube.data.update()

def instances_of_a_collection():
    keyed.instance_type, keyed.instance_collection = "COLLECTION", crowd
    keyed.location = (2, -2, 1)

def move_the_instancer():
    keyed.location.x -= 1

def move_what_is_instanced():
    ball.location.z += 0.4

def smooth():
    ball.data.polygons.foreach_set("use_smooth", [True] * len(ball.data.polygons))
    ball.data.update()

def parent():
    cube.location.x -= 0.5
    ball.parent = cube

def move_the_parent():
    cube.location.y += 0.7

def to_camera_invisible():
    curve.visible_camera = False

def modifier():
    ball.modifiers.new("wave", "CAST").factor = 0.8

def modifier_value():
    ball.modifiers[0].factor = 0.2

def frame():
    cube.keyframe_insert("rotation_euler", frame=1)
    cube.rotation_euler.z = 1
    cube.keyframe_insert("rotation_euler", frame=9)
    scene.frame_set(5)

def override():
    bpy.context.view_layer.material_override = material((0.7, 0.6, 0.1))

def transparent():
    scene.world = bpy.data.worlds[0]
    scene.render.film_transparent = True

def border():
    space.use_render_border = True
    space.render_border_min_x, space.render_border_max_x = 0.3, 0.8
    space.render_border_min_y, space.render_border_max_y = 0.2, 0.9

def normals():
    space.shading.rayleaf.render_pass = "normal"

EDITS = [add_image, change_pixels, coordinates_of_an_object, move_that_object, add_group, change_group, own_slot, move_lamp,
         kind_of_lamp, no_world, bevel, move_curve, linked_copy, mesh_of_both, instances_of_a_collection,
         move_the_instancer, move_what_is_instanced, smooth, parent, move_the_parent, to_camera_invisible, modifier,
         modifier_value, frame, override, transparent, border, normals]
"""


@pytest.mark.parametrize("first", range(0, 28, 7))
def test_more_edits_show_what_a_fresh_view_does(window, tmp_path, first):  # noqa: F811
    run = window(VIEW + MORE_EDITS + COMPARE, tmp_path / "more.png", first, first + 7, size=SMALL)
    assert "Traceback" not in run.log
    assert len(run.report["differences"]) == 7
    check(run.report["differences"])


WAYS = """
cube, lamp = bpy.data.objects["Cube"], bpy.data.objects["Light"]

def select():
    cube.select_set(not cube.select_get())

def move():
    cube.location.x += 0.5

def recolor():
    cube.data.materials[0].node_tree.nodes["Principled BSDF"].inputs["Roughness"].default_value *= 0.9

def disappear():
    cube.visible_camera = not cube.visible_camera

def recolor_and_disappear():
    recolor()
    disappear()

def shine():
    lamp.data.energy *= 2

def reshape():
    cube.data.vertices[0].co.x += 0.5
    cube.data.update()

def steps():
    yield 0.3
    switch("RENDERED")
    yield rendered
    ways = []
    for edit in (recolor, shine, select, move, recolor, shine, reshape, recolor, recolor, disappear, recolor,
                 recolor_and_disappear):
        sync, request = viewports()[0].sync, viewports()[0]._request
        before = dict(sync.exports)
        edit()
        yield 0.3
        yield rendered
        took = [way for way in before if sync.exports[way] > before[way]]
        ways.append([edit.__name__, *took, viewports()[0]._request is request])
    report(ways=ways, version=bpy.app.version)

drive(steps())
"""


def test_an_edit_exports_what_it_changes_and_a_selection_shows_the_same_picture_on(window):  # noqa: F811
    run = window(VIEW + WAYS, size=SMALL)
    assert "Traceback" not in run.log
    # Since 4.3 Blender says of all that show a material that they have changed with it. Then the first time, and the first
    # after other changes, their settings are looked at.
    first = "whole" if tuple(run.report["version"]) >= (4, 3, 0) else "edit"
    assert run.report["ways"] == [
        ["recolor", first, False],
        ["shine", first, False],
        ["select", "whole", "same", True],
        ["move", "edit", False],
        ["recolor", first, False],
        ["shine", first, False],
        ["reshape", "whole", False],
        ["recolor", first, False],
        ["recolor", "edit", False],
        ["disappear", "whole", False],
        ["recolor", first, False],
        ["recolor_and_disappear", "whole", False],
    ]
