"""Attributes that nobody stores, made of a mesh where a material asks for them: each as Cycles makes it."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import versions
from ..names import find, name_of
from .corner_tangents import corner_tangents, unit
from .random_numbers import random_of_words

Floats = NDArray[np.float32]
Ints = NDArray[np.int32]

# Names no attribute can have in Blender.
POINTINESS = "\npointiness"
ISLAND_RANDOM = "\nisland random"
TANGENT_OF = "\ntangent of "  # a UV map's name follows; of the one that is active for rendering ""
REST_PLACE = "\nrest place"  # the core knows it


def edges(mesh: Any) -> Ints:
    """(edges, 2) vertices."""
    ends = np.empty(len(mesh.edges) * 2, np.int32)
    mesh.edges.foreach_get("vertices", ends)
    return ends.reshape(-1, 2)


def _vectors(collection: Any, name: str) -> NDArray[np.float64]:
    values = np.empty(len(collection) * 3, np.float32)
    collection.foreach_get(name, values)
    return values.reshape(-1, 3).astype(np.float64)


def pointiness(mesh: Any) -> Floats:
    """(vertices,): 0.5 where flat, more on ridges; the mean angle of the normal with the edges, blurred once. Vertices at one
    place are one."""
    places = _vectors(mesh.vertices, "co")
    _, welded = np.unique(np.nan_to_num(places), axis=0, return_inverse=True)
    count = int(welded.max(initial=-1)) + 1
    normals, place = np.zeros((count, 3)), np.zeros((count, 3))
    np.add.at(normals, welded, _vectors(mesh.vertices, "normal"))
    place[welded] = places
    ends = np.unique(np.sort(welded[edges(mesh)], axis=1), axis=0)
    along = unit(place[ends[:, 1]] - place[ends[:, 0]])
    total, meeting = np.zeros((count, 3)), np.bincount(ends.ravel(), minlength=count)
    np.add.at(total, ends[:, 0], along)
    np.add.at(total, ends[:, 1], -along)
    mean = total / np.maximum(meeting, 1)[:, None]
    angle = np.arccos(np.clip(np.einsum("ij,ij->i", unit(normals), mean), -1.0, 1.0)) / np.pi
    raw = np.where(meeting > 0, angle, 0.0)
    blurred = raw.copy()
    np.add.at(blurred, ends[:, 0], raw[ends[:, 1]])
    np.add.at(blurred, ends[:, 1], raw[ends[:, 0]])
    return np.asarray((blurred / (meeting + 1))[welded], np.float32)


def island_random(mesh: Any) -> Floats:
    """(vertices,) 0..1 by chance, the same on all that hangs together. Which vertex names an island follows from the order of
    its edges."""
    parents, ranks = list(range(len(mesh.vertices))), [0] * len(mesh.vertices)

    def root(vertex: int) -> int:
        while parents[vertex] != vertex:
            parents[vertex] = parents[parents[vertex]]
            vertex = parents[vertex]
        return vertex

    for first, second in edges(mesh).tolist():
        a, b = root(first), root(second)
        if a == b:
            continue
        if ranks[a] < ranks[b]:
            a, b = b, a
        parents[b] = a
        ranks[a] += ranks[a] == ranks[b]
    return random_of_words(np.array([root(vertex) for vertex in range(len(parents))], np.int64))


def rest_places(mesh: Any) -> Floats | None:
    """(vertices, 3): where they were before modifiers and shape keys moved them, object space; None where they still are.
    Blender knows it in final renders alone."""
    now, before = _vectors(mesh.vertices, "co"), _vectors(mesh.vertices, "undeformed_co")
    rounding = 2e-6 * float(np.abs(now).max(initial=0.0))  # they are kept as shares of the texture space
    return None if np.allclose(now, before, 0.0, rounding) else before.astype(np.float32)


def rest_moves(mesh: Any) -> Floats | None:
    """(vertices, 3): the way back there."""
    places = rest_places(mesh)
    return None if places is None else places - _vectors(mesh.vertices, "co").astype(np.float32)


def tangents(mesh: Any, uv_map: str) -> Floats | None:
    """(loops, 4): tangents along a UV map, object space, and on which side the bitangent lies. None without the map."""
    active = next((each for each in mesh.uv_layers if each.active_render), None)
    layer = find(mesh.uv_layers, uv_map) if uv_map else active
    if layer is None:
        return None
    sizes = np.empty(len(mesh.polygons), np.int32)
    mesh.polygons.foreach_get("loop_total", sizes)
    if sizes.max(initial=0) > 4:  # Blender has none
        return corner_tangents(mesh, versions.uv_map(layer, len(mesh.loops)))
    try:
        mesh.calc_tangents(uvmap=name_of(layer))
    except (RuntimeError, UnicodeError):
        return None
    result = np.empty((len(mesh.loops), 4), np.float32)
    result[:, :3] = _vectors(mesh.loops, "tangent")
    sides = np.empty(len(mesh.loops), np.float32)
    mesh.loops.foreach_get("bitangent_sign", sides)
    result[:, 3] = sides
    mesh.free_tangents()
    return result
