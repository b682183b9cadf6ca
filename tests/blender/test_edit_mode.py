"""What is rendered of a mesh that is being edited: what it shows, its layers included."""

import numpy as np
import plain_exr

SCRIPT = """
import sys, bpy
scene = bpy.context.scene
render = scene.render
render.engine = "RAYLEAF"
render.resolution_x, render.resolution_y, render.resolution_percentage = 32, 24, 100
settings = render.image_settings
settings.file_format, settings.color_depth, settings.exr_codec = "OPEN_EXR", "32", "NONE"
scene.rayleaf.samples = 1
cube = bpy.data.objects["Cube"]
tree = cube.data.materials[0].node_tree
texture = tree.nodes.new("ShaderNodeTexImage")
texture.image = bpy.data.images.new("grid", 8, 8)
texture.image.generated_type = "COLOR_GRID"
tree.links.new(texture.outputs["Color"], tree.nodes["Principled BSDF"].inputs["Base Color"])
copy = cube.copy()
copy.location.x = 2.5
scene.collection.objects.link(copy)
for kind in ("", "BEVEL", "SUBSURF"):
    if kind:
        cube.modifiers.new(kind, kind)
    for mode in ("OBJECT", "EDIT"):
        bpy.ops.object.mode_set(mode=mode)
        render.filepath = f"{sys.argv[1]}/{kind}{mode}.exr"
        bpy.ops.render.render(write_still=True)
    bpy.ops.object.mode_set(mode="OBJECT")
"""


def test_a_mesh_in_edit_mode_is_rendered_as_in_object_mode(run_blender, tmp_path):
    run_blender(SCRIPT, tmp_path)
    pictures = []
    for kind in ("", "BEVEL", "SUBSURF"):
        one, other = (plain_exr.read(tmp_path / f"{kind}{mode}.exr")["R"] for mode in ("OBJECT", "EDIT"))
        np.testing.assert_allclose(one, other, atol=1e-6, err_msg=kind)  # since 5.0 modifiers round otherwise
        pictures.append(one)
    assert all(np.abs(one - other).max() > 0.01 for one, other in zip(pictures, pictures[1:], strict=False))
