"""Tangents of faces with any number of corners are those that Blender makes where it can: of triangles."""

SCRIPT = """
import bmesh, bpy
import numpy as np
from rayleaf.export.corner_tangents import corner_tangents
from rayleaf import versions

# Blender moves layers when it makes tangents: none may be kept.
def coordinates_of(mesh):
    return versions.uv_map(mesh.uv_layers[0], len(mesh.loops))

def blenders(mesh):
    mesh.calc_tangents(uvmap=mesh.uv_layers[0].name)
    found = np.empty((len(mesh.loops), 3), np.float32)
    mesh.loops.foreach_get("tangent", found.ravel())
    sides = np.empty(len(mesh.loops), np.float32)
    mesh.loops.foreach_get("bitangent_sign", sides)
    mesh.free_tangents()
    return np.column_stack([found, sides])

def ours(mesh):
    return corner_tangents(mesh, coordinates_of(mesh))

def monkey(change, smooth):
    "A head of triangles."
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.mesh.primitive_monkey_add()
    mesh = bpy.context.object.data
    built = bmesh.new()
    built.from_mesh(mesh)
    bmesh.ops.triangulate(built, faces=built.faces)
    for face in built.faces:
        face.smooth = smooth
    built.to_mesh(mesh)
    changed = change(coordinates_of(mesh).astype(np.float64)).astype(np.float32).ravel()
    mesh.uv_layers[0].data.foreach_set("uv", changed)
    return mesh

plain = lambda at: at
odd = lambda at: np.column_stack([at[:, 0] + 0.7 * at[:, 1], np.abs(at[:, 1] - 0.5)])  # sheared, folded
for name, change, smooth in (("smooth", plain, True), ("odd", odd, True), ("flat", plain, False)):
    mesh = monkey(change, smooth)
    a, b = blenders(mesh), ours(mesh)
    report(**{name: [float(np.quantile(np.linalg.norm((a - b)[:, :3], axis=1), 0.99)), float((a[:, 3] == b[:, 3]).mean())]})

# A prism: sides of four corners, ends of seven.
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.mesh.primitive_cylinder_add(vertices=7)
mesh = bpy.context.object.data
found = ours(mesh)
normals = np.repeat([face.normal for face in mesh.polygons], [face.loop_total for face in mesh.polygons], axis=0)
report(lengths=[float(v) for v in np.linalg.norm(found[:, :3], axis=1)],
       off=float(np.abs(np.einsum("ij,ij->i", found[:, :3], normals)).max()))

# Coordinates that are all the same determine nothing, and numbers that are none end nothing.
for value in (0.5, float("nan"), 1e38):
    coordinates = np.full((len(mesh.loops), 2), value, np.float32)
    coordinates[0] = 0
    report(**{f"of {value}": bool(np.isfinite(corner_tangents(mesh, coordinates)[4:]).all())})
"""


def test_tangents_of_triangles_are_blenders_and_faces_of_more_corners_have_some(run_blender):
    report = run_blender(SCRIPT).report
    for name in ("smooth", "odd", "flat"):
        difference, same_side = report[name]
        assert difference < 2e-3, name
        assert same_side > 0.99, name
    assert max(abs(length - 1) for length in report["lengths"]) < 1e-6
    assert report["off"] < 1e-6
    assert report["of 0.5"] and report["of nan"] and report["of 1e+38"]
