"""What few scenes have is as in Cycles, and never ends a render."""

from pathlib import Path

import numpy as np

SCRIPT = Path(__file__).parent / "export_oddities.py"
ALLOWED = 0.015  # noise of parts of the picture, relative where it is bright


def test_rare_settings_give_what_they_give_in_cycles(run_blender, tmp_path):
    run = run_blender(SCRIPT, tmp_path).report
    far = {}
    for case, pictures in run["found"].items():
        cycles, rayleaf = (np.array(pictures[engine]) for engine in ("CYCLES", "RAYLEAF"))
        difference = np.abs(rayleaf - cycles) / np.maximum(np.abs(cycles), 1.0)
        if not difference.max() <= ALLOWED:
            far[case] = difference.max()
    assert far == {}, far


LONG_CHAINS = """
import bpy, scenes, recording_core
from rayleaf.export import camera
from rayleaf.export.scene import SceneExporter
from rayleaf.messages import Messages

def lengthen(tree, kind):
    tree.nodes.clear()
    shader = tree.nodes.new(kind)
    output = tree.nodes.new("ShaderNodeOutputWorld" if kind == "ShaderNodeBackground" else "ShaderNodeOutputLight")
    tree.links.new(shader.outputs[0], output.inputs["Surface"])
    target = shader.inputs["Strength"]
    for _ in range(700):
        node = tree.nodes.new("ShaderNodeMath")
        tree.links.new(node.outputs[0], target)
        target = node.inputs[0]

scene = scenes.empty_scene()
world = scenes.plain_world((1, 1, 1))
world.use_nodes = True
lamp = bpy.data.lights.new("Long", "POINT")
lamp.use_nodes = True
lengthen(lamp.node_tree, "ShaderNodeEmission")
scenes.add(lamp)
messages = Messages()
exporter = SceneExporter(recording_core.install(), bpy.context.evaluated_depsgraph_get(), messages)
sent = exporter.export(camera.frame_of(scene), needs_uv=False)
before = sent.world is not None
lengthen(world.node_tree, "ShaderNodeBackground")
exporter.edit(sent, bpy.context.evaluated_depsgraph_get())
exporter.export_world()
report(before=before, after=sent.world is not None, lamps=len(sent.lamps), texts=messages.texts)
"""


def test_long_chains_of_nodes_are_named_and_leave_no_former_world(run_blender):
    run = run_blender(LONG_CHAINS).report
    assert (run["before"], run["after"], run["lamps"]) == (True, False, 0)
    of_lamp, of_world = run["texts"]
    assert "'Long'" in of_lamp and "World 'World'" in of_world
    assert all("chain of nodes is too long" in text for text in run["texts"])


LINKED = """
import sys
import bpy, scenes, recording_core
from rayleaf.versions import absolute_path

folder = sys.argv[1]
scene = scenes.empty_scene()
lamp = bpy.data.lights.new("Measured", "POINT")
lamp.use_nodes = True
tree = lamp.node_tree
node = tree.nodes.new("ShaderNodeTexIES")
node.mode, node.filepath = "EXTERNAL", "//sub\\\\lamp.ies"
shader = next(each for each in tree.nodes if each.bl_idname == "ShaderNodeEmission")
tree.links.new(node.outputs[0], shader.inputs["Strength"])
scenes.add(lamp)
bpy.ops.wm.save_as_mainfile(filepath=folder + "/library/lamps.blend")
scenes.empty_scene()
bpy.ops.wm.save_as_mainfile(filepath=folder + "/shot.blend")
with bpy.data.libraries.load(folder + "/library/lamps.blend", link=True, relative=True) as (_, chosen):
    chosen.objects = ["Measured"]
bpy.context.scene.collection.objects.link(chosen.objects[0])
bpy.context.view_layer.update()
sent, _, texts = recording_core.export()
shares = absolute_path("\\\\\\\\host\\\\a.png", bpy.context.scene)
report(lamps=[[line["op"] for line in lamp["emission"].lines] for lamp in sent.lamps], texts=texts, shares=shares)
"""


def test_files_of_linked_libraries_lie_beside_these(run_blender, tmp_path):
    (tmp_path / "library" / "sub").mkdir(parents=True)
    (tmp_path / "library" / "sub" / "lamp.ies").write_text("TILT=NONE\n1 1 1 2 1 1 2 0 0 0 1 1 1 0 90 0 100 50")
    run = run_blender(LINKED, tmp_path).report
    (operations,) = run["lamps"]
    assert "ies" in operations and run["texts"] == []
    assert run["shares"] == "\\\\host\\a.png"


MESSAGES = """
import bpy, scenes
from rayleaf import _core as core
from rayleaf.export import ExportError, camera
from rayleaf.export.scene import SceneExporter
from rayleaf.messages import Messages

def export():
    messages = Messages()
    exporter = SceneExporter(core, bpy.context.evaluated_depsgraph_get(), messages)
    exporter.export(camera.frame_of(bpy.context.scene), needs_uv=False)
    return messages.texts

scene = scenes.empty_scene()
smoke = scenes.add(bpy.data.volumes.new("Volume"), "grid")
material, tree, output = scenes.material("Smoke")
scatter = tree.nodes.new("ShaderNodeVolumeScatter")
tree.links.new(scatter.outputs[0], output.inputs["Volume"])
smoke.data.materials.append(material)
report(texts=export())
scene.camera.name, scene.camera.scale = "Eye", (0, 0, 0)
try:
    export()
except ExportError as error:
    report(error=str(error))
"""


def test_messages_name_what_they_are_about(run_blender):
    run = run_blender(MESSAGES).report
    (text,) = run["texts"]
    assert text.startswith("Object 'grid': its material reads no grid")
    assert run["error"].startswith("Camera 'Eye': matrix is singular")


HAIR = """
import bpy, scenes
from rayleaf.export import strands

scenes.empty_scene()
bpy.ops.object.curves_random_add()
data = bpy.context.object.data
for domain in ("CURVE", "POINT"):
    values = data.attributes.new(domain, "FLOAT", domain).data
    values.foreach_set("value", [0.5] * len(values))
arrays = strands.curves_strands(None, data, frozenset({"CURVE", "POINT"}))
report(curve=arrays.attributes["CURVE"][0].tolist(), point=arrays.point_attributes["POINT"][0].tolist())
"""


def test_numbers_on_hair_are_greys(run_blender):
    run = run_blender(HAIR).report
    assert run == {"curve": [0.5] * 3, "point": [0.5] * 3}
