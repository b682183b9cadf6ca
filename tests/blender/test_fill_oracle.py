"""Filled areas and texts from their outlines look like Blender's mesh of them at a high resolution."""

import numpy as np

SCRIPT = """
import sys
import bpy, scenes
import numpy as np
from rayleaf import _core as core
from rayleaf.export import camera
from rayleaf.export.scene import SceneExporter
from rayleaf.messages import Messages

TURN = np.arange(5) * 2 * np.pi / 5

def flower(name, parts, kind="BEZIER", **settings):
    # A spline for each (size, x, material).
    data = bpy.data.curves.new(name, "CURVE")
    data.dimensions = "2D"
    radius = settings.pop("radius", None)
    for key, value in settings.items():
        setattr(data, key, value)
    for size, x, slot in parts:
        spline = data.splines.new(kind)
        own = spline.bezier_points if kind == "BEZIER" else spline.points
        own.add(len(TURN) - 1)
        spline.use_cyclic_u, spline.material_index, spline.resolution_u = True, slot, 64
        for point, angle in zip(own, TURN * (1 if size > 0.5 else -1)):
            point.co = (x + size * np.cos(angle), size * np.sin(angle), 0, 1)[: 3 if kind == "BEZIER" else 4]
            if radius is not None:
                point.radius = radius
            if kind == "BEZIER":
                point.handle_left_type = point.handle_right_type = "AUTO"
    return scenes.add(data, name)

def text(name, body, **settings):
    data = bpy.data.curves.new(name, "FONT")
    data.body, data.resolution_u = body, 64
    for key, value in settings.items():
        setattr(data, key, value)
    return scenes.add(data, name)

def helper(name, points, cyclic):
    data = bpy.data.curves.new(name, "CURVE")
    data.dimensions, data.fill_mode = "2D", "NONE"
    spline = data.splines.new("POLY")
    spline.points.add(len(points) - 1)
    spline.points.foreach_set("co", [value for point in points for value in (*point, 0, 1)])
    spline.use_cyclic_u = cyclic
    item = scenes.add(data, name)
    item.location = (0, 0, -50)
    return item

DISK, RING = [(0.9, 0, 1)], [(0.9, 0, 1), (0.45, 0, 2)]
TWO = [(0.9, 0, 1), (0.5, 0.1, 2), (0.28, 0.1, 0), (0.4, 1.7, 2)]

def make():
    scenes.empty_scene()
    for slot in range(3):
        bpy.data.materials.new(f"slot {slot}").pass_index = slot + 1
    lip = helper("Lip", [(0.0, -0.3), (0.1, -0.1), (0.05, 0.2)], False)
    tube = helper("Tube", [(0.0, -0.1), (0.1, 0.0), (0.0, 0.1)], True)
    made = [
        flower("flat", RING, fill_mode="FRONT"), flower("flat back", RING, fill_mode="BACK"),
        flower("moved", RING, fill_mode="BOTH", offset=0.05),
        flower("none", RING, fill_mode="NONE", extrude=0.2), flower("extruded", TWO, fill_mode="BOTH", extrude=0.2),
        flower("front", RING, fill_mode="FRONT", extrude=0.2, bevel_depth=0.06),
        flower("back", RING, fill_mode="BACK", extrude=0.2, bevel_depth=0.06),
        flower("bevelled", TWO, fill_mode="BOTH", extrude=0.1, bevel_depth=0.06, offset=-0.03),
        flower("inward", DISK, fill_mode="BOTH", extrude=0.2, bevel_depth=-0.06),
        flower("thick", DISK, fill_mode="BOTH", extrude=0.1, bevel_depth=0.06, radius=2.0),
        flower("poly", RING, "POLY", fill_mode="BOTH", extrude=0.2, bevel_depth=0.03),
        flower("NURBS", RING, "NURBS", fill_mode="BOTH", extrude=0.2),
        flower("lip", RING, fill_mode="BOTH", bevel_mode="OBJECT", bevel_object=lip),
        flower("tube", RING, fill_mode="BOTH", bevel_mode="OBJECT", bevel_object=tube),
        flower("widget", RING, fill_mode="BOTH", bevel_mode="PROFILE", bevel_depth=0.1, extrude=0.1),
        text("text", "g&8", size=1.6, align_x="CENTER"),
        text("solid text", "Bo%", extrude=0.1, bevel_depth=0.02, align_x="CENTER"),
        text("close text", "AVAT", extrude=0.1, space_character=0.8, align_x="CENTER"), text("no text", " "),
    ]
    for item in made:
        item.data.bevel_resolution = 32
        for slot in range(3):
            item.data.materials.append(bpy.data.materials[f"slot {slot}"])
    for number, item in enumerate(made):
        item.location = (3.4 * (number % 6), 2.6 * (number // 6), 0)
    bpy.context.view_layer.update()
    return made

def rendered(turn):
    exporter = SceneExporter(core, bpy.context.evaluated_depsgraph_get(), Messages())
    description = exporter.export(camera.frame_of(bpy.context.scene), needs_uv=False)
    names = ["depth", "normal", "material_index", "object_index"]
    settings = core.Settings(width=600, height=300, samples=1, filter_width=0.0, passes=names)
    session = core.Session(description, settings)
    session.render()
    return exporter.report, {name: session.pass_pixels(name) for name in names}

made = make()
scene = bpy.context.scene
scene.render.resolution_x, scene.render.resolution_y = 600, 300
view = bpy.data.cameras.new("view")
view.type, view.ortho_scale = "ORTHO", 21
eye = scenes.add(view, "view")
scene.camera = eye
meshes = []
for item in made:
    mesh = bpy.data.meshes.new_from_object(item.evaluated_get(bpy.context.evaluated_depsgraph_get()))
    if mesh.polygons:
        other = scenes.add(mesh, item.name + " mesh")
        other.location = item.location
        meshes.append(other)
for number, item in enumerate(made):
    item.pass_index = number + 1
result = []
VIEWS = [((8.5, 2.5, 20), (0, 0, 0)), ((8.5, -12, 15), (0.75, 0, 0)), ((8.5, -12, -15), (2.4, 0, 0))]
for number, (location, rotation) in enumerate(VIEWS):
    eye.location, eye.rotation_euler = location, rotation
    told = []
    for exact in (True, False):
        for item in made:
            item.hide_viewport = item.hide_render = not exact
        for item in meshes:
            item.hide_viewport = item.hide_render = exact
        bpy.context.view_layer.update()
        how, passes = rendered(number)
        np.savez(f"{sys.argv[1]}/{number} {'exact' if exact else 'mesh'}.npz", **passes)
        told.append(dict(exact=sorted(how.exact), evaluated=how.evaluated))
    result.append(told)
report(told=result[0], names=[item.name for item in made])
"""
VIEWS = ("above", "front", "below")
# The areas' normal on the camera's side, world space.
UP = {"above": (0, 0, 1), "front": (0, 0, 1), "below": (0, 0, -1)}


