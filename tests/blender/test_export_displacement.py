"""The Displacement output of materials: which program and space arrive, and what is rendered."""

START = """
import bpy, scenes, recording_core

scene = scenes.empty_scene()

def displacing(kind, space, value, name="Material"):
    material, tree, output = scenes.material(name)
    node = tree.nodes.new(kind)
    node.space = space
    node.inputs[0].default_value = value
    node.inputs["Midlevel"].default_value, node.inputs["Scale"].default_value = 0.5, 2.0
    tree.links.new(node.outputs[0], output.inputs["Displacement"])
    scenes.set_displacement(material, "DISPLACEMENT")
    return material
"""


def test_the_materials_method_says_what_displacement_does(run_blender):
    run = run_blender(
        START
        + """
found = {}
for method in ("BUMP", "DISPLACEMENT", "BOTH"):
    material = displacing("ShaderNodeDisplacement", "OBJECT", 0.75, method)
    shader = material.node_tree.nodes.new("ShaderNodeBsdfDiffuse")
    output = material.node_tree.get_output_node("CYCLES")
    material.node_tree.links.new(shader.outputs[0], output.inputs["Surface"])
    scenes.set_displacement(material, method)
    scenes.quad(method).data.materials.append(material)
sent, told, messages = recording_core.export()
for material in sent.materials:
    program = material["surface"]
    (diffuse,) = [line for line in program.lines if line["op"] == "diffuse"]
    normal = program.operands(diffuse)[3]
    found[material["name"]] = [material["displacement"] is not None, normal and normal["op"]]
report(found=found, messages=messages)
"""
    ).report
    assert run["messages"] == []
    assert run["found"] == {"BUMP": [False, "bump"], "DISPLACEMENT": [True, None], "BOTH": [True, None]}


def test_a_material_as_blender_makes_it_is_bumped(run_blender):
    run = run_blender(
        START
        + """
from rayleaf import versions
import addon_utils
found = []
for enabled in (True, False):
    (addon_utils.enable if enabled else addon_utils.disable)("cycles")
    found.append([versions.displacement_method(bpy.data.materials.new("New"))])
    for method in ("DISPLACEMENT", "BOTH", "BUMP"):
        material = bpy.data.materials.new(method)
        scenes.set_displacement(material, method)
        if not enabled:
            addon_utils.disable("cycles")
        found[-1].append(versions.displacement_method(material))
report(found=found)
"""
    ).report
    assert run["found"] == [["BUMP", "DISPLACEMENT", "BOTH", "BUMP"]] * 2


def test_both_nodes_arrive_in_their_space(run_blender):
    run = run_blender(
        START
        + """
found = {}
for kind, value in (("ShaderNodeDisplacement", 0.75), ("ShaderNodeVectorDisplacement", (1, 0, 0, 0))):
    for space in ("OBJECT", "WORLD") + (("TANGENT",) if "Vector" in kind else ()):
        item = scenes.surface(f"{kind} {space}")
        item.data.materials.append(displacing(kind, space, value, f"{kind} {space}"))
sent, told, messages = recording_core.export()
for material in sent.materials:
    program, object_space, world_space = material["displacement"]
    found[material["name"]] = [object_space >= 0, world_space >= 0, [line["op"] for line in program.lines]]
report(found=found, messages=messages)
"""
    ).report
    found = run["found"]
    assert run["messages"] == []
    for kind in ("ShaderNodeDisplacement", "ShaderNodeVectorDisplacement"):
        assert found[f"{kind} OBJECT"][:2] == [True, False] and found[f"{kind} WORLD"][:2] == [False, True]
    in_object, in_world, operations = found["ShaderNodeVectorDisplacement TANGENT"]
    assert in_object and not in_world and operations[-1] == "from_tangent_space"
    assert "object_normal" in found["ShaderNodeDisplacement OBJECT"][2]
    assert "normal" in found["ShaderNodeDisplacement WORLD"][2]


def test_every_surface_is_displaced_and_of_a_curve_it_is_told_that_it_is_not(run_blender):
    run = run_blender(
        START
        + """
material = displacing("ShaderNodeDisplacement", "OBJECT", 1.0)
plain, fine, simple, still = (scenes.quad(name) for name in ("Plain", "Fine", "Simple", "Still"))
fine.modifiers.new("Subdivision", "SUBSURF").levels = 1
simple.modifiers.new("Subdivision", "SUBSURF").subdivision_type = "SIMPLE"
bpy.ops.curve.primitive_bezier_circle_add()
wire = bpy.context.object
wire.name, wire.data.bevel_depth = "Wire", 0.1
for item in (plain, fine, simple, wire):
    item.data.materials.append(material)
sent, told, messages = recording_core.export()
schemes = {cage["name"]: cage.get("scheme", "CATMULL_CLARK") for cage in sent.cages}
report(messages=messages, schemes=schemes, meshes=[mesh["name"] for mesh in sent.meshes])
"""
    ).report
    (message,) = run["messages"]
    assert message == "Object 'Wire': curves, hair and points are not displaced; left out"
    assert run["schemes"] == {"Plain": "BILINEAR", "Simple": "BILINEAR", "Fine": "CATMULL_CLARK"}
    assert run["meshes"] == ["Still"]


