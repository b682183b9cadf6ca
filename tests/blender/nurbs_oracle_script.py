"""Inside Blender: tessellates NURBS surfaces and curves of every kind and saves control points, settings and vertices.

Usage: nurbs_oracle_script.py OUT.npz. Arrays hold all cases end to end; NAME_size tells how much of NAME each case has.
"""

import itertools
import sys

import bpy
import numpy as np

FLAGS = ("cyclic", "endpoint", "bezier")
ORDERS = (2, 3, 4, 5, 6)
# In both directions every order has a count that cyclic Bezier knots allow. The small ones meet the limits of the orders.
SURFACE_COUNTS = ((6, 8), (10, 6), (8, 12), (5, 10))
SMALL_COUNTS = ((2, 2), (3, 2), (2, 4), (4, 3), (5, 4))
CURVE_COUNTS = (2, 3, 4, 5, 6, 7, 8, 10, 12, 13)
RESOLUTION_U, RESOLUTION_V = 2, 3
STORED_ORDER = 0  # stands for: leave the order that the new spline has, which may be larger than its point count


def add_grid(surface_object, count_u, count_v):
    """Append a NURBS grid to an empty SURFACE object that is linked to the scene; its points are still to be set."""
    curve = surface_object.data
    bpy.context.view_layer.objects.active = surface_object
    # Rows of two points do not merge; a row that is extruded becomes two.
    rows, length = (1, count_u) if count_v == 2 else (count_u, count_v)
    for row in range(rows):
        spline = curve.splines.new("NURBS")
        spline.points.add(length - 1)
        spline.points.foreach_set("co", [x for i in range(length) for x in (float(row), 0.01 * i, 0.0, 1.0)])
        spline.points.foreach_set("select", [True] * length)
    bpy.ops.object.mode_set(mode="EDIT")
    if count_v == 2:
        bpy.ops.curve.extrude()
    else:
        bpy.ops.curve.make_segment()
    bpy.ops.object.mode_set(mode="OBJECT")
    spline = curve.splines[-1]
    assert (len(curve.splines), spline.point_count_u, spline.point_count_v) == (1, count_u, count_v)


def random_points(rng, count):
    """Random coordinates and weights, as floats."""
    points = rng.uniform(-1, 1, (count, 4)).astype(np.float32)
    points[:, 3] = 4.0 ** rng.uniform(-1, 1, count)
    return points


def link(name, data):
    item = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(item)
    return item


def surface_settings(small):
    """Yield (flags_u, flags_v, order_u, order_v)."""
    flags = list(itertools.product((False, True), repeat=3))
    if small:
        for both, order in itertools.product(flags, (STORED_ORDER, *ORDERS)):
            yield both, both, order, order
        return
    orders = list(itertools.product(ORDERS, repeat=2))
    for number, (flags_u, flags_v) in enumerate(itertools.product(flags, repeat=2)):
        for order_u, order_v in orders:
            yield flags_u, flags_v, order_u, order_v


def set_direction(spline, direction, flags, order):
    for name, value in zip(FLAGS, flags):
        setattr(spline, f"use_{name}_{direction}", value)
    if order != STORED_ORDER:
        setattr(spline, f"order_{direction}", order)


def make_grid(counts):
    """A SURFACE with one grid of points."""
    data = bpy.data.curves.new("grid", "SURFACE")
    data.dimensions = "3D"
    item = link("grid", data)
    add_grid(item, *counts)
    bpy.data.objects.remove(item)
    return data


def make_surfaces(rng, template, small):
    """Objects for every setting of one grid."""
    objects = []
    for flags_u, flags_v, order_u, order_v in surface_settings(small):
        data = template.copy()
        spline = data.splines[0]
        spline.points.foreach_set("co", random_points(rng, len(spline.points)).ravel())
        spline.resolution_u, spline.resolution_v = RESOLUTION_U, RESOLUTION_V
        set_direction(spline, "u", flags_u, order_u)
        set_direction(spline, "v", flags_v, order_v)
        objects.append(link("surface", data))
    return objects