def check_same(view, exact, mesh, inward):
    """That two pictures show the same, but for edges, where a pixel may show what lies beside it (they are a thirtieth of
    a unit wide)."""
    covered = mesh["material_index"][..., 0] > 0
    assert covered.mean() > 0.1, view
    edges = np.zeros_like(covered)
    for axis in (0, 1):
        for step in (-1, 1):
            edges |= np.abs(np.roll(mesh["normal"], step, axis) - mesh["normal"]).max(axis=-1) > 0.1
            edges |= np.roll(mesh["material_index"], step, axis)[..., 0] != mesh["material_index"][..., 0]
    flat = (np.abs(mesh["normal"] @ UP[view]) > 0.999) & (exact["object_index"][..., 0] != inward)
    differs = {
        "material": exact["material_index"][..., 0] != mesh["material_index"][..., 0],
        "depth": np.abs(exact["depth"] - mesh["depth"])[..., 0] > 0.01,
        # Of the areas alone: across corners of walls Blender blends normals, the exact surface has an edge there.
        "normal": (np.abs(exact["normal"] - mesh["normal"]).max(axis=-1) > 0.1) & flat,
    }
    for name, wrong in differs.items():
        places = np.argwhere(wrong & ~edges)
        assert len(places) < 1e-3 * covered.sum(), f"{view}: {name} differs at {len(places)}: {places[:5].tolist()}"
        assert np.count_nonzero(wrong) < 0.05 * covered.sum(), f"{view}: {name}"


def test_filled_areas_and_texts_from_outlines_look_like_blenders_mesh(run_blender, tmp_path):
    run = run_blender(SCRIPT, tmp_path)
    assert run.report["told"][0]["evaluated"] == {}
    assert set(run.report["names"]) - set(run.report["told"][0]["exact"]) == {"no text"}
    inward = run.report["names"].index("inward") + 1  # its walls end level with the area, and Blender blends there too
    for number, view in enumerate(VIEWS):
        check_same(view, *(np.load(tmp_path / f"{number} {kind}.npz") for kind in ("exact", "mesh")), inward)
