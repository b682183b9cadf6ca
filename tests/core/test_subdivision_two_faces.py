"""Vertices of two faces that share both edges there, where OpenSubdiv 3.5 writes beyond its arrays."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from core import subdivision_cages as cages
from core.shapes import unit
from core.subdivision_cages import FOREVER, Cage
from core.test_subdivision_limit import at_places, object_space
from rayleaf import _core

FOLDED = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [-1, 0, 1]], float)
PILLOW = np.array([[0, 0, 0], [1, 0, 0.2], [1, 1, 0], [0, 1, -0.3]], float)


def folded(creases, sharpness):
    """Two quads that share two edges and have two of the border."""
    return cages.creased(Cage(FOLDED, [[0, 1, 2, 3], [0, 3, 4, 1]]), creases, sharpness)


def pillow(creases, sharpness):
    """Two quads back to back: every vertex is one of two faces."""
    return cages.creased(Cage(PILLOW, [[0, 1, 2, 3], [3, 2, 1, 0]]), creases, sharpness)


def lens(sides, creases, sharpness):
    """Two faces of any number of corners back to back, their vertices above and below the middle."""
    angle = np.arange(sides) * 2 * np.pi / sides
    ring = np.column_stack([np.cos(angle), np.sin(angle), 0.3 * (-1.0) ** np.arange(sides)])
    return cages.creased(Cage(ring, [list(range(sides)), list(range(sides))[::-1]]), creases, sharpness)


def box_with_a_vertex_in_an_edge(creases):
    """A cube with a vertex more in the middle of an edge, as artists leave them: its two faces share both halves."""
    first, second = 0, 1
    faces = []
    for face in cages.cube().faces:
        for i, vertex in enumerate(face):
            if {vertex, face[(i + 1) % 4]} == {first, second}:
                face = [*face[: i + 1], 8, *face[i + 1 :]]
                break
        faces.append(face)
    return cages.creased(Cage(np.concatenate([cages.cube().vertices, [[-1, -1.2, 0.1]]]), faces), creases, FOREVER)


CASES = {
    "no crease": folded([], FOREVER),
    "a crease that ends": folded([(0, 1)], FOREVER),
    "a crease that goes on": folded([(0, 1), (0, 3)], FOREVER),
    "a crease that fades": folded([(0, 1)], 2.0),
    "a crease of one step": folded([(0, 1)], 1.0),
    "a pillow": pillow([], FOREVER),
    "a pillow with two creases": pillow([(0, 1), (0, 3)], FOREVER),
    "a pillow with a crease": pillow([(1, 2)], FOREVER),
    "a pillow with a fading crease": pillow([(1, 2)], 3.0),
    "two triangles": lens(3, [], FOREVER),
    "two triangles with a crease": lens(3, [(0, 1)], FOREVER),
    "two pentagons with two creases": lens(5, [(0, 1), (2, 3)], FOREVER),
    "a box with a vertex in an edge": box_with_a_vertex_in_an_edge([]),
    "a box with a vertex in an edge where a crease ends": box_with_a_vertex_in_an_edge([(0, 8)]),
    "a box with a vertex in an edge that is a crease": box_with_a_vertex_in_an_edge([(0, 8), (1, 8)]),
}


@pytest.mark.parametrize("name", CASES)
def test_points_are_the_limits_of_the_refined_cage(name, capfd):
    cage = CASES[name]
    surface = cage.surface()
    for _ in range(4):
        cage = cages.refined(cage)
    points, vertices = at_places(surface, cage)
    off = np.abs(object_space(surface, points[:, 0]) - cages.limit_points(cage)[vertices]).max(axis=1)
    known = np.isfinite(off)
    assert known.mean() > 0.9
    # The vertices come in single precision; ends of creases are approximated (core/geometry/face_limit.h).
    assert off[known].max() < 5e-7, f"{name}: off by {off[known].max()} at face {off[known].argmax() // 4}"
    assert capfd.readouterr().err == "", "OpenSubdiv complains"


@pytest.mark.parametrize("name", CASES)
def test_derivatives_are_those_of_differences(name):
    surface = CASES[name].surface()
    random = np.random.default_rng(5)
    elements = random.integers(0, surface.element_count, 300).astype(np.int32)
    at = random.uniform(0.05, 0.95, (300, 2))
    here = surface.points(elements, at)
    step = 1e-5
    for axis, first in enumerate([1, 2]):
        move = np.eye(2)[axis] * step
        difference = (surface.points(elements, at + move) - surface.points(elements, at - move)) / (2 * step)
        np.testing.assert_allclose(here[:, first], difference[:, 0], atol=2e-7)


def unfolded(cage, seam):
    """Each corner's vertex in the plane, the second face turned over on the edge from vertex 0 to 3; it is moved away at its
    vertices of the seam."""
    first, second = (np.array(cage.vertices[face, :2]) for face in cage.faces)
    origin, along = cage.vertices[0, :2], unit(cage.vertices[3, :2] - cage.vertices[0, :2])
    from_edge = second - origin
    second = origin + 2 * np.outer(from_edge @ along, along) - from_edge
    second[np.isin(cage.faces[1], seam), 1] += 3.0  # its corners still go round the same way
    return np.concatenate([first, second]).astype(np.float32)


SMOOTHINGS = ["NONE", "PRESERVE_CORNERS", "PRESERVE_BOUNDARIES", "SMOOTH_ALL"]


def on_the_border(cage, coordinates, smoothing):
    """Those of both faces from vertex 0 to vertex 3: their border v = 0; the second begins at vertex 3. And the surface."""
    surface = cage.surface(uv_maps={0: coordinates}, uv=0, uv_smoothing=smoothing)
    t = np.linspace(0, 1, 65)
    first = surface.values(0, np.zeros(65, np.int32), np.stack([t, 0 * t], axis=1))[:, :2]
    second = surface.values(0, np.ones(65, np.int32), np.stack([1 - t, 0 * t], axis=1))[:, :2]
    return first, second, surface


@pytest.mark.parametrize("smoothing", SMOOTHINGS)
@pytest.mark.parametrize("seam", [(), (1, 2)])
def test_texture_coordinates_join_where_their_corners_do(smoothing, seam):
    first, second, surface = on_the_border(CASES["a pillow"], unfolded(CASES["a pillow"], seam), smoothing)
    np.testing.assert_allclose(second, first, atol=1e-6)
    inside = surface.values(0, np.zeros(2, np.int32), np.array([[0.5 - 1e-9, 0.2], [0.5, 0.2]]))
    np.testing.assert_allclose(inside[0], inside[1], atol=1e-6)


@pytest.mark.parametrize("smoothing", SMOOTHINGS)
def test_a_folded_map_has_a_border_where_it_is_folded(smoothing):
    cage = CASES["a pillow"]
    folded_map = np.concatenate([cage.vertices[face, :2] for face in cage.faces]).astype(np.float32)
    apart = folded_map + np.repeat([0.0, 3.0], 4)[:, None].astype(np.float32)
    first, second, _ = on_the_border(cage, folded_map, smoothing)
    alone, away, _ = on_the_border(cage, apart, smoothing)
    np.testing.assert_allclose(first, alone, atol=1e-6)
    np.testing.assert_allclose(second, away - 3.0, atol=1e-6)
    if smoothing == "PRESERVE_CORNERS":  # so borders of four corners stay where they are
        np.testing.assert_allclose(first[[0, -1]], cage.vertices[[0, 3], :2], atol=1e-6)


DRAWN = """
import sys
import numpy as np
from core import test_subdivision_two_faces as cases
for seed in range(int(sys.argv[1]), int(sys.argv[2])):
    print(seed, flush=True)
    cases.check_drawn(seed)
