"""Ray interpolation from Blender to pixels: passes, overrides, animations, statistics."""

import numpy as np
import plain_exr

# A mirror ball of splines over a plane, seen closely enough for rays to share samples.
SETUP = """
import sys, bpy, rayleaf
scene = bpy.context.scene
scene.render.engine = "RAYLEAF"
scene.render.resolution_x = scene.render.resolution_y = 96
scene.render.resolution_percentage = 100
scene.rayleaf.samples = 4
image = scene.render.image_settings
def write_layers():
    image.file_format = "OPEN_EXR_MULTILAYER"
    image.color_depth, image.exr_codec = "32", "NONE"
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
scene.use_nodes = True
node = next(node for node in scene.node_tree.nodes if node.bl_idname == "CompositorNodeRLayers")
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
    # Two threads may take the same sample at the same time, so the count differs by a few.
    assert abs(still - first) < 0.05 * first


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
