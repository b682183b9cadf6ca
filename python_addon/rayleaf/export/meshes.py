"""Blender's evaluated meshes to plain arrays."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .attributes import ACTIVE_UV, Corners, attribute_values
from .corner_normals import corner_normals
from .deformation import Deformation

Floats = NDArray[np.float32]
Ints = NDArray[np.int32]


@dataclass
class MeshArrays:
    """The arguments of the core's `add_mesh`, attributes still by name."""

    vertices: Floats  # (n, 3), object space
    triangles: Ints  # (m, 3)
    corner_normals: Floats | None  # (m, 3, 3); None: flat
    material_slots: Ints | None  # (m,); None: all slot 0
    attributes: dict[str, Floats] = field(default_factory=dict)  # (m, 3, channels)
    moved_vertices: Floats | None = None  # (steps, n, 3)
    moved_normals: Floats | None = None  # (steps, m, 3, 3)


def _get(collection: Any, name: str, dtype: Any, count: int) -> Any:
    values = np.empty(count, dtype)
    collection.foreach_get(name, values)
    return values


def _corner_normals(mesh: Any, triangles: Ints, loops: Ints, polygons: Ints) -> Floats | None:
    """(m, 3, 3), or None where every face is flat."""
    smooth = _get(mesh.polygons, "use_smooth", bool, len(mesh.polygons))
    if not smooth.any() and not mesh.has_custom_normals:
        return None
    vertices = np.zeros(len(mesh.loops), np.int32)
    vertices[loops] = triangles  # faster than to ask Blender, and each corner is of some triangle
    normals = corner_normals(mesh, vertices)[loops]
    # A corner without a normal (a face of no area) takes its facet's; the core wants unit vectors.
    lengths = np.linalg.norm(normals, axis=2, keepdims=True)
    bad = ~(np.isfinite(lengths) & (lengths > 0.0))
    if bad.any():
        facet = _get(mesh.loop_triangles, "normal", np.float32, len(polygons) * 3).reshape(-1, 1, 3)
        facet = np.where(
            np.linalg.norm(facet, axis=2, keepdims=True) > 0.5, facet, np.array([0.0, 0.0, 1.0], np.float32)
        )
        normals = np.where(bad, facet, normals)
        lengths = np.where(bad, np.float32(1.0), lengths)
    return np.ascontiguousarray(normals / lengths, np.float32)


def _moved_normals(middle: Floats, moved: Floats) -> Floats:
    """(steps, m, 3, 3): those at each step, and the middle's where there is none."""
    lengths = np.linalg.norm(moved, axis=-1, keepdims=True)
    good = np.isfinite(lengths) & (lengths > 0.0)
    return np.where(good, moved / np.where(good, lengths, np.float32(1.0)), middle).astype(np.float32)


def mesh_arrays(mesh: Any, wanted: frozenset[str], deformation: Deformation | None = None) -> MeshArrays | None:
    """What the core needs of a mesh, with the attributes that are wanted and there; None without faces."""
    mesh.calc_loop_triangles()
    count = len(mesh.loop_triangles)
    if count == 0:
        return None
    triangles = _get(mesh.loop_triangles, "vertices", np.int32, count * 3).reshape(-1, 3)
    loops = _get(mesh.loop_triangles, "loops", np.int32, count * 3).reshape(-1, 3)
    polygons = _get(mesh.loop_triangles, "polygon_index", np.int32, count)
    slots = _get(mesh.polygons, "material_index", np.int32, len(mesh.polygons))[polygons]
    arrays = MeshArrays(
        vertices=_get(mesh.vertices, "co", np.float32, len(mesh.vertices) * 3).reshape(-1, 3),
        triangles=triangles,
        corner_normals=_corner_normals(mesh, triangles, loops, polygons),
        material_slots=slots if slots.any() else None,
    )
    if deformation is not None:
        arrays.moved_vertices = np.ascontiguousarray(deformation.points, np.float32)
        if arrays.corner_normals is not None and deformation.normals is not None:
            arrays.moved_normals = _moved_normals(arrays.corner_normals, deformation.normals[:, loops])
    corners = Corners(triangles, loops, np.repeat(polygons[:, None], 3, axis=1))
    for name in wanted:
        values = attribute_values(mesh, name, corners)
        if values is not None:
            arrays.attributes[name] = values
    return arrays


def add_mesh(scene: Any, name: str, arrays: MeshArrays) -> int:
    """Send a mesh; the shape's index. Raises the core's InputError."""
    attributes = {scene.attribute(key): values for key, values in arrays.attributes.items()}
    uv = scene.attribute(ACTIVE_UV) if ACTIVE_UV in arrays.attributes else -1
    return int(
        scene.add_mesh(
            name,
            arrays.vertices,
            arrays.triangles,
            corner_normals=arrays.corner_normals,
            material_slots=arrays.material_slots,
            uv=uv,
            attributes=attributes,
            moved_vertices=arrays.moved_vertices,
            moved_normals=arrays.moved_normals,
        )
    )
