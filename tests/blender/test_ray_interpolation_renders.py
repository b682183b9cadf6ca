"""Ray interpolation from Blender to pixels: passes, overrides, animations, statistics."""

import numpy as np
import plain_exr

# A mirror ball of splines over a plane, seen closely enough for rays to share samples.
SETUP = """
import sys, bpy, rayleaf, scenes
scene = bpy.context.scene
scene.render.engine = "RAYLEAF"
scene.render.resolution_x = scene.render.resolution_y = 96
scene.render.resolution_percentage = 100
scene.rayleaf.samples = 4
image = scene.render.image_settings
def write_layers():
    scenes.write_layers()
    scene.render.filepath = sys.argv[1]
    bpy.ops.render.render(write_still=True)
rays = scene.rayleaf.ray_interpolation
bpy.data.objects.remove(bpy.data.objects["Cube"])
bpy.ops.surface.primitive_nurbs_surface_sphere_add(radius=2.0)
ball = bpy.context.object
mirror = bpy.data.materials.new("mirror")
mirror.use_nodes = True
nodes = mirror.node_tree.nodes
glossy = nodes.new("ShaderNodeBsdfGlossy")
glossy.inputs["Roughness"].default_value = 0.0
mirror.node_tree.links.new(glossy.outputs[0], nodes["Material Output"].inputs["Surface"])
ball.data.materials.append(mirror)
def caches():
    return rayleaf.last_statistics["core"]["ray_caches"]
"""


def test_the_mask_and_the_error_come_back_from_a_render(run_blender, tmp_path):
    script = """
layer = bpy.context.view_layer
layer.rayleaf.use_pass_mask = layer.rayleaf.use_pass_mask_colors = layer.rayleaf.use_pass_error = True
rays.mode = "ON"
write_layers()
report(caches=caches())
"""
    path = tmp_path / "rays.exr"
    run = run_blender(SETUP + script, path).report
    picture = plain_exr.read(path)
    mask, blue = picture["ViewLayer.Rayleaf Mask.X"], picture["ViewLayer.Rayleaf Mask Colors.B"]
    assert set(np.unique(mask)) <= {0, 1, 2, 3, 4} and (mask == 2).any()
    assert blue[mask == 2].mean() > 0.3
    assert (picture["ViewLayer.Rayleaf Error.X"][mask == 0] == 0).all()
    assert run["caches"][0]["objects"] == ["Surface"] or run["caches"][0]["objects"] == ["SurfSphere"]
    assert run["caches"][0]["kind"] == "mirror" and run["caches"][0]["used"]


def test_the_tree_pass_tells_by_which_tree_of_the_statistics_each_object_is_answered(run_blender, tmp_path):
    """The ball, a copy that shares its tree, and one of another shape."""
    script = """
bpy.context.view_layer.rayleaf.use_pass_tree = True
bpy.context.view_layer.use_pass_object_index = True
rays.mode = "ON"
ball.scale = (0.4, 0.4, 0.4)
ball.pass_index = 1
copy = ball.copy()
scene.collection.objects.link(copy)
copy.location.x, copy.pass_index = 2.0, 2
bpy.ops.surface.primitive_nurbs_surface_torus_add(location=(-2.0, 0.0, 0.0))
torus = bpy.context.object
torus.data.materials.append(mirror)
torus.pass_index = 3
write_layers()
report(caches=[cache["objects"] for cache in caches()], names=[each.name for each in (ball, copy, torus)])
"""
    path = tmp_path / "trees.exr"
    run = run_blender(SETUP + script, path).report
    picture = plain_exr.read(path)
    tree, index = picture["ViewLayer.Rayleaf Tree.X"], picture["ViewLayer.IndexOB.X"]
    assert (tree[index == 0] == 0).all()
    for i, name in enumerate(run["names"]):
        numbers = np.unique(tree[index == i + 1])
        assert len(numbers) == 1, (name, numbers)
        assert name in run["caches"][int(numbers[0]) - 1], (name, numbers, run["caches"])
    assert tree[index == 1].max() == tree[index == 2].max() != tree[index == 3].max()


def test_path_length_of_a_volume_comes_back(run_blender, tmp_path):
    script = """
bpy.context.view_layer.rayleaf.use_pass_path_length = True
mirror.rayleaf.use_volume = True
write_layers()
"""
    path = tmp_path / "length.exr"
    run_blender(SETUP + script, path)
    length = plain_exr.read(path)["ViewLayer.Path Length.X"]
    # Blender's sphere of splines is round: no chord is longer than its diameter, and the picture shows its middle.
    assert 3.9 < length.max() <= 4.001 and length.min() == 0.0


