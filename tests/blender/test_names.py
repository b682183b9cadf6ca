"""Names that are not UTF-8, as files of old Blenders hold them: of everything that has one, in a file whose bytes are patched."""

import plain_exr

# Every name begins with "Qq"; the patch makes Latin-1 of the second letter.
MARK, PATCHED, SHOWN = b"Qq", b"Q\xe4", "Qä"

FILE = """
import os, sys
import bpy, scenes

scene = scenes.empty_scene()
render = scene.render
render.resolution_x, render.resolution_y, render.resolution_percentage = 16, 16, 100
render.image_settings.file_format = "OPEN_EXR"
render.image_settings.color_depth, render.image_settings.exr_codec = "32", "NONE"
scene.name, bpy.context.view_layer.name = "Qq scene", "Qq layer"
camera = scene.camera
camera.name = camera.data.name = "Qq camera"
camera.location, camera.data.type, camera.data.ortho_scale = (0.5, 0.5, 5), "ORTHO", 1
world = scene.world = bpy.data.worlds.new("Qq world")
world.use_nodes = True
world.node_tree.nodes["Background"].name = "Qq background"
scene.rayleaf.samples = 4
folder = sys.argv[1]

# A quad that shines by an image, looked up by a named UV map, times a colour attribute, through a group.
item = scenes.quad("Qq quad")
item.data.name = "Qq mesh"
item.data.uv_layers[0].name = "Qq map"
second = item.data.uv_layers.new(name="Qx map")
for loop in second.data:
    loop.uv = (9, 9)
tint = item.data.color_attributes.new("Qq tint", "FLOAT_COLOR", "CORNER")
for value in tint.data:
    value.color = (1, 0.5, 0.25, 1)
item.vertex_groups.new(name="Qq group")
item.modifiers.new("Qq modifier", "TRIANGULATE")
material, tree, output = scenes.material("Qq material")
item.data.materials.append(material)
image = bpy.data.images.new("Qq image", 2, 2)
image.pixels.foreach_set([0.5, 0.5, 0.5, 1] * 4)
image.filepath_raw, image.file_format = os.path.join(folder, "Qq.png"), "PNG"
image.save()
image.source, image.colorspace_settings.name = "FILE", "Non-Color"
nodes, links = tree.nodes, tree.links
texture, place, attribute = (nodes.new(f"ShaderNode{kind}") for kind in ("TexImage", "UVMap", "VertexColor"))
texture.image, place.uv_map, attribute.layer_name = image, "Qq map", "Qq tint"
inner = scenes.group("Qq tree", "NodeSocketColor", "NodeSocketColor")
inner.links.new(inner.nodes.new("NodeGroupInput").outputs[0], inner.nodes.new("NodeGroupOutput").inputs[0])
for sockets in (getattr(inner, "inputs", ()), getattr(inner, "outputs", ())):
    for socket in sockets:
        socket.name = "Qq socket"
group, multiply, shine = (nodes.new(f"ShaderNode{kind}") for kind in ("Group", "MixRGB", "Emission"))
group.node_tree, multiply.blend_type, multiply.inputs[0].default_value = inner, "MULTIPLY", 1
links.new(place.outputs[0], texture.inputs[0])
links.new(texture.outputs[0], multiply.inputs[1])
links.new(attribute.outputs[0], multiply.inputs[2])
links.new(multiply.outputs[0], group.inputs[0])
links.new(group.outputs[0], shine.inputs[0])
links.new(shine.outputs[0], output.inputs[0])
for node in nodes:
    node.name = f"Qq {node.name}"

# What is not rendered as it stands, so that it is named: two materials that differ in a byte beyond ASCII alone.
for number, letter in enumerate("qQ"):
    odd, odd_tree, odd_output = scenes.material(f"Q{letter} odd")
    unknown = "ShaderNodeTexPointDensity" if bpy.app.version < (5, 0) else "ShaderNodeRadialTiling"
    points, shine = odd_tree.nodes.new(unknown), odd_tree.nodes.new("ShaderNodeEmission")
    points.name = "Qq points"
    odd_tree.links.new(points.outputs[-1], shine.inputs["Strength"])
    shine.inputs["Color"].default_value = (number, 1, 0, 1)
    odd_tree.links.new(shine.outputs[0], odd_output.inputs[0])
    far = scenes.quad(f"Q{letter} far")
    far.location.x = 10
    far.data.materials.append(odd)
bpy.ops.surface.primitive_nurbs_surface_surface_add(location=(20, 0, 0))
bpy.context.object.name = "Qq surface"
bpy.context.object.shape_key_add(name="Qq key")
curve = bpy.data.curves.new("Qq curve", "CURVE")
curve.bevel_depth = 0.1
curve.splines.new("POLY").points.add(1)
curve.splines[0].points[1].co = (0, 0, 1, 1)
scenes.add(curve, "Qq curve").location.x = 40
lamp = scenes.add(bpy.data.lights.new("Qq lamp", "POINT"), "Qq lamp")
lamp.location, lamp.data.use_nodes = (50, 0, 0), True
hairy = scenes.quad("Qq hairy")
hairy.location.x = 30
hairy.modifiers.new("Qq particles", "PARTICLE_SYSTEM")
hairy.particle_systems[0].name = "Qq system"
hairy.particle_systems[0].settings.type, hairy.particle_systems[0].settings.count = "HAIR", 3
collection = bpy.data.collections.new("Qq collection")
scene.collection.children.link(collection)
bpy.ops.wm.save_as_mainfile(filepath=os.path.join(folder, "scene.blend"), compress=False)
"""

