"""The normals that Blender shades meshes with."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import core_module

Floats = NDArray[np.float32]
Ints = NDArray[np.int32]

# By how much Blender's normals of a vertex and of a corner that has the vertex's may differ.
_ROUNDING = 1e-6


def corner_normals(mesh: Any, corners: Ints | None = None) -> Floats:
    """(corners, 3): the normals that Blender shades with, sharp edges, flat faces and custom normals respected. `corners`: the
    vertices of all, if they are known."""
    if not hasattr(mesh, "corner_normals"):  # before 4.1
        return _corner_normals_by_vertices(mesh, vertices_of(mesh) if corners is None else corners)
    normals = np.empty((len(mesh.loops), 3), np.float32)
    mesh.corner_normals.foreach_get("vector", normals.ravel())
    return normals


def vertices_of(mesh: Any) -> Ints:
    """(corners,): the vertices of all."""
    corners = np.empty(len(mesh.loops), np.int32)
    mesh.loops.foreach_get("vertex_index", corners)
    return corners


def _split_normals(mesh: Any) -> Floats:
    normals = np.empty((len(mesh.loops), 3), np.float32)
    mesh.calc_normals_split()
    mesh.loops.foreach_get("normal", normals.ravel())
    mesh.free_normals_split()
    return normals


def _corner_normals_by_vertices(mesh: Any, corners: Ints) -> Floats:
    """Blender sums the normals of vertices, which most corners have, in the order in which its threads come, so that no two
    renders agree in the last digits. They are computed here."""
    vertices = np.empty((len(mesh.vertices), 3), np.float32)
    sizes, smooth = np.empty(len(mesh.polygons), np.int32), np.empty(len(mesh.polygons), bool)
    mesh.vertices.foreach_get("co", vertices.ravel())
    mesh.polygons.foreach_get("loop_total", sizes)
    mesh.polygons.foreach_get("use_smooth", smooth)
    core = core_module.load()
    try:
        of_vertices = core.vertex_normals(vertices, sizes, corners)
    except core.InputError:  # a mesh that is not valid, as add-ons may leave it
        return _split_normals(mesh)
    if mesh.use_auto_smooth:  # sharp edges and custom normals
        normals, blenders = _split_normals(mesh), np.empty_like(vertices)
        mesh.vertex_normals.foreach_get("vector", blenders.ravel())
        same = (np.abs(normals - blenders[corners]) < _ROUNDING).all(axis=1)
        normals[same] = of_vertices[corners[same]]
        return normals
    normals = np.asarray(of_vertices[corners], np.float32)
    if not smooth.all():
        faces = np.empty((len(sizes), 3), np.float32)
        mesh.polygon_normals.foreach_get("vector", faces.ravel())
        flat = np.repeat(~smooth, sizes)
        normals[flat] = np.repeat(faces, sizes, axis=0)[flat]
    return normals