"""


def drawn(seed):
    """A few faces on few vertices, so that many share two edges; creases and texture coordinates at random."""
    random = np.random.default_rng(seed)
    count = int(random.integers(4, 8))
    faces = []
    for _ in range(int(random.integers(1, 5))):
        faces.append([int(v) for v in random.permutation(count)[: random.integers(3, min(count, 5) + 1)]])
        if random.random() < 0.6:  # its back, or a face that shares all of its edges but one
            back = faces[-1][::-1]
            if random.random() < 0.5:
                back[0] = int(random.integers(count)) if random.random() < 0.5 else back[0]
            faces.append(back if len(set(back)) == len(back) else faces[-1][::-1])
    edges = sorted({each for face in faces for each in cages.face_edges(face)})
    sharp = [each for each in edges if random.random() < 0.4]
    corners = sum(len(face) for face in faces)
    uv = random.integers(0, 3, (corners, 2)).astype(np.float32)
    vertices = random.permutation(count)[: random.integers(0, 3)].astype(np.int32)
    return _core.SubdivisionSurface(
        "drawn",
        random.normal(size=(count, 3)).astype(np.float32),
        np.array([len(face) for face in faces], np.int32),
        np.concatenate(faces).astype(np.int32),
        np.array(sharp, np.int32).reshape(-1, 2),
        random.choice([1.0, 2.5, 10.0], len(sharp)).astype(np.float32),
        vertices,
        random.choice([0.5, 10.0], len(vertices)).astype(np.float32),
        border_corners=str(random.choice(["SMOOTH", "SHARP"])),
        uv_smoothing=str(random.choice(["NONE", "PRESERVE_CORNERS", "PRESERVE_BOUNDARIES", "SMOOTH_ALL"])),
        uv_maps={0: uv},
        uv=0,
    )


def check_drawn(seed):
    """The surface is finite, and no wider than its cage: at most 6 from the middle for so few normal numbers."""
    surface = drawn(seed)
    elements = np.repeat(np.arange(surface.element_count, dtype=np.int32), 9)
    at = np.tile([[u, v] for u in (0, 0.3, 1) for v in (0, 0.6, 1)], (surface.element_count, 1))
    assert np.abs(surface.points(elements, at)[:, 0]).max() <= 1.5, seed
    assert np.isfinite(surface.values(0, elements, at)).all(), seed


def test_drawn_cages_of_few_vertices_are_rendered_in_silence():
    folders = [str(Path(__file__).parents[1]), str(Path(_core.__file__).parents[1])]
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(folders), "MALLOC_CHECK_": "3", "MALLOC_PERTURB_": "85"}
    done = subprocess.run(
        [sys.executable, "-c", DRAWN, "0", "400"], env=environment, capture_output=True, text=True, timeout=300
    )
    last = done.stdout.split()[-1:]
    assert done.returncode == 0, f"exit code {done.returncode} at cage {last}: {done.stderr[-2000:]}"
    assert done.stderr == "", f"OpenSubdiv complains: {done.stderr[:500]}"
