"""Inside Blender: makes curve objects of every setting and saves their definitions and Blender's meshes.

Usage: curve_oracle_script.py OUT.json ADDONS. The file holds a list of cases: what `curve_cases.py` asked for, with the points and
handles as Blender has them, the evaluated vertices in Blender's order, and of each vertex its distance from the surface that the
exporter and the core make of the curve.
"""

import base64
import json
import sys
from pathlib import Path

import bpy
import numpy as np

sys.path += [str(Path(__file__).resolve().parent), sys.argv[-1]]
from curve_cases import all_cases  # noqa: E402
from curve_objects import BEZIER_FIELDS, POINT_FIELDS, make_curve  # noqa: E402
from rayleaf import versions  # noqa: E402


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


# Facets are a small part of Blender's own: seen from near enough that a pixel is this wide, in units of the curves.
PIXEL = 2e-4
# How far from a vertex its rays begin, and how far they go beyond it.
REACH = 0.05
# Points are moved from their vertex by this part of the way to a face's middle, so that rays do not pass by an edge; where
# they do, by more.
INWARD = (0.002, 0.05)


def faces_by_vertices(mesh):
    """(vertices, 3) each: vertices, normals, and the middle of a face at each; NaN where there is none."""
    corners = np.empty(len(mesh.loops), np.int32)
    sizes, middles = np.empty(len(mesh.polygons), np.int32), np.empty(len(mesh.polygons) * 3, np.float32)
    vertices, normals = np.empty((2, len(mesh.vertices) * 3), np.float32)
    mesh.loops.foreach_get("vertex_index", corners)
    mesh.polygons.foreach_get("loop_total", sizes)
    mesh.polygons.foreach_get("center", middles)
    mesh.vertices.foreach_get("co", vertices)
    mesh.vertices.foreach_get("normal", normals)
    middle = np.full((len(mesh.vertices), 3), np.nan)
    middle[corners] = np.repeat(middles.reshape(-1, 3), sizes, axis=0)
    return vertices.reshape(-1, 3).astype(float), normals.reshape(-1, 3).astype(float), middle


def distances_along_rays(tracer, points, normals):
    """How far points are from what a tracer holds, along rays in several directions; infinite if none hits."""
    nearest = np.full(len(points), np.inf)
    for tilt in ((0, 0, 0), (0.6, 0.64, 0.48)):
        axes = normals + tilt
        lengths = np.linalg.norm(axes, axis=1, keepdims=True)
        axes = np.where(lengths > 0.1, axes / np.maximum(lengths, 0.1), (0.0, 0.0, 1.0))
        for sign, begin in ((-1.0, 0.0), (1.0, 0.0), (-1.0, REACH), (1.0, REACH)):
            hits = tracer.closest_hits(points - sign * begin * axes, sign * axes, t_max=begin + REACH)
            distance = np.linalg.norm(hits["position"] - points, axis=1)
            nearest = np.minimum(nearest, np.where(np.isfinite(hits["t"]), distance, np.inf))
    return nearest


def surface_distances(item, depsgraph):
    """(vertices, 2): how far Blender's mesh is from the core's surface near each vertex, and how far from the vertex that was."""
    from rayleaf import _core as core
    from rayleaf.export import curves

    evaluated = item.evaluated_get(depsgraph)
    judged = curves.judge(core, evaluated, evaluated.data)
    judged.settle(core)
    if judged.curve is None:
        return None
    vertices, normals, middles = faces_by_vertices(evaluated.to_mesh())
    evaluated.to_mesh_clear()
    shape = core.trace.SweptSurface(judged.curve)
    eye = tuple(vertices.mean(axis=0) + (0, 0, 1))
    tracer = core.trace.Tracer([(shape, np.eye(4), 31)], pixel_angle=PIXEL, eye=eye)
    result = np.full((len(vertices), 2), np.inf)
    for inward in INWARD:
        wanted = np.flatnonzero(np.isinf(result[:, 0]) & np.isfinite(middles).all(axis=1))
        move = inward * (middles - vertices)[wanted]
        result[wanted, 0] = distances_along_rays(tracer, vertices[wanted] + move, normals[wanted])
        result[wanted, 1] = np.linalg.norm(move, axis=1)
    return result


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
        if "widget" in case:  # the samples that Blender's mesh was made of
            samples = item.evaluated_get(depsgraph).data.bevel_profile.segments
            case["widget"] = [list(sample.location) for sample in samples]
        distances = surface_distances(item, depsgraph)
        case["distances"] = None if distances is None else packed(distances)
        case["settings"]["offset"] = item.data.offset
        case["closed_twist"] = versions.closed_twist()
    with open(sys.argv[-2], "w", encoding="utf-8") as file:
        json.dump(cases, file)


main()