def test_the_passes_appear_in_the_compositor_when_switched_on_and_leave_when_switched_off(run_blender):
    script = """
node = next(node for node in scenes.compositor(scene).nodes if node.bl_idname == "CompositorNodeRLayers")
def shown():
    return sorted(s.name for s in node.outputs if s.enabled and s.name.startswith("Rayleaf"))
settings = bpy.context.view_layer.rayleaf
before = shown()
settings.use_pass_mask = True
on = shown()
settings.use_pass_mask = False
report(before=before, on=on, after=shown())
"""
    run = run_blender(SETUP + script).report
    assert run == {"before": [], "on": ["Rayleaf Mask"], "after": []}


def test_an_object_can_be_left_out_or_be_the_only_one(run_blender):
    script = """
found = []
for scene_mode, own in (("ON", "SCENE"), ("ON", "OFF"), ("OFF", "ON"), ("OFF", "SCENE")):
    rays.mode, ball.rayleaf.ray_interpolation.mode = scene_mode, own
    bpy.ops.render.render()
    found.append(any(each["used"] for each in caches()))
report(found=found)
"""
    assert run_blender(SETUP + script).report["found"] == [True, False, True, False]


def test_an_animation_keeps_what_its_frames_share_and_a_still_starts_afresh(run_blender, tmp_path):
    script = f"""
rays.mode = "ON"
scene.render.filepath = {str(tmp_path / "frame_")!r}
scene.frame_start, scene.frame_end = 1, 2
taken = []
def note(*_):
    taken.append(caches()[0]["samples_taken"])
bpy.app.handlers.render_post.append(note)
bpy.ops.render.render(animation=True)
bpy.ops.render.render()
report(taken=taken)
"""
    first, second, still = run_blender(SETUP + script).report["taken"]
    # The second buys the few cells that only both frames' rays together pay for.
    assert first > 0 and second < 0.25 * first
    # The least is what one thread takes. Two take some samples twice: at the same time, or because one makes room in
    # the table, and does not get to run for a while, so that samples of the other are not kept: on a busy machine a
    # tenth and more. A still that kept anything would take less than a quarter, as the second frame.
    assert still > 0.5 * first


def test_frames_of_an_animation_look_as_they_do_alone_within_the_error(run_blender, tmp_path):
    script = f"""
rays.mode = "ON"
scene.frame_start, scene.frame_end = 1, 2
image.file_format = "OPEN_EXR"
image.color_depth, image.exr_codec = "32", "NONE"
scene.camera.keyframe_insert("location", frame=1)
scene.camera.location.x += 0.2
scene.camera.keyframe_insert("location", frame=2)
scene.render.filepath = {str(tmp_path / "frame_")!r}
bpy.ops.render.render(animation=True)
scene.frame_set(2)
scene.render.filepath = {str(tmp_path / "alone.exr")!r}
bpy.ops.render.render(write_still=True)
"""
    run_blender(SETUP + script)
    together, alone = plain_exr.read(tmp_path / "frame_0002.exr"), plain_exr.read(tmp_path / "alone.exr")
    assert together.keys() == alone.keys()
    for name in alone:
        # A cache that is kept interpolates more: the mean difference stays within the setting's error.
        assert np.abs(together[name] - alone[name]).mean() <= 0.005, name