RENDER = """
import sys
import bpy, rayleaf
bpy.ops.wm.open_mainfile(filepath=sys.argv[1])
bpy.context.scene.render.filepath = sys.argv[2]
bpy.ops.render.render(write_still=True)
record = rayleaf.last_statistics
report(messages=record["messages"], names=[record["scene"], record["view_layer"]], exact=record["export"]["exact"],
       left_out=record["export"]["left_out"], strands=record["export"]["strands"])
"""


def patched_file(run_blender, folder):
    """The file, its image too, under names that are no UTF-8."""
    run_blender(FILE, folder)
    data = (folder / "scene.blend").read_bytes()
    assert data.count(MARK) > 40
    (folder / "patched.blend").write_bytes(data.replace(MARK, PATCHED).replace(b"QQ", b"Q\xeb"))
    (folder / "Qq.png").rename(bytes(folder / "Q\udce4.png").decode("utf-8", "surrogateescape"))
    return folder / "patched.blend"


def test_a_file_of_names_that_are_not_utf8_is_rendered_and_they_are_told_as_latin_1(run_blender, tmp_path):
    file = patched_file(run_blender, tmp_path)
    run = run_blender(RENDER, file, tmp_path / "picture.exr")
    picture = plain_exr.read(tmp_path / "picture.exr")
    # The image is 8-bit grey: 128 / 255, times the attribute.
    assert [round(float(picture[c][8, 8]) * 255 / 128, 2) for c in "RGB"] == [1, 0.5, 0.25]
    assert run.report["names"] == [f"{SHOWN} scene", f"{SHOWN} layer"]
    assert run.report["exact"] == [f"{SHOWN} surface", f"{SHOWN} curve"]
    assert run.report["strands"] == [f"{SHOWN} hairy"]
    told = " ".join(run.report["messages"])
    for material in (f"{SHOWN} odd", "Që odd"):
        assert f"Material '{material}', node '{SHOWN} points'" in told
    assert "Traceback" not in run.log


def test_an_image_that_is_missing_under_such_a_path_is_named(run_blender, tmp_path):
    file = patched_file(run_blender, tmp_path)
    next(tmp_path.glob("Q*.png")).unlink()
    run = run_blender(RENDER, file, tmp_path / "picture.exr")
    assert any(f"'{SHOWN} image'" in text and "no file" in text for text in run.report["messages"])


def test_a_layer_of_such_a_name_beside_others_is_an_error_that_names_it(run_blender, tmp_path):
    file = patched_file(run_blender, tmp_path)
    run = run_blender(
        """
import sys
import bpy
bpy.ops.wm.open_mainfile(filepath=sys.argv[1])
bpy.context.scene.view_layers.new("Other")
try:
    bpy.ops.render.render()
except RuntimeError as error:
    report(error=str(error))
""",
        file,
        check=False,  # Blender ends with 1 after a render that failed
    )
    assert f"'{SHOWN} layer'" in run.report["error"] and "UTF-8" in run.report["error"]
