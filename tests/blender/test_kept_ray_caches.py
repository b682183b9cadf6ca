"""Ray caches that an animation keeps where the compositor shows several scenes in each frame."""

from test_ray_interpolation_renders import SETUP

TWO_SCENES = """
rays.mode = "ON"
scene.frame_start, scene.frame_end = 1, 2
bpy.ops.scene.new(type="FULL_COPY")
other = bpy.context.scene
other.name = "Other"
next(item for item in other.objects if item.type == "SURFACE").data.splines[0].points[0].co.x += 0.1
bpy.context.window.scene = scene
tree = scenes.compositor(scene)
tree.nodes.clear()
first, second = (tree.nodes.new("CompositorNodeRLayers") for _ in range(2))
second.scene = other
over, out = tree.nodes.new("CompositorNodeAlphaOver"), scenes.compositor_output(tree)
images = [socket for socket in over.inputs if socket.type == "RGBA"]
for node, socket in zip((first, second), images):
    tree.links.new(node.outputs["Image"], socket)
tree.links.new(over.outputs[0], out.inputs[0])
scene.render.filepath = sys.argv[1]
taken = []
from rayleaf import statistics
publish = statistics.publish
def note(record):
    taken.append((record["scene"], record["frame"], record["core"]["ray_caches"][0]["samples_taken"]))
    publish(record)
statistics.publish = note
bpy.ops.render.render(animation=True)
report(taken=taken)
"""


def test_two_scenes_in_one_frame_keep_the_caches_of_both(run_blender, tmp_path):
    taken = run_blender(SETUP + TWO_SCENES, f"{tmp_path}/frame_").report["taken"]
    assert {(scene, frame) for scene, frame, _ in taken} == {
        (scene, frame) for scene in ("Scene", "Other") for frame in (1, 2)
    }
    counts = {(scene, frame): count for scene, frame, count in taken}
    for scene in ("Scene", "Other"):
        assert counts[scene, 1] > 0
        # The second frame buys the few cells that only both frames' rays together pay for.
        assert counts[scene, 2] < 0.25 * counts[scene, 1], counts
