"""Leaves of the tree above the instances: rays meet there what they meet of each instance alone, whatever its box."""

import numpy as np
import pytest
from core import shapes
from rayleaf import _core

trace = _core.trace

LEAF = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], np.float32)


def flat_leaf():
    return trace.TriangleMesh("leaf", LEAF, np.array([[0, 1, 2], [0, 2, 3]], np.int32))


def placed(random, turns, size):
    """In a ball of radius 1."""
    matrix = np.eye(4)
    rotation = np.linalg.qr(random.normal(size=(3, 3)))[0] if turns else np.eye(3)
    matrix[:3, :3] = rotation * size * random.uniform(0.3, 1.0, 3)
    matrix[:3, 3] = shapes.random_directions(random, 1)[0] * random.random()
    return matrix


def instances(random, offset, scale):
    """Flat and solid ones, turned and straight, of sizes from a thousandth on, a floor below them and a box around all."""
    meshes = [flat_leaf(), shapes.cube()]
    all_of_them = [
        (meshes[i % 2], placed(random, turns=i % 3 > 0, size=10 ** random.uniform(-3.0, -1.0))) for i in range(60)
    ]
    for mesh, size, z in ((flat_leaf(), 3.0, -1.0), (shapes.cube(), 5.0, 0.0)):
        matrix = np.diag([size, size, size, 1.0])
        matrix[2, 3] = z
        all_of_them.append((mesh, matrix))
    to_world = shapes.moved(offset, scale)
    return [(mesh, to_world @ matrix) for mesh, matrix in all_of_them]


def some_rays(random, placed_at):
    """From everywhere in the box: at places of the instances, along the axes, and within the planes of the leaves."""
    count = 3000
    origins = 2 * shapes.random_directions(random, count) * random.random((count, 1))
    aims = placed_at[random.integers(len(placed_at), size=count)] + 0.01 * random.normal(size=(count, 3))
    directions = aims - origins
    directions[:300] = np.eye(3)[random.integers(3, size=300)] * random.choice([-1, 1], (300, 1))
    directions[300:600, 2] = 0.0
    return origins, shapes.unit(directions)


@pytest.mark.parametrize("offset, scale", [(0.0, 1.0), (1e6, 1.0), (0.0, 1e-6)])
def test_rays_meet_the_instances_of_leaves_as_each_alone(offset, scale, any_target):
    random = np.random.default_rng(71)
    all_of_them = instances(random, offset, scale)
    together = trace.Tracer([(mesh, matrix, shapes.EVERYTHING) for mesh, matrix in all_of_them])
    to_world = shapes.moved(offset, scale)
    at = np.stack([np.linalg.solve(to_world, matrix[:, 3])[:3] for _, matrix in all_of_them])
    origins, directions = some_rays(random, at)
    origins = origins @ to_world[:3, :3].T + to_world[:3, 3]
    alone = [
        trace.Tracer([(mesh, matrix, shapes.EVERYTHING)]).closest_hits(origins, directions)
        for mesh, matrix in all_of_them
    ]
    distances = np.stack([np.where(hits["instance"] < 0, np.inf, hits["t"]) for hits in alone])
    nearest = distances.min(axis=0)
    assert len(np.unique(distances.argmin(axis=0))) > 40
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
