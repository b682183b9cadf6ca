"""Parts of scenes that are kept from frame to frame, and after a render where Blender's switch says so."""

SETUP = """
import bpy, rayleaf
scene = bpy.context.scene
for item in list(bpy.data.objects):
    bpy.data.objects.remove(item)
scene.render.engine = "RAYLEAF"
scene.render.resolution_x = scene.render.resolution_y = 16
scene.rayleaf.samples = 1
bpy.ops.surface.primitive_nurbs_surface_sphere_add(location=(-1.5, 0, 0))
bpy.ops.mesh.primitive_cube_add(location=(1.5, 0, 0))
cube = bpy.context.object
bpy.ops.object.camera_add(location=(0, 0, 8))
scene.camera = bpy.context.object
kept = []
def note(*_):
    kept.append(rayleaf.last_statistics["core"]["geometry"]["kept_shapes"])
bpy.app.handlers.render_post.append(note)
"""


def test_frames_of_an_animation_build_what_changes(run_blender, tmp_path):
    script = f"""
scene.render.filepath = {str(tmp_path / "frame_")!r}
scene.frame_start, scene.frame_end = 1, 2
cube.keyframe_insert("location", frame=1)
cube.location.y = 1
cube.keyframe_insert("location", frame=2)
bpy.ops.render.render(animation=True)
bpy.ops.render.render()
bpy.ops.render.render()
report(kept=kept)
"""
    assert run_blender(SETUP + script).report["kept"] == [0, 2, 0, 0]


def test_persistent_data_keeps_parts_after_a_render(run_blender):
    script = """
scene.render.use_persistent_data = True
bpy.ops.render.render()
bpy.ops.render.render()
cube.data.vertices[0].co.x += 0.1
bpy.ops.render.render()
scene.render.use_persistent_data = False
bpy.ops.render.render()
bpy.ops.render.render()
report(kept=kept)
"""
    assert run_blender(SETUP + script).report["kept"] == [0, 2, 1, 0, 0]


def test_what_a_render_made_is_freed_when_it_ends(run_blender):
    """Not when Python next collects reference cycles, perhaps after another frame has been made beside it."""
    script = """
import gc
material = bpy.data.materials.new("grey")
material.use_nodes = True
cube.data.materials.append(material)
gc.collect()
gc.disable()
bpy.ops.render.render()
gc.set_debug(gc.DEBUG_SAVEALL)
gc.collect()
types = {type(item) for item in gc.garbage}
report(left=sorted(kind.__name__ for kind in types if kind.__module__.startswith("rayleaf")), kept=kept)
"""
    assert run_blender(SETUP + script).report == {"left": [], "kept": [0]}
