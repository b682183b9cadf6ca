"""Inside Blender: makes curve objects of every setting and saves their definitions and Blender's meshes.

Usage: curve_oracle_script.py OUT.json. The file holds a list of cases: what `curve_cases.py` asked for, with the points and
handles as Blender has them, and the evaluated vertices in Blender's order.
"""

import base64
import json
import sys
from pathlib import Path

import bpy
import numpy as np

sys.path.append(str(Path(__file__).resolve().parent))
from curve_cases import all_cases  # noqa: E402

BEZIER_FIELDS = (("co", 3), ("handle_left", 3), ("handle_right", 3), ("radius", 1), ("tilt", 1))
POINT_FIELDS = (("co", 4), ("radius", 1), ("tilt", 1))


def set_all(target, values):
    for name, value in values.items():
        setattr(target, name, value)


def add_spline(curve, wanted):
    """Append one spline as the case describes it."""
    spline = curve.splines.new(wanted["type"])
    points = spline.bezier_points if wanted["type"] == "BEZIER" else spline.points
    points.add(len(wanted["co"]) - 1)
    for name, width in BEZIER_FIELDS if wanted["type"] == "BEZIER" else POINT_FIELDS:
        if name in wanted:
            points.foreach_set(name, np.asarray(wanted[name], np.float32).ravel())
    for side in ("left", "right"):
        for point, kind in zip(points, wanted.get(f"handle_{side}_type", ())):
            setattr(point, f"handle_{side}_type", kind)
    set_all(spline, wanted.get("settings", {}))


def add_object(name, data):
    item = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(item)
    return item


def make_curve(case, helpers):
    """The object of a case; `helpers` are the bevel and taper objects made so far."""
    curve = bpy.data.curves.new(case["name"], "CURVE")
    settings = dict(case["settings"])
    curve.dimensions = settings.pop("dimensions", "3D")
    for key in ("bevel_object", "taper_object"):
        if settings.get(key):
            settings[key] = helpers[settings[key]]
    set_all(curve, settings)
    for wanted in case["splines"]:
        add_spline(curve, wanted)
    item = add_object(case["name"], curve)
    item.scale = case.get("scale", (1, 1, 1))
    return item


def packed(values):
    """Arrays as text: a JSON of numbers would be large and inexact."""
    return base64.b64encode(np.ascontiguousarray(values).tobytes()).decode()


def described(spline):
    """A spline as Blender has it now."""
    is_bezier = spline.type == "BEZIER"
    points = spline.bezier_points if is_bezier else spline.points
    result = {"type": spline.type, "cyclic": spline.use_cyclic_u, "resolution": spline.resolution_u}
    for name, width in BEZIER_FIELDS if is_bezier else POINT_FIELDS:
        values = np.empty(len(points) * width, np.float32)
        points.foreach_get(name, values)
        result[name] = packed(values)
    result["flags"] = [spline.order_u, spline.use_cyclic_u, spline.use_endpoint_u, spline.use_bezier_u]
    result["tilt_mode"], result["radius_mode"] = spline.tilt_interpolation, spline.radius_interpolation
    if is_bezier:
        result["vector"] = [[p.handle_left_type == "VECTOR", p.handle_right_type == "VECTOR"] for p in points]
    return result


def evaluated(item, depsgraph):
    """Vertices, corners of the faces, UVs."""
    mesh = item.evaluated_get(depsgraph).to_mesh()
    vertices = np.empty(len(mesh.vertices) * 3, np.float32)
    mesh.vertices.foreach_get("co", vertices)
    quads = [list(face.vertices) for face in mesh.polygons[:1]]
    uv = np.empty(len(mesh.loops) * 2, np.float32)
    loop_vertices = np.empty(len(mesh.loops), np.int32)
    if mesh.uv_layers:
        mesh.uv_layers[0].data.foreach_get("uv", uv)
    mesh.loops.foreach_get("vertex_index", loop_vertices)
    triangles_from = [len(face.vertices) for face in mesh.polygons]
    item.evaluated_get(depsgraph).to_mesh_clear()
    return {
        "vertices": packed(vertices),
        "first_face": quads,
        "uv": packed(uv),
        "loop_vertices": packed(loop_vertices),
        "face_sizes": triangles_from,
    }


def main():
    bpy.ops.wm.read_factory_settings(use_empty=True)
    helpers, items = {}, []
    cases = all_cases()
    for case in cases:
        item = make_curve(case, helpers)
        if case.get("helper"):
            helpers[case["name"]] = item
        items.append(item)
    bpy.context.view_layer.update()
    depsgraph = bpy.context.evaluated_depsgraph_get()
    for case, item in zip(cases, items):
        case["splines"] = [described(spline) for spline in item.data.splines]
        case["mesh"] = evaluated(item, depsgraph)
        case["settings"]["offset"] = item.data.offset
    with open(sys.argv[-1], "w", encoding="utf-8") as file:
        json.dump(cases, file)


main()
