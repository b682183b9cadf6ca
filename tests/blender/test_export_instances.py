"""Instances: what is shared, where they are, who sees them."""

import pytest

START = """
import bpy, scenes, recording_core
scene = scenes.empty_scene()
"""


def test_linked_data_collections_and_instancers_share_one_shape(run_blender):
    run = run_blender(
        START
        + """
one = scenes.quad("One")
two = scenes.add(one.data, "Two")
two.location = (5, 6, 7)
surface = scenes.surface("Surface")
collection = bpy.data.collections.new("Many")
collection.objects.link(one)
collection.objects.link(surface)
for number in range(3):
    place = scenes.add(None, f"Place {number}")
    place.instance_type, place.instance_collection, place.location = "COLLECTION", collection, (0, 0, number)
different = scenes.add(one.data, "Different")
different.modifiers.new("Thick", "SOLIDIFY")
bpy.context.view_layer.update()
sent = recording_core.export()[0]
table = sent.instances
report(meshes=[m["name"] for m in sent.meshes], surfaces=[s["name"] for s in sent.surfaces], names=table["names"],
       shapes=table["shapes"], two=table["matrices"][table["names"].index("Two")].tolist(), dtype=str(table["matrices"][0].dtype))
"""
    ).report
    assert sorted(run["meshes"]) == ["Different", "One"]
    assert run["surfaces"] == ["Surface"]
    assert sorted(run["names"]) == ["Different"] + ["One"] * 4 + ["Surface"] * 4 + ["Two"]
    of_name = {name: shape for name, shape in zip(run["names"], run["shapes"], strict=True)}
    assert of_name["One"] == of_name["Two"] != of_name["Different"]
    assert run["two"] == [[1, 0, 0, 5], [0, 1, 0, 6], [0, 0, 1, 7], [0, 0, 0, 1]]
    assert run["dtype"] == "float64"


def test_particles_and_geometry_nodes_instance_one_shape(run_blender):
    run = run_blender(
        START
        + """
leaf = scenes.quad("Leaf")
ground = scenes.quad("Ground")
ground.modifiers.new("Particles", "PARTICLE_SYSTEM")
settings = ground.particle_systems[0].settings
settings.type, settings.count, settings.render_type, settings.instance_object = "HAIR", 25, "OBJECT", leaf
bpy.context.view_layer.update()
sent = recording_core.export()[0]
names = sent.instances["names"]
report(leaves=names.count("Leaf"), ground=names.count("Ground"), meshes=sorted(m["name"] for m in sent.meshes))
ground.show_instancer_for_render = False
ground.show_instancer_for_viewport = False
bpy.context.view_layer.update()
report(hidden=recording_core.export()[0].instances["names"].count("Ground"))
"""
    ).report
    assert run == {"leaves": 26, "ground": 1, "meshes": ["Ground", "Leaf"], "hidden": 0}


def test_ray_visibility_holdout_pass_index_and_random_arrive(run_blender):
    run = run_blender(
        START
        + """
a, b, c = scenes.quad("A"), scenes.quad("B"), scenes.quad("Cube")
a.visible_camera = a.visible_shadow = False
b.is_holdout, b.pass_index = True, 7
bpy.context.view_layer.update()
sent = recording_core.export()[0]
table = sent.instances
at = table["names"].index
report(visibility=table["visibilities"][at("A")], index=table["object_indices"][at("B")], random=table["randoms"][at("Cube")])
holdout = sent.material_lists[table["material_lists"][at("B")]]
report(holdout=[line["op"] for line in sent.materials[holdout[0]]["surface"].lines])
"""
    ).report
    assert run["visibility"] == 63 - 1 - 16
    assert run["index"] == 7
    assert run["holdout"] == ["holdout"]
    assert run["random"] == pytest.approx(0.31314194)  # what Cycles' Object Info gives an object named Cube


