"""Surfaces as exact splines, everything else as its evaluated mesh."""

import numpy as np

SPLINES = """
import bpy, scenes, recording_core

def told(spline):
    return dict(points=spline.points.tolist(), order=[spline.order_u, spline.order_v], **spline.flags)

scene = scenes.empty_scene()
"""


def test_a_surface_arrives_as_its_splines_with_every_flag(run_blender):
    run = run_blender(
        SPLINES
        + """
bpy.ops.surface.primitive_nurbs_surface_sphere_add()
sphere = bpy.context.object
sphere.data.splines[0].points[3].co = (1, 2, 3, 0.5)
(sent,) = recording_core.export()[0].surfaces
(spline,) = sent["splines"]
report(spline=told(spline))
"""
    )
    spline = run.report["spline"]
    points = np.array(spline["points"])
    assert points.shape == (8, 5, 4)  # V, U
    assert points[0, 3].tolist() == [1, 2, 3, 0.5]
    assert spline["order"] == [3, 3]
    flags = ["cyclic_u", "cyclic_v", "endpoint_u", "endpoint_v", "bezier_u", "bezier_v", "smooth", "material_slot"]
    assert [spline[flag] for flag in flags] == [False, True, True, True, True, True, True, 0]


def test_relative_shape_keys_move_the_control_points_as_they_move_blenders_mesh(run_blender):
    run = run_blender(
        SPLINES
        + """
import numpy as np
item = scenes.surface()
item.shape_key_add(name="Basis")
up, side = item.shape_key_add(name="Up"), item.shape_key_add(name="Side")
for number, point in enumerate(up.data):
    point.co.z += 1 + number
for point in side.data:
    point.co.x += 10
side.relative_key = up
up.value, side.value = 0.5, 0.25
(sent,) = recording_core.export()[0].surfaces
basis = np.array([point.co for point in item.data.splines[0].points])[:, :3]
moved = sent["splines"][0].points.reshape(-1, 4)[:, :3]
# Blender's own word: with both keys the mesh of an order-2, endpoint surface passes through its control points.
item.data.splines[0].order_u = item.data.splines[0].order_v = 2
item.data.splines[0].use_endpoint_u = item.data.splines[0].use_endpoint_v = True
item.data.resolution_u = item.data.resolution_v = 1
item.data.splines[0].resolution_u = item.data.splines[0].resolution_v = 1
bpy.context.view_layer.update()
mesh = item.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
vertices = np.array([vertex.co for vertex in mesh.vertices])
report(moved=moved.tolist(), vertices=vertices.tolist(), changed=float(abs(moved - basis).max()))
item.show_only_shape_key, item.active_shape_key_index = True, 1
(sent,) = recording_core.export()[0].surfaces
report(pinned=(sent["splines"][0].points.reshape(-1, 4)[:, 2] - basis[:, 2]).tolist())
"""
    ).report
    moved, vertices = np.array(run["moved"]), np.array(run["vertices"])
    assert run["changed"] > 1
    for point in moved:
        assert np.abs(vertices - point).max(axis=1).min() < 1e-5, point
    assert run["pinned"] == [1 + number for number in range(16)]


def test_a_surface_with_a_modifier_goes_as_a_mesh_and_the_report_says_why(run_blender):
    run = run_blender(
        SPLINES
        + """
exact, changed, off = scenes.surface("Exact"), scenes.surface("Changed"), scenes.surface("Switched off")
changed.modifiers.new("Thick", "SOLIDIFY")
off.modifiers.new("Thick", "SOLIDIFY").show_render = False
for item in (off,):
    item.modifiers[0].show_viewport = False
sent, told, _ = recording_core.export()
report(surfaces=[s["name"] for s in sent.surfaces], meshes=[m["name"] for m in sent.meshes],
       exact=told.exact, evaluated=told.evaluated, names=sent.instances["names"])
"""
    ).report
    assert sorted(run["surfaces"]) == sorted(run["exact"]) == ["Exact", "Switched off"]
    assert run["meshes"] == ["Changed"]
    assert run["evaluated"] == {"Changed": "modifier Thick"}
    assert sorted(run["names"]) == ["Changed", "Exact", "Switched off"]