def test_two_objects_share_a_curve_of_which_one_has_a_displacing_material(run_blender):
    run = run_blender(
        START
        + """
bpy.ops.curve.primitive_bezier_circle_add()
wire = bpy.context.object
wire.name, wire.data.bevel_depth = "Wire", 0.1
twin = bpy.data.objects.new("Twin", wire.data)
bpy.context.collection.objects.link(twin)
wire.data.materials.append(scenes.material("Matte")[0])
twin.material_slots[0].link = "OBJECT"
twin.material_slots[0].material = displacing("ShaderNodeDisplacement", "OBJECT", 1.0)
sent, told, messages = recording_core.export()
report(messages=messages, exact=sorted(told.exact), shapes=told.shapes, instances=told.instances, meshes=len(sent.meshes))
"""
    ).report
    assert run["messages"] == ["Object 'Twin': curves, hair and points are not displaced; left out"]
    assert run["exact"] == ["Twin", "Wire"] and run["meshes"] == 0
    assert run["shapes"] == 1 and run["instances"] == 2


def test_a_render_shows_a_sphere_grown_by_its_displacement(run_blender):
    run = run_blender(
        START
        + """
import numpy as np
from pathlib import Path
bpy.ops.surface.primitive_nurbs_surface_sphere_add()
sphere = bpy.context.object
sphere.data.materials.append(displacing("ShaderNodeDisplacement", "OBJECT", 0.75))
scene.camera.location = (0, 0, 10)
scene.camera.data.type, scene.camera.data.ortho_scale = "ORTHO", 4
scene.render.film_transparent = True
scene.render.resolution_x = scene.render.resolution_y = 32
scene.rayleaf.samples = 4
path = Path(bpy.app.tempdir) / "picture.exr"
scene.render.filepath, scene.render.image_settings.file_format = str(path), "OPEN_EXR"
bpy.ops.render.render(write_still=True)
image = bpy.data.images.load(str(path))
alpha = np.array(image.pixels[:]).reshape(32, 32, 4)[..., 3]
report(area=float(alpha.sum() * (4 / 32) ** 2))
"""
    ).report
    # A circle of radius 1 + (0.75 - 0.5) * 2.
    assert abs(run["area"] - 3.14159 * 1.5**2) < 0.15


def test_an_unknown_vector_displaces_by_nothing(run_blender):
    run = run_blender(
        START
        + """
item = scenes.surface("Surface")
material, tree, output = scenes.material()
item.data.materials.append(material)
unknown = tree.nodes.new("ShaderNodeUVAlongStroke")
tree.links.new(unknown.outputs["UV"], output.inputs["Displacement"])
scenes.set_displacement(material, "DISPLACEMENT")
sent, _, texts = recording_core.export()
program, object_space, world_space = sent.materials[0]["displacement"]
report(object_space=object_space, vector=program.registers[world_space], texts=texts)
"""
    ).report
    assert (run["object_space"], run["vector"]) == (-1, [0, 0, 0, 0])
    assert len(run["texts"]) == 1 and "'UV Along Stroke'" in run["texts"][0]


def test_displacement_that_the_core_rejects_leaves_the_surface_as_it_is(run_blender):
    run = run_blender(
        START
        + """
item = scenes.surface("Surface")
item.data.materials.append(displacing("ShaderNodeDisplacement", "OBJECT", 1.0))
core = recording_core.install()
recording_core.install = lambda: core
whole = core.Program.operation
def refuse(self, identifier, *arguments, **more):
    if identifier == "object_normal":
        raise core.InputError("no normals here")
    return whole(self, identifier, *arguments, **more)
core.Program.operation = refuse
sent, _, texts = recording_core.export()
report(materials=[[each["name"], each["displacement"]] for each in sent.materials], lists=sent.material_lists, texts=texts)
"""
    ).report
    assert run["materials"] == [["Material", None]] and run["lists"] == [[0]]
    assert len(run["texts"]) == 1 and "no normals here" in run["texts"][0] and "displacement" in run["texts"][0]
