"""Cages for the tests of subdivision surfaces, and a slow reference of the rules of Catmull and Clark."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from core import shapes
from numpy.typing import NDArray
from rayleaf import _core

Doubles = NDArray[np.float64]
FOREVER = 10.0
# Corners of an element in its parameters: the first, and on towards the next one.
ELEMENT_CORNERS = np.array([[0, 0], [0, 1], [1, 1], [1, 0]], float)


@dataclass
class Cage:
    """Faces are lists of vertices; creases: (lower vertex, higher vertex) -> sharpness."""

    vertices: Doubles
    faces: list[list[int]]
    creases: dict[tuple[int, int], float] = field(default_factory=dict)
    # Of each face once it is a quad: the element it is part of, and its corners there.
    places: list[tuple[int, Doubles]] = field(default_factory=list)

    def surface(self, name: str = "cage", **options: Any) -> Any:
        """The shape."""
        edges = np.array(list(self.creases), np.int32).reshape(-1, 2)
        return _core.SubdivisionSurface(
            name,
            self.vertices.astype(np.float32),
            np.array([len(face) for face in self.faces], np.int32),
            np.array([vertex for face in self.faces for vertex in face], np.int32),
            edges,
            np.array(list(self.creases.values()), np.float32),
            **options,
        )


def edge(a: int, b: int) -> tuple[int, int]:
    """The edge between two vertices."""
    return min(a, b), max(a, b)


def face_edges(face: list[int]) -> list[tuple[int, int]]:
    """Edge i follows corner i."""
    return [edge(a, b) for a, b in zip(face, [*face[1:], face[0]])]


def sharp_edges(cage: Cage) -> dict[tuple[int, int], float]:
    """Creases and borders."""
    count: dict[tuple[int, int], int] = {}
    for face in cage.faces:
        for each in face_edges(face):
            count[each] = count.get(each, 0) + 1
    border = {each: FOREVER for each, faces in count.items() if faces == 1}
    return {each: sharpness for each, sharpness in cage.creases.items() if sharpness > 0} | border


def with_places(cage: Cage) -> Cage:
    """The cage with the places of its faces: whole elements where all faces are quads."""
    if all(len(face) == 4 for face in cage.faces) and not cage.places:
        cage.places = [(i, ELEMENT_CORNERS) for i in range(len(cage.faces))]
    return cage


def refined(cage: Cage) -> Cage:
    """One step; sharpness must be whole numbers."""
    cage = with_places(cage)
    points, sharp = cage.vertices, sharp_edges(cage)
    face_points = np.array([points[face].mean(axis=0) for face in cage.faces])
    of_edge: dict[tuple[int, int], list[int]] = {}
    of_vertex: dict[int, list[int]] = {}
    for index, face in enumerate(cage.faces):
        for vertex, each in zip(face, face_edges(face)):
            of_edge.setdefault(each, []).append(index)
            of_vertex.setdefault(vertex, []).append(index)
    edges = list(of_edge)
    edge_points, sharp_at, edges_at = [], {}, {}
    for each in edges:
        middle = points[list(each)].mean(axis=0)
        for vertex in each:
            edges_at.setdefault(vertex, []).append(each)
            if each in sharp:
                sharp_at.setdefault(vertex, []).append(each)
        edge_points.append(middle if each in sharp else (middle + face_points[of_edge[each]].mean(axis=0)) / 2)
    moved = points.copy()
    for vertex, faces in of_vertex.items():
        creases = sharp_at.get(vertex, [])
        if len(creases) > 2:
            continue
        if len(creases) == 2:
            ends = [a if b == vertex else b for a, b in creases]
            moved[vertex] = (6 * points[vertex] + points[ends].sum(axis=0)) / 8
            continue
        n = len(edges_at[vertex])
        middles = np.mean([points[list(each)].mean(axis=0) for each in edges_at[vertex]], axis=0)
        moved[vertex] = (face_points[faces].mean(axis=0) + 2 * middles + (n - 3) * points[vertex]) / n
    return assembled(cage, moved, np.array(edge_points), face_points, edges)


def assembled(cage: Cage, moved: Doubles, edge_points: Doubles, face_points: Doubles, edges: list[Any]) -> Cage:
    """The finer cage: vertices, then edges, then faces."""
    number = {each: len(moved) + i for i, each in enumerate(edges)}
    result = Cage(np.concatenate([moved, edge_points, face_points]), [])
    first = 0
    for index, face in enumerate(cage.faces):
        middle = len(moved) + len(edges) + index
        around = face_edges(face)
        for i, vertex in enumerate(face):
            result.faces.append([vertex, number[around[i]], middle, number[around[i - 1]]])
            if not cage.places:
                result.places.append((first + i, ELEMENT_CORNERS))
                continue
            element, corners = cage.places[index]
            after, before = (corners[i] + corners[(i + 1) % 4]) / 2, (corners[i] + corners[i - 1]) / 2
            result.places.append((element, np.array([corners[i], after, corners.mean(axis=0), before])))
        first += len(face)
    for each, sharpness in cage.creases.items():
        left = sharpness if sharpness >= FOREVER else sharpness - 1
        if left > 0:
            for vertex in each:
                result.creases[edge(vertex, number[each])] = left
    return result


def limit_points(cage: Cage) -> Doubles:
    """The limits of a refined cage's vertices (Halstead, Kass, DeRose 1993), if all creases are infinitely sharp.

    NaN where a crease ends: there the vertices around move by other rules than the smooth ones.
    """
    sharp = sharp_edges(cage)
    result = cage.vertices.copy()
    sums = {vertex: [np.zeros(3), np.zeros(3), 0] for vertex in range(len(result))}
    for face in cage.faces:
        for i, vertex in enumerate(face):
            of = sums[vertex]
            # Every edge is met from both of its faces.
            of[0] += (cage.vertices[face[i - 1]] + cage.vertices[face[(i + 1) % 4]]) / 2
            of[1] += cage.vertices[face[(i + 2) % 4]]
            of[2] += 1
    for vertex, (neighbours, diagonals, n) in sums.items():
        creases = [each for each in sharp if vertex in each]
        if len(creases) > 2:
            continue
        if len(creases) == 1:
            result[vertex] = np.nan
        elif len(creases) == 2:
            ends = [a if b == vertex else b for a, b in creases]
            result[vertex] = (4 * cage.vertices[vertex] + cage.vertices[ends].sum(axis=0)) / 6
        else:
            result[vertex] = (n * n * cage.vertices[vertex] + 4 * neighbours + diagonals) / (n * (n + 5))
    return result


def cube() -> Cage:
    """From -1 to 1."""
    return Cage(shapes.CUBE_VERTICES.astype(float), [list(quad) for quad in shapes.CUBE_QUADS])


def tetrahedron() -> Cage:
    """Triangles only."""
    points = np.array([[1, 1, 1], [-1, -1, 1], [-1, 1, -1], [1, -1, -1]], float)
    return Cage(points, [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])


def prism(sides: int) -> Cage:
    """Two faces of many corners, and quads between them."""
    angle = np.arange(sides) * 2 * np.pi / sides
    ring = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    points = np.concatenate([np.column_stack([ring, np.full(sides, z)]) for z in (-0.5, 0.5)])
    bottom, top = list(range(sides))[::-1], list(range(sides, 2 * sides))
    walls = [[i, (i + 1) % sides, sides + (i + 1) % sides, sides + i] for i in range(sides)]
    return Cage(points, [bottom, top, *walls])


def double_pole(sides: int) -> Cage:
    """A drum whose lids are fans of quads around one vertex each: poles of that many faces; `sides` is even."""
    angle = np.arange(2 * sides) * np.pi / sides
    ring = np.stack([np.cos(angle), np.sin(angle)], axis=1) * np.where(np.arange(2 * sides) % 2, 1.0, 0.8)[:, None]
    points = [np.column_stack([ring, np.full(2 * sides, z)]) for z in (-0.5, 0.5)]
    vertices = np.concatenate([*points, [[0, 0, -0.7], [0, 0, 0.7]]])
    n, south, north = 2 * sides, 4 * sides, 4 * sides + 1
    faces = [[i, (i + 1) % n, n + (i + 1) % n, n + i] for i in range(n)]
    for i in range(1, n, 2):
        after, next_one = (i + 1) % n, (i + 2) % n
        faces.append([next_one, after, i, south])
        faces.append([n + i, n + after, n + next_one, north])
    return Cage(vertices, faces)


def torus(columns: int = 8, rows: int = 6) -> Cage:
    """All vertices are regular."""
    u, v = np.meshgrid(np.arange(rows) * 2 * np.pi / rows, np.arange(columns) * 2 * np.pi / columns)
    ring = 0.7 + 0.3 * np.cos(u)
    points = np.stack([ring * np.cos(v), ring * np.sin(v), 0.3 * np.sin(u)], axis=2).reshape(-1, 3)
    faces = []
    for j in range(columns):
        for i in range(rows):
            after, up = (j + 1) % columns, (i + 1) % rows
            faces.append([j * rows + i, after * rows + i, after * rows + up, j * rows + up])
    return Cage(points, faces)


def open_grid(side: int = 3) -> Cage:
    """A bent sheet of side x side quads."""
    x, y = np.meshgrid(np.linspace(-1, 1, side + 1), np.linspace(-1, 1, side + 1))
    points = np.stack([x, y, 0.3 * np.sin(2 * x) * np.cos(y + 1)], axis=2).reshape(-1, 3)
    n = side + 1
    return Cage(
        points,
        [[j * n + i, j * n + i + 1, (j + 1) * n + i + 1, (j + 1) * n + i] for j in range(side) for i in range(side)],
    )


def creased(cage: Cage, edges: list[tuple[int, int]], sharpness: float) -> Cage:
    """The cage with creases."""
    return Cage(cage.vertices, cage.faces, {edge(*each): sharpness for each in edges})
