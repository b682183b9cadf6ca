"""Emitting surfaces: what they give, and that they are sampled with the density they claim."""

import numpy as np
import pytest
from light_support import NORMAL, POSITION, emitter_scene, random_numbers, sphere_directions
from scenes import quad, sphere_spline


SHAPES = {
    "two triangles": lambda core: lambda scene: quad(scene, "quad"),
    "a triangle near by": lambda core: lambda scene: scene.add_mesh(
        "triangle", np.float32(TRIANGLES["near"]), np.int32([[0, 1, 2]])
    ),
    "a spline sphere": lambda core: lambda scene: scene.add_surface("sphere", [sphere_spline(core)]),
}


@pytest.mark.parametrize("shape", SHAPES.values(), ids=SHAPES.keys())
def test_an_emitting_surface_is_sampled_with_the_density_it_claims(core, shape):
    probe = core.LightProbe(emitter_scene(core, shape(core)))
    random = random_numbers(40000)
    samples = probe.sample(POSITION, random)
    used = samples["density"] > 0
    radiance, density = probe.look(POSITION, samples["direction"][used].astype(np.float64))
    # The far side of a sphere is chosen as well, but looking meets the near side: compare what is unoccluded.
    front = np.isclose(density, samples["density"][used], rtol=1e-2)
    directions = sphere_directions(200000)
    seen, look_density = probe.look(POSITION, directions)
    values = 4 * np.pi * seen[:, 0] * np.maximum(directions @ NORMAL, 0)
    cosine = np.maximum(samples["direction"][used] @ NORMAL, 0)
    sampled = np.zeros(len(random))
    sampled[np.flatnonzero(used)[front]] = (5.0 * cosine / samples["density"][used])[front]
    spread = np.hypot(sampled.std() / np.sqrt(len(sampled)), values.std() / np.sqrt(len(values)))
    assert front.mean() > 0.3
    assert abs(sampled.mean() - values.mean()) < 5 * spread


TRIANGLES = {
    "near": [(-1, -1, 0), (2, -1, 0), (-1, 2, 0.5)],
    "from a place beside its plane": [(1, -1, -1.4), (1.5, 1, -1.4), (4, 0, -1.3)],
    "all around": [(-300, -200, 1), (300, -200, 1), (0, 400, 1)],
    "a needle": [(-2, 0, 0), (2, 0, 0), (2, 0.05, 0)],
    "far and huge": [(-1e5, -1e5, 1e5), (1e5, -1e5, 1e5), (-1e5, 1e5, 2e5)],
}


def solid_angle(corners):
    """By the angles between the planes through the viewpoint."""
    a, b, c = (corner / np.linalg.norm(corner) for corner in corners)

    def angle(at, one, other):
        first, second = np.cross(at, one), np.cross(at, other)
        return np.arctan2(np.linalg.norm(np.cross(first, second)), first @ second)

    return angle(a, b, c) + angle(b, c, a) + angle(c, a, b) - np.pi


@pytest.mark.parametrize("name", TRIANGLES)
def test_a_large_triangle_is_sampled_evenly_by_solid_angle(core, name):
    corners = np.float32(TRIANGLES[name])
    probe = core.LightProbe(
        emitter_scene(core, lambda scene: scene.add_mesh("triangle", corners, np.int32([[0, 1, 2]])))
    )
    samples = probe.sample(POSITION, random_numbers(40000))
    seen = corners.astype(np.float64) + (0, 0, 1.5) - POSITION
    whole = solid_angle(seen)
    np.testing.assert_allclose(samples["density"], 1 / whole, rtol=1e-3)
    # The parts beyond the middles of two sides take their shares.
    weights = np.linalg.solve(seen.T, samples["direction"].astype(np.float64).T)
    _, u, v = weights / weights.sum(0)
    middles = 0.5 * (seen + np.roll(seen, -1, 0))
    parts = {
        "corner 1": (u > 0.5, solid_angle([seen[1], middles[1], middles[0]])),
        "corner 2": (v > 0.5, solid_angle([seen[2], middles[2], middles[1]])),
        "corner 0": (u + v < 0.5, solid_angle([seen[0], middles[0], middles[2]])),
    }
    for part, (inside, angle) in parts.items():
        share = angle / whole
        spread = np.sqrt(share * (1 - share) / len(inside)) + 1e-4
        assert abs(inside.mean() - share) < 5 * spread, part


def test_of_thousands_of_emitting_triangles_the_density_still_integrates_to_one(core):
    rng = np.random.default_rng(5)
    corners = rng.uniform(-3, 3, (3000, 1, 3)) + rng.normal(0, 0.15, (3000, 3, 3)) + [0, 0, 4]
    vertices = corners.reshape(-1, 3).astype(np.float32)
    triangles = np.arange(9000, dtype=np.int32).reshape(-1, 3)
    probe = core.LightProbe(emitter_scene(core, lambda scene: scene.add_mesh("confetti", vertices, triangles)))
    assert probe.count() == 3000
    # The nearest triangle along a direction is only one of those a light sample may mean: the look's density stays
    # below 1 in all, and no sample's density may differ from it where the sampled triangle is the nearest.
    samples = probe.sample(POSITION, random_numbers(20000))
    _, density = probe.look(POSITION, samples["direction"].astype(np.float64))
    equal = np.isclose(density, samples["density"], rtol=1e-2).mean()
    share = 4 * np.pi * probe.look(POSITION, sphere_directions(200000))[1]
    visible = share.mean()
    error = share.std() / np.sqrt(len(share)) + 1 / np.sqrt(len(samples["density"]))
    assert 0.2 < visible < 1
    assert abs(equal - visible) < 5 * error, "the share of unoccluded samples is the integral of the visible density"