def test_each_curve_surface_text_and_metaball_is_taken_exactly_once(run_blender):
    run = run_blender(
        SPLINES
        + """
scenes.surface("Surface")
bpy.ops.curve.primitive_bezier_circle_add()
bpy.context.object.name, bpy.context.object.data.bevel_depth = "Tube", 0.1
bpy.ops.curve.primitive_bezier_circle_add()
bpy.context.object.name = "Thread"
bpy.ops.object.text_add()
bpy.ops.object.metaball_add()
sent, told, _ = recording_core.export()
report(names=sent.instances["names"], left_out=told.left_out)
"""
    ).report
    assert sorted(run["names"]) == ["Mball", "Surface", "Text", "Tube"]
    assert run["left_out"] == {"Thread": "curve without faces"}


def test_a_meshs_triangles_slots_and_flat_faces_arrive(run_blender):
    run = run_blender(
        SPLINES
        + """
item = scenes.mesh([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (2, 0, 0)], [(0, 1, 2, 3), (1, 4, 2)])
for _ in range(2):
    item.data.materials.append(bpy.data.materials.new("Any"))
item.data.polygons[1].material_index = 1
sent = recording_core.export()[0]
(mesh,) = sent.meshes
report(**{key: mesh[key].tolist() for key in ("vertices", "triangles", "material_slots")},
       normals=mesh["corner_normals"], dtypes=[str(mesh[key].dtype) for key in ("vertices", "triangles", "material_slots")])
"""
    ).report
    assert run["vertices"] == [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 0, 0]]
    assert run["material_slots"] == [0, 0, 1]
    assert {tuple(sorted(triangle)) for triangle in run["triangles"]} <= {
        (0, 1, 2),
        (0, 2, 3),
        (0, 1, 3),
        (1, 2, 3),
        (1, 2, 4),
    }
    assert run["normals"] is None
    assert run["dtypes"] == ["float32", "int32", "int32"]


def test_normals_of_one_mesh_have_the_same_bits_each_time(run_blender):
    run = run_blender(
        SPLINES
        + """
import numpy as np
from rayleaf.export.corner_normals import corner_normals
side = 400
y, x = np.mgrid[:side, :side]
z = np.random.default_rng(1).normal(size=x.shape) * 0.2
at = np.arange(side * side).reshape(side, side)
faces = np.stack([at[:-1, :-1], at[:-1, 1:], at[1:, 1:], at[1:, :-1]], axis=-1).reshape(-1, 4)
item = scenes.mesh(np.stack([x, y, z], axis=-1).reshape(-1, 3).tolist(), faces.tolist())
item.data.polygons.foreach_set("use_smooth", np.ones(len(faces), bool))
found, blenders = [], []
for _ in range(6):
    mesh = item.data.copy()  # whose normals are made anew
    mesh.update()
    found.append(corner_normals(mesh))
    normals = np.empty((len(mesh.vertices), 3), np.float32)
    mesh.vertices.foreach_get("normal", normals.ravel())
    blenders.append(normals[faces.ravel()])
report(differing=[int((each != found[0]).sum()) for each in found],
       farthest=max(float(np.abs(a - b).max()) for a, b in zip(found, blenders)))
"""
    ).report
    assert run["differing"] == [0] * 6
    # Blender's are off by the rounding of coordinates, which are up to 400 faces here: it multiplies them as they are.
    assert run["farthest"] < 2e-4


def test_smooth_sharp_and_custom_normals_are_those_blender_shades_with(run_blender):
    run = run_blender(
        SPLINES
        + """
import numpy as np
# Two faces that meet at a right angle along the edge 0-1.
faces = [(0, 1, 2), (1, 0, 3)]
vertices = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]

def normals(item):
    bpy.context.view_layer.update()
    mesh = next(m for m in recording_core.export()[0].meshes if m["name"] == item.name)
    return None if mesh["corner_normals"] is None else mesh["corner_normals"].round(5).tolist()

item = scenes.mesh(vertices, faces, "Roof")
item.data.polygons[0].use_smooth = item.data.polygons[1].use_smooth = True
report(smooth=normals(item))
item.data.polygons[1].use_smooth = False
report(mixed=normals(item))
item.data.polygons[1].use_smooth = True
scenes.sharpen_edges_above(item, 0.5)
report(sharp=normals(item))
item.data.normals_split_custom_set([(0.6, 0, 0.8)] * 6)
report(custom=normals(item))
"""
    ).report
    half = 0.70711
    first, second = run["smooth"]
    assert first[0] == first[1] == second[0] == second[1]
    assert np.allclose(np.abs(first[0]), [0, half, half], atol=1e-4)
    assert np.allclose(run["mixed"][1], [run["mixed"][1][0]] * 3) and abs(abs(run["mixed"][1][0][1]) - 1) < 1e-4
    assert np.allclose(np.abs(run["sharp"][0]), [[0, 0, 1]] * 3) and np.allclose(
        np.abs(run["sharp"][1]), [[0, 1, 0]] * 3
    )
    assert np.allclose(run["custom"], np.broadcast_to([0.6, 0, 0.8], (2, 3, 3)), atol=1e-3)  # stored with 16 bits