# Objects whose shape or material changes from frame 1 to frame 2, and one that only moves, by what an artist may use.
CHANGING = """
rays.mode = "ON"
scene.frame_start, scene.frame_end = 1, 2
image.file_format = "OPEN_EXR"
image.color_depth, image.exr_codec = "32", "NONE"
def keyed(name, x, z, add=bpy.ops.surface.primitive_nurbs_surface_sphere_add, material=mirror):
    add(radius=1.0, location=(x, 0.0, z))
    item = bpy.context.object
    item.name = name
    item.data.materials.append(material)
    return item
def stretching_key(item):
    item.shape_key_add(name="Basis")
    key = item.shape_key_add(name="Long")
    for point in key.data:
        point.co.x *= 1.5
    return key
sky = scene.world.node_tree
place = sky.nodes.new("ShaderNodeTexCoord")
sky.links.new(place.outputs["Generated"], sky.nodes["Background"].inputs["Color"])
bpy.data.objects.remove(bpy.data.objects["Light"])  # its image in a mirror is brighter than all else together
ball.name, ball.scale = "moved", (0.5, 0.5, 0.5)
for frame, place in ((1, (0, 0, 0)), (2, (0, 0, 0.3))):
    ball.location = place
    ball.keyframe_insert("location", frame=frame)
stretching_key(keyed("driven key", -1.8, 1.3)).driver_add("value").driver.expression = "frame - 1"
solid = keyed("keyed mesh", 1.8, 1.3, bpy.ops.mesh.primitive_uv_sphere_add)
bpy.ops.object.shade_smooth()
key = stretching_key(solid)
for frame, value in ((1, 0.0), (2, 1.0)):
    key.value = value
    key.keyframe_insert("value", frame=frame)
edited = keyed("edited points", -1.8, -1.3)
def edit(scene, *_):
    for point in edited.data.splines[0].points:
        point.co.x = point.co.y * (scene.frame_current - 1)
bpy.app.handlers.frame_change_pre.append(edit)
glass = bpy.data.materials.new("glass")
glass.use_nodes = True
clear = glass.node_tree.nodes.new("ShaderNodeBsdfGlass")
clear.inputs["Roughness"].default_value = 0.0
glass.node_tree.links.new(clear.outputs[0], glass.node_tree.nodes["Material Output"].inputs["Surface"])
keyed("another index", 1.8, -1.3, material=glass)
for frame, index in ((1, 1.2), (2, 1.6)):
    clear.inputs["IOR"].default_value = index
    clear.inputs["IOR"].keyframe_insert("default_value", frame=frame)
taken = []
def note(*_):
    taken.append({cache["objects"][0]: cache["samples_taken"] for cache in caches()})
bpy.app.handlers.render_post.append(note)
"""


def test_an_object_whose_shape_or_material_changes_gets_a_fresh_tree_and_one_that_moves_keeps_its(
    run_blender, tmp_path
):
    script = f"""
scene.render.filepath = {str(tmp_path / "frame_")!r}
bpy.ops.render.render(animation=True)
scene.frame_set(2)
scene.render.filepath = {str(tmp_path / "alone.exr")!r}
bpy.ops.render.render(write_still=True)
rays.mode = "OFF"
scene.render.filepath = {str(tmp_path / "traced.exr")!r}
bpy.ops.render.render(write_still=True)
report(taken=taken)
"""
    first, second, alone, _ = run_blender(SETUP + CHANGING + script).report["taken"]
    assert set(first) == {"moved", "driven key", "keyed mesh", "edited points", "another index"}
    assert second.pop("moved") < 0.9 * alone.pop("moved")
    # Two threads may take the same sample at the same time, so the counts differ by a few.
    for name, count in second.items():
        assert abs(count - alone[name]) < 0.05 * alone[name], (name, count, alone[name])
    together, still = (plain_exr.read(tmp_path / name) for name in ("frame_0002.exr", "alone.exr"))
    before, traced = (plain_exr.read(tmp_path / name) for name in ("frame_0001.exr", "traced.exr"))
    for name in still:
        if name.endswith("A"):
            continue
        # Within the error that is set; a tree of the frame before would show that frame.
        assert np.abs(together[name] - still[name]).mean() <= 0.005, name
        assert np.abs(before[name] - still[name]).mean() > 0.01, name
        assert np.abs(together[name] - traced[name]).mean() <= 0.005, name


# Objects at the limits of sizes, places and shapes, each with a view of it.
EXTREMES = """
from mathutils import Matrix, Vector
scene.render.resolution_x = scene.render.resolution_y = 64
image.file_format = "OPEN_EXR"
image.color_depth, image.exr_codec = "32", "NONE"
sky = scene.world.node_tree
place = sky.nodes.new("ShaderNodeTexCoord")
sky.links.new(place.outputs["Generated"], sky.nodes["Background"].inputs["Color"])
bpy.data.objects.remove(bpy.data.objects["Light"])
home, points = scene.camera.matrix_world.copy(), [tuple(point.co) for point in ball.data.splines[0].points]
scene.camera.data.clip_end = 1e9
def view(name, stretch=(1, 1, 1), data_scale=1.0, scale=1.0, offset=0.0):
    size = data_scale * scale
    for point, (x, y, z, w) in zip(ball.data.splines[0].points, points):
        point.co = (*(data_scale * a * b for a, b in zip((x, y, z), stretch)), w)
    ball.scale, ball.location = (scale,) * 3, (offset,) * 3
    scene.camera.matrix_world = Matrix.Translation(home.translation * size + Vector((offset,) * 3)) @ home.to_3x3().to_4x4()
    scene.camera.data.clip_start = min(0.1, 0.1 * size)
    for mode in ("AUTO", "ON"):  # a picture this small is traced on Auto, by the same model of glass
        rays.mode = mode
        scene.render.filepath = f"{sys.argv[1]}{name}_{mode}.exr"
        bpy.ops.render.render(write_still=True)
    return sum(cache["answers"]["interpolated"] for cache in caches())
VIEWS = {
    "flat": dict(stretch=(1, 1, 0)), "needle": dict(stretch=(1e-3, 1e-3, 1)), "small": dict(scale=1e-6),
    "large": dict(scale=1e6), "small_data": dict(data_scale=1e-6), "large_data": dict(data_scale=1e6),
    "far": dict(offset=1e6),
}
report(interpolated={name: view(name, **how) for name, how in VIEWS.items()})
"""