def test_view_layers_hold_out_collections_and_show_them_indirectly_only(run_blender):
    run = run_blender(
        START
        + """
hole, indirect = bpy.data.collections.new("Hole"), bpy.data.collections.new("Indirect")
for collection in (hole, indirect):
    scene.collection.children.link(collection)
    scenes.add(scenes.quad("Kept").data, collection.name, collection)
layers = bpy.context.view_layer.layer_collection.children
layers["Hole"].holdout, layers["Indirect"].indirect_only = True, True
override = bpy.data.materials.new("Override")
bpy.context.view_layer.update()
sent = recording_core.export()[0]
table = sent.instances
at = table["names"].index
kept = table["material_lists"][at("Kept")]
report(hole=table["material_lists"][at("Hole")], kept=kept >= 0 and sent.material_lists[kept],
       bare=bpy.app.version >= (5, 0, 0) and [len(sent.materials) - 1],  # since 5.0 what has no material is Principled
       indirect=table["visibilities"][at("Indirect")])
bpy.context.view_layer.material_override = override
bpy.context.view_layer.update()
sent = recording_core.export()[0]
kept = sent.instances["material_lists"][sent.instances["names"].index("Kept")]
report(override=[sent.materials[m]["name"] for m in sent.material_lists[kept]])
"""
    ).report
    assert run["hole"] >= 0 and run["kept"] == run["bare"]
    assert run["indirect"] == 62
    assert run["override"] == ["Override"]


def test_materials_on_the_object_win_over_those_of_the_data(run_blender):
    run = run_blender(
        START
        + """
one = scenes.quad("One")
two = scenes.add(one.data, "Two")
of_data, of_object = bpy.data.materials.new("Of data"), bpy.data.materials.new("Of object")
one.data.materials.append(of_data)
two.material_slots[0].link = "OBJECT"
two.material_slots[0].material = of_object
collection = bpy.data.collections.new("Both")
collection.objects.link(two)
place = scenes.add(None, "Place")
place.instance_type, place.instance_collection = "COLLECTION", collection
bpy.context.view_layer.update()
sent = recording_core.export()[0]
table = sent.instances
report(materials=sorted([name, sent.materials[sent.material_lists[index][0]]["name"]]
       for name, index in zip(table["names"], table["material_lists"])), meshes=len(sent.meshes))
"""
    ).report
    assert run["materials"] == [["One", "Of data"], ["Two", "Of object"], ["Two", "Of object"]]
    assert run["meshes"] == 1


def test_a_hundred_thousand_instances_export_without_a_call_per_instance(run_blender):
    run = run_blender(
        START
        + """
import numpy as np
points = bpy.data.meshes.new("Points")
points.vertices.add(100_000)
points.vertices.foreach_set("co", np.random.default_rng(1).random(300_000).astype(np.float32))
holder = scenes.add(points, "Points")
holder.instance_type = "VERTS"
leaf = scenes.quad("Leaf")
leaf.parent = holder
bpy.context.view_layer.update()
sent, told, texts = recording_core.export()
report(instances=told.instances, shapes=told.shapes, left_out=told.left_out, texts=texts)
"""
    ).report
    assert (run["instances"], run["shapes"]) == (100_001, 1)
    assert run["left_out"] == {"Points": "no faces"}
    assert run["texts"] == ["Object 'Points' has no faces; left out"]


INSTANCERS = """
import bpy, scenes, recording_core
from rayleaf.export import CancelCheck, ExportCancelled, camera, instances
core = recording_core.install()
scene = scenes.empty_scene()
surface = scenes.surface("A surface")
points = scenes.mesh([(x, 0, 0) for x in range(30000)], [], "B points")
leaf = scenes.quad("C leaf")
leaf.parent, points.instance_type = points, "VERTS"
bpy.context.view_layer.update()
"""

WALKS = {
    "to its end": "recording_core.export()",
    "until the user stops": """
questions = iter([False, False, True])
try:
    instances.collect(core, bpy.context.evaluated_depsgraph_get(), CancelCheck(lambda: next(questions)))
    raise AssertionError("the user was not asked")
except ExportCancelled:
    pass
""",
    "until something fails": """
def fail(*arguments):
    raise core.InputError("bad")
instances._Collector.take = fail
try:
    recording_core.export()
    raise AssertionError("nothing failed")
except core.InputError:
    pass
""",
}


@pytest.mark.parametrize("walk", WALKS)
def test_blender_gets_its_list_of_instances_back(run_blender, walk):
    """When it ends, Blender says what was never freed."""
    quick = "import rayleaf.export\nrayleaf.export._LOOK_SECONDS = 0\n"
    run = run_blender(INSTANCERS + quick + WALKS[walk] + "\nreport(done=True)\n")
    assert run.report["done"]
    assert "Not freed memory blocks" not in run.log, run.log