def test_uv_maps_and_colour_attributes_of_both_domains_arrive_if_a_material_reads_them(run_blender):
    run = run_blender(
        SPLINES
        + """
item = scenes.quad()
second = item.data.uv_layers.new(name="Second")
for loop, value in zip(second.data, range(4)):
    loop.uv = (value, -value)
corner = item.data.color_attributes.new("Corner", "BYTE_COLOR", "CORNER")
point = item.data.color_attributes.new("Point", "FLOAT_COLOR", "POINT")
face = item.data.attributes.new("Face", "FLOAT", "FACE")
face.data[0].value = 7
unread = item.data.color_attributes.new("Unread", "FLOAT_COLOR", "POINT")
for number in range(4):
    corner.data[number].color = (0.5, number / 4, 0, 1)
    point.data[number].color = (number, 2, 3, 0.5)
material, tree, output = scenes.material()
item.data.materials.append(material)
mix = [tree.nodes.new("ShaderNodeMixRGB") for _ in range(5)]
sources = []
for name in ("Corner", "Point"):
    sources.append(tree.nodes.new("ShaderNodeVertexColor"))
    sources[-1].layer_name = name
sources.append(tree.nodes.new("ShaderNodeAttribute"))
sources[-1].attribute_name = "Face"
sources.append(tree.nodes.new("ShaderNodeUVMap"))
sources[-1].uv_map = "Second"
sources.append(tree.nodes.new("ShaderNodeTexCoord"))
outputs = [s.outputs[0] for s in sources[:4]] + [sources[4].outputs["UV"]]
last = None
for node, source in zip(mix, outputs):
    tree.links.new(source, node.inputs["Color1"])
    if last:
        tree.links.new(last.outputs[0], node.inputs["Color2"])
    last = node
shader = tree.nodes.new("ShaderNodeEmission")
tree.links.new(last.outputs[0], shader.inputs["Color"])
tree.links.new(shader.outputs[0], output.inputs["Surface"])
sent = recording_core.export()[0]
(mesh,) = sent.meshes
names = {identifier: name for name, identifier in sent.attributes.items()}
by_vertex = {}
for identifier, values in mesh["attributes"].items():
    by_vertex[names[identifier]] = {int(v): values[t][c].round(4).tolist()
        for t, triangle in enumerate(mesh["triangles"]) for c, v in enumerate(triangle)}
report(names=sorted(by_vertex), by_vertex=by_vertex, uv=names[mesh["uv"]], linear=list(corner.data[0].color))
"""
    ).report
    values = run["by_vertex"]
    assert run["names"] == ["\nactive uv", "Corner", "Face", "Point", "Second"]
    assert run["uv"] == "\nactive uv"
    assert values["\nactive uv"] == {"0": [0, 0], "1": [1, 0], "2": [1, 1], "3": [0, 1]}
    assert values["Second"] == {str(n): [n, -n] for n in range(4)}
    assert values["Point"]["3"] == [3, 2, 3, 0.5]
    assert values["Face"]["2"] == [7, 7, 7]
    assert np.allclose(values["Corner"]["0"], run["linear"], atol=1e-4)


def test_a_scene_whose_materials_read_no_uv_map_sends_none(run_blender):
    run = run_blender(
        SPLINES
        + """
scenes.quad()
(mesh,) = recording_core.export()[0].meshes
report(uv=mesh["uv"], attributes=list(mesh["attributes"]))
"""
    ).report
    assert run == {"uv": -1, "attributes": []}
