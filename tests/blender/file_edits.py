"""In Blender: edits of a file, one after the other, each of a kind and to a thing that numbers choose. Reports where the
scene that is kept up to date shows another picture than one exported anew.

Arguments: the file, the number of the first edit, and how many."""

import random
import sys

import bpy
import numpy as np
from rayleaf.export import camera
from rayleaf.export.camera import Frame
from rayleaf.messages import Messages
from rayleaf.viewport.sync import SceneSync

from rayleaf import _core

FILE = sys.argv[-3]
FIRST, COUNT = map(int, sys.argv[-2:])
bpy.ops.wm.open_mainfile(filepath=FILE)
SIZE = Frame(32, 20)
SAMPLES = 2
scene = bpy.context.scene
chosen = random.Random(1)


def said(_message, *_more):
    pass


def pick(things):
    things = list(things)
    return chosen.choice(things) if things else None


def objects(*kinds):
    return [each for each in scene.objects if not kinds or each.type in kinds]


def shown():
    return objects("MESH", "CURVE", "SURFACE", "FONT")


def sockets():
    """Values of shader nodes that nothing is linked to."""
    trees = [each.node_tree for each in (*bpy.data.materials, *bpy.data.worlds) if each.node_tree]
    for tree in trees:
        for node in tree.nodes:
            for socket in node.inputs:
                if not socket.is_linked and socket.type in ("VALUE", "RGBA") and socket.enabled:
                    yield socket


def move():
    pick(objects()).location.x += chosen.uniform(-1, 1)


def turn():
    pick(objects()).rotation_euler.z += chosen.uniform(-1, 1)


def shrink_to_nothing():
    pick(shown()).scale = (0, 0, 0)


def grow_back():
    for each in shown():
        if each.scale.length == 0:
            each.scale = (1, 1, 1)


def value():
    socket = pick(sockets())
    if socket is None:
        return
    if socket.type == "RGBA":
        socket.default_value = (chosen.random(), chosen.random(), chosen.random(), 1)
    else:
        socket.default_value = chosen.random()


def lamp():
    each = pick(objects("LIGHT"))
    if each:
        each.data.energy *= chosen.uniform(0.2, 2)
        each.data.color = (1, chosen.random(), 0.5)


def add_lamp():
    scene.collection.objects.link(
        bpy.data.objects.new("New", bpy.data.lights.new("New", pick(("POINT", "SUN", "AREA"))))
    )


def hide():
    each = pick(shown())
    each.hide_viewport = not each.hide_viewport


def hide_from_camera():
    each = pick(shown())
    each.visible_camera = not each.visible_camera


def remove():
    if len(shown()) > 2:
        bpy.data.objects.remove(pick(shown()))


def linked_copy():
    copy = pick(shown()).copy()
    copy.location.z += 0.5
    scene.collection.objects.link(copy)


def own_copy():
    copy = pick(shown()).copy()
    copy.data = copy.data.copy()
    copy.location.y += 0.5
    scene.collection.objects.link(copy)


def reshape():
    data = pick(shown()).data
    if isinstance(data, bpy.types.Mesh) and data.vertices:
        data.vertices[0].co.z += 0.3
        data.update()
    elif getattr(data, "splines", None):
        spline = data.splines[0]
        point = (spline.bezier_points or spline.points)[0]
        point.co.z += 0.3
        data.update_tag()


def modifier():
    each = pick(objects("MESH"))
    if each:
        each.modifiers.new("cast", "CAST").factor = 0.3


def other_material():
    each = pick(shown())
    if each.material_slots:
        each.material_slots[0].material = pick(bpy.data.materials)


def parent():
    one, other = pick(shown()), pick(objects("LIGHT", "EMPTY"))
    if other and not one.parent and one is not other:
        one.parent = other


def next_frame():
    scene.frame_set(scene.frame_current + 1)


def override():
    layer = bpy.context.view_layer
    layer.material_override = None if layer.material_override else pick(bpy.data.materials)


def color():
    pick(shown()).color = (chosen.random(), 0.5, 0.5, 1)


EDITS = [
    *(move, turn, value, value, lamp, hide, hide_from_camera, linked_copy, own_copy, reshape, other_material),
    *(shrink_to_nothing, modifier, grow_back, add_lamp, remove, parent, next_frame, override, override, color),
]


def new_sync():
    return SceneSync(_core, lambda: Messages(said))


def seen_from():
    """The camera where it is now: views set theirs for each picture."""
    seen_by = scene.camera.evaluated_get(bpy.context.evaluated_depsgraph_get())
    return camera.describe(_core, camera.eye_of(seen_by), SIZE)


def rendered(core_scene):
    core_scene.set_camera(**seen_from())
    session = _core.Session(core_scene, _core.Settings(width=SIZE.width, height=SIZE.height, samples=SAMPLES))
    assert session.render()
    return session.pass_pixels("combined")


kept = new_sync()


def updated():
    """As a view is told, whenever Blender has evaluated changes."""
    return kept.update(bpy.context.evaluated_depsgraph_get(), SIZE, seen_from(), False, None)


bpy.app.handlers.depsgraph_update_post.append(lambda *_: updated())
bpy.app.handlers.frame_change_post.append(lambda *_: updated())
updated()
different, applied = [], []
for number in range(FIRST, FIRST + COUNT):
    edit = EDITS[number % len(EDITS)]
    edit()
    bpy.context.view_layer.update()
    depsgraph = bpy.context.evaluated_depsgraph_get()
    picture = rendered(updated())
    if not np.array_equal(picture, rendered(new_sync().update(depsgraph, SIZE, seen_from(), False, None))):
        different.append([number, edit.__name__])
    applied.append(edit.__name__)
report(different=different, applied=applied, ways=kept.exports)  # noqa: F821: the runner's