def make_curves(rng):
    """NURBS curves of every setting and count."""
    objects = []
    for flags, order, count in itertools.product(
        itertools.product((False, True), repeat=3), (STORED_ORDER, *ORDERS), CURVE_COUNTS
    ):
        data = bpy.data.curves.new("curve", "CURVE")
        data.dimensions = "3D"
        spline = data.splines.new("NURBS")
        spline.points.add(count - 1)
        spline.points.foreach_set("co", random_points(rng, count).ravel())
        spline.resolution_u = RESOLUTION_V
        set_direction(spline, "u", flags, order)
        objects.append(link("curve", data))
    return objects


def make_bezier_curves(rng):
    """Bezier curves with every pair of handle types, and all mixed, open and cyclic."""
    kinds = ("FREE", "VECTOR", "ALIGNED", "AUTO")
    settings = [[pair] for pair in itertools.product(kinds, repeat=2)]
    settings.append([tuple(rng.choice(kinds, 2)) for _ in range(12)])
    objects = []
    for pattern, cyclic, count in itertools.product(settings, (False, True), (1, 2, 3, 6)):
        data = bpy.data.curves.new("bezier", "CURVE")
        data.dimensions = "3D"
        spline = data.splines.new("BEZIER")
        spline.bezier_points.add(count - 1)
        spline.use_cyclic_u = cyclic
        spline.resolution_u = 5
        for i, point in enumerate(spline.bezier_points):
            point.co, point.handle_left, point.handle_right = rng.uniform(-1, 1, (3, 3))
            point.handle_left_type, point.handle_right_type = pattern[i % len(pattern)]
        objects.append(link("bezier", data))
    return objects


def evaluated_vertices(item, depsgraph):
    evaluated = item.evaluated_get(depsgraph)
    mesh = evaluated.to_mesh()
    vertices = np.zeros((len(mesh.vertices), 3), np.float32)
    mesh.vertices.foreach_get("co", vertices.ravel())
    evaluated.to_mesh_clear()
    return vertices


def points_of(collection, name, width):
    values = np.zeros(len(collection) * width, np.float32)
    collection.foreach_get(name, values)
    return values.reshape(-1, width)


def settings_of(spline, direction):
    flags = [getattr(spline, f"use_{name}_{direction}") for name in FLAGS]
    return [
        getattr(spline, f"order_{direction}"),
        *map(int, flags),
        getattr(spline, f"point_count_{direction}"),
        getattr(spline, f"resolution_{direction}"),
    ]


def control_points(spline):
    """(n, 4) x, y, z, weight, or the three points of each knot of a Bezier spline, (3 n, 3)."""
    if spline.type != "BEZIER":
        return points_of(spline.points, "co", 4)
    names = ("handle_left", "co", "handle_right")
    return np.stack([points_of(spline.bezier_points, name, 3) for name in names], axis=1)


def save(path, objects):
    """All cases end to end: a few large arrays, since thousands of small ones are slow to save and to load."""
    bpy.context.view_layer.update()
    depsgraph = bpy.context.evaluated_depsgraph_get()
    splines = [item.data.splines[0] for item in objects]
    vertices = [evaluated_vertices(item, depsgraph).ravel() for item in objects]
    points = [control_points(spline).ravel() for spline in splines]
    types = [
        [(point.handle_left_type, point.handle_right_type) for point in spline.bezier_points] for spline in splines
    ]
    np.savez(
        path,
        version=bpy.app.version,
        kind=[item.name.split(".")[0] for item in objects],
        u=[settings_of(spline, "u") for spline in splines],
        v=[settings_of(spline, "v") for spline in splines],
        vertices=np.concatenate(vertices),
        vertices_size=[len(array) for array in vertices],
        points=np.concatenate(points),
        points_size=[len(array) for array in points],
        types=[pair for pairs in types for pair in pairs],
        types_size=[len(pairs) for pairs in types],
    )


def main():
    bpy.ops.wm.read_factory_settings(use_empty=True)
    rng = np.random.default_rng(20)
    # All grids first: the operators that make them update the whole scene.
    grids = [(make_grid(counts), counts in SMALL_COUNTS) for counts in SURFACE_COUNTS + SMALL_COUNTS]
    objects = []
    for grid, small in grids:
        objects += make_surfaces(rng, grid, small)
    objects += make_curves(rng) + make_bezier_curves(rng)
    save(sys.argv[-1], objects)


main()
