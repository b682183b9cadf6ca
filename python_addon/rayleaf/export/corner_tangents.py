"""Tangents of meshes whose faces have any number of corners, from their triangles, as Cycles has them: M. Mikkelsen,
*Simulation of Wrinkled Surfaces Revisited*, 2008, chapter 3. Corners are joined where place, normal and texture coordinate
are the same; he asks also that their triangles share edges.
"""

from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from .corner_normals import corner_normals, vertices_of

Floats = NDArray[np.float32]
Vectors = TypeVar("Vectors", NDArray[np.float32], NDArray[np.float64])


def unit(vectors: Vectors) -> Vectors:
    """Of the same directions, along the last axis; zero stays."""
    lengths = np.sqrt(np.einsum("...i,...i", vectors, vectors))[..., None]
    return np.divide(vectors, lengths, out=np.zeros_like(vectors), where=lengths > 0.0)


def _on_plane(vectors: Floats, normals: Floats) -> Floats:
    """Unit, without what they have of the normals."""
    return unit(vectors - normals * np.einsum("...i,...i", vectors, normals)[..., None])


def _angles(places: Floats, normals: Floats) -> Floats:
    """(triangles, 3): of the triangle at its corners, as it lies on the plane of the normal there."""
    to_next = _on_plane(np.roll(places, -1, axis=1) - places, normals)
    to_last = _on_plane(np.roll(places, 1, axis=1) - places, normals)
    return np.arccos(np.clip(np.einsum("...i,...i", to_next, to_last), -1.0, 1.0))


def _groups(*parts: Floats) -> NDArray[np.int64]:
    """The number of each row among those that are equal in all parts, told by hashes of 64 bits."""
    hashes = np.zeros(len(parts[0]), np.uint64)
    for part in parts:
        for column in part.T:
            hashes ^= (column + np.float32(0.0)).view(np.uint32)  # -0 is 0
            hashes *= np.uint64(0x9E3779B97F4A7C15)
            hashes ^= hashes >> np.uint64(29)
    return np.unique(hashes, return_inverse=True)[1]


@np.errstate(invalid="ignore", over="ignore")  # of coordinates that are no numbers
def corner_tangents(mesh: Any, uv: Floats) -> Floats:
    """(loops, 4): unit tangents along texture coordinates (loops, 2), object space, and on which side the bitangent lies. Zero
    where these do not determine any."""
    mesh.calc_loop_triangles()
    corners = np.empty(len(mesh.loop_triangles) * 3, np.int32)
    mesh.loop_triangles.foreach_get("loops", corners)
    vertices, co = vertices_of(mesh), np.empty(len(mesh.vertices) * 3, np.float32)
    mesh.vertices.foreach_get("co", co)
    places, normals, maps = co.reshape(-1, 3)[vertices[corners]], corner_normals(mesh, vertices)[corners], uv[corners]
    p, n, m = (each.reshape(-1, 3, each.shape[1]) for each in (places, normals, maps))

    edges, steps = np.subtract(p[:, 1:], p[:, :1], dtype=np.float64), np.subtract(m[:, 1:], m[:, :1], dtype=np.float64)
    determinants = steps[:, 0, 0] * steps[:, 1, 1] - steps[:, 0, 1] * steps[:, 1, 0]
    sides = np.where(determinants < 0.0, -1.0, 1.0)[:, None]
    along = unit((edges[:, 0] * steps[:, 1, 1:] - edges[:, 1] * steps[:, 0, 1:]) * sides)
    along[~(np.abs(determinants) > 0.0)] = 0.0
    parts = (_on_plane(along.astype(np.float32)[:, None], n) * _angles(p, n)[..., None]).reshape(-1, 3)

    side_of_corner = np.repeat(sides.astype(np.float32), 3, axis=0)
    groups = _groups(places, normals, maps, side_of_corner)
    sums = np.stack([np.bincount(groups, parts[:, axis]) for axis in range(3)], axis=1).astype(np.float64)
    tangents = unit(sums)[groups]

    result = np.zeros((len(mesh.loops), 4), np.float32)
    # Of a corner of several triangles the last counts: those that have no tangent come first.
    order = np.argsort(np.any(tangents != 0.0, axis=1), kind="stable")
    result[corners[order], :3] = tangents[order]
    result[corners[order], 3:] = side_of_corner[order]
    return result