def test_pictures_of_extreme_sizes_places_and_shapes_are_those_of_tracing(run_blender, tmp_path):
    interpolated = run_blender(SETUP + EXTREMES, f"{tmp_path}/").report["interpolated"]
    for name, count in interpolated.items():
        # A needle is thinner than any cell of rays: all that meet it are traced.
        assert (count > 500) == (name != "needle"), interpolated
        on, traced = (plain_exr.read(tmp_path / f"{name}_{mode}.exr") for mode in ("ON", "AUTO"))
        for channel in traced:
            assert np.isfinite(on[channel]).all(), (name, channel)
            assert np.abs(on[channel] - traced[channel]).mean() <= 0.005, (name, channel)  # the error that is set
        assert max(traced[channel].std() for channel in "RGB") > 0.01, f"{name}: nothing to be seen"


# What panels write, line by line, to whoever looks at them after a render.
PANELS = """
from rayleaf import ui_rays
class Layout:
    def __init__(self):
        self.lines = []
    def __getattr__(self, name):
        return lambda *arguments, **more: self
    def label(self, text="", **more):
        self.lines.append(text)
def written(panel, thing):
    layout = Layout()
    class Context:
        engine, object = "RAYLEAF", thing
    Context.scene = scene
    if not panel.poll(Context):
        return None
    panel.draw(type("Shown", (), {"layout": layout, "_column": lambda self: layout})(), Context)
    return " ".join(layout.lines)
"""


def test_panels_and_a_message_say_what_auto_decided_and_why(run_blender):
    script = """
rays.mode = "AUTO"
before = written(ui_rays.RAYLEAF_PT_ray_interpolation_outcome, ball)
scene.render.resolution_x = scene.render.resolution_y = 16
bpy.ops.render.render()
messages = [rayleaf.last_statistics["messages"]]
shown = [written(panel, ball) for panel in (ui_rays.RAYLEAF_PT_ray_interpolation_outcome,
                                            ui_rays.RAYLEAF_PT_object_ray_interpolation)]
scene.render.resolution_x = scene.render.resolution_y = 96
rays.mode = "ON"
bpy.ops.render.render()
messages.append(rayleaf.last_statistics["messages"])
scene.name = "Another"
report(before=before, shown=shown, after=written(ui_rays.RAYLEAF_PT_ray_interpolation_outcome, ball),
       on=caches()[0], messages=messages, ball=ball.name)
"""
    run = run_blender(SETUP + PANELS + script).report
    assert run["before"] is None and run["after"] is None  # nothing rendered yet; a scene that was not
    for shown in run["shown"]:
        assert run["ball"] in shown and "traced" in shown and "too few rays" in shown, shown
    (message,), no_messages = run["messages"]
    assert message == f"Ray interpolation on Auto: off for {run['ball']} (the picture has too few rays)"
    assert no_messages == []
    counted = run["on"]
    assert counted["queries"] == sum(counted["answers"].values()) > 0
    assert counted["interpolated"] == counted["answers"]["interpolated"] > 0
    assert counted["traced"] == sum(n for name, n in counted["answers"].items() if name.startswith("traced"))
    assert counted["queries"] == sum(counted[how] for how in ("interpolated", "followed", "traced", "missed"))


def test_the_panel_of_the_scene_lists_shares_of_rays_by_object(run_blender):
    script = """
rays.mode = "ON"
bpy.ops.render.render()
report(shown=written(ui_rays.RAYLEAF_PT_ray_interpolation_outcome, ball), cache=caches()[0])
"""
    run = run_blender(SETUP + PANELS + script).report
    cache = run["cache"]
    assert run["shown"].startswith(f"{cache['objects'][0]} {cache['queries']:,} rays: ")
    assert f"{cache['interpolated'] / cache['queries']:.0%} interpolated" in run["shown"]
