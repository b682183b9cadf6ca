"""Leaves of the tree above the instances: rays meet there what they meet of each instance alone, whatever its box."""

import numpy as np
import pytest
from core import shapes
from rayleaf import _core

trace = _core.trace

LEAF = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], np.float32)
SLANTED = LEAF + np.array([0, 0, 0.7], np.float32) * LEAF[:, :1] * LEAF[:, 1:2]  # and not quite flat
NEEDLE = np.array([[-1, -1, -1], [1, 1, 1], [0.9, 1, 1]], np.float32)


def mesh(vertices):
    triangles = [[0, i, i + 1] for i in range(1, len(vertices) - 1)]
    return trace.TriangleMesh("mesh", vertices, np.array(triangles, np.int32))


def sheet():
    """A spline that leans over."""
    u, v = np.meshgrid(np.linspace(-1, 1, 4), np.linspace(-1, 1, 4), indexing="ij")
    points = np.stack([u, v, u + 0.1 * v**2, np.ones_like(u)], axis=-1)
    ends = (4, False, True, False)
    return trace.PatchSurface("sheet", [(points, ends, ends, True, 0)])


def placed(random, turns, size):
    """In a ball of radius 1."""
    matrix = np.eye(4)
    rotation = np.linalg.qr(random.normal(size=(3, 3)))[0] if turns else np.eye(3)
    matrix[:3, :3] = rotation * size * random.uniform(0.3, 1.0, 3)
    matrix[:3, 3] = shapes.random_directions(random, 1)[0] * random.random()
    return matrix


def instances(random, offset, scale):
    """Flat and solid ones, turned and straight, of sizes from a thousandth on, a floor below them and a box around all."""
    kinds = [mesh(LEAF), mesh(SLANTED), mesh(NEEDLE), sheet(), shapes.cube()]
    all_of_them = [
        (kinds[i % len(kinds)], placed(random, turns=i % 3 > 0, size=10 ** random.uniform(-3.0, -1.0)))
        for i in range(75)
    ]
    for shape, size, z in ((mesh(LEAF), 3.0, -1.0), (shapes.cube(), 5.0, 0.0)):
        matrix = np.diag([size, size, size, 1.0])
        matrix[2, 3] = z
        all_of_them.append((shape, matrix))
    to_world = shapes.moved(offset, scale)
    return [(shape, to_world @ matrix) for shape, matrix in all_of_them]


def some_rays(random, placed_at):
    """From everywhere in the box: at places of the instances, along the axes, and within the planes of the leaves."""
    count = 3000
    origins = 2 * shapes.random_directions(random, count) * random.random((count, 1))
    aims = placed_at[random.integers(len(placed_at), size=count)] + 0.01 * random.normal(size=(count, 3))
    directions = aims - origins
    directions[:300] = np.eye(3)[random.integers(3, size=300)] * random.choice([-1, 1], (300, 1))
    directions[300:600, 2] = 0.0
    return origins, shapes.unit(directions)


def traced(all_of_them):
    """Facets as coarse as can be, so they do not depend on where instances are."""
    return trace.Tracer([(shape, matrix, shapes.EVERYTHING) for shape, matrix in all_of_them], pixel_angle=1.0)


@pytest.mark.parametrize("offset, scale", [(0.0, 1.0), (1e6, 1.0), (0.0, 1e-6)])
def test_rays_meet_the_instances_of_leaves_as_each_alone(offset, scale, any_target):
    random = np.random.default_rng(71)
    all_of_them = instances(random, offset, scale)
    together = traced(all_of_them)
    to_world = shapes.moved(offset, scale)
    at = np.stack([np.linalg.solve(to_world, matrix[:, 3])[:3] for _, matrix in all_of_them])
    origins, directions = some_rays(random, at)
    origins = origins @ to_world[:3, :3].T + to_world[:3, 3]
    alone = [traced([instance]).closest_hits(origins, directions) for instance in all_of_them]
    distances = np.stack([np.where(hits["instance"] < 0, np.inf, hits["t"]) for hits in alone])
    nearest = distances.min(axis=0)
    assert len(np.unique(distances.argmin(axis=0))) > 50
    met = np.isfinite(nearest)
    for target in trace.simd_targets():
        assert trace.use_simd_target(target)
        for hits in (
            together.closest_hits(origins, directions),
            trace.closest_in_packets(together, origins, directions, False),
            trace.closest_in_packets(together, origins, directions, True),
        ):
            np.testing.assert_array_equal(np.where(hits["instance"] < 0, np.inf, hits["t"]), nearest)
            np.testing.assert_array_equal(hits["instance"][met], distances.argmin(axis=0)[met])
        np.testing.assert_array_equal(together.occluded(origins, directions), met)
        np.testing.assert_array_equal(trace.occluded_in_packets(together, origins, directions), met)
