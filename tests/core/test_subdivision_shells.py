"""No ray passes between the elements of a subdivision surface, for any topology and dicing."""

import numpy as np
import pytest
from core import shapes
from core import subdivision_cages as cages

RAYS = 20_000
SHELLS = {
    "cube": cages.cube,
    "tetrahedron": cages.tetrahedron,
    "prism": lambda: cages.prism(7),
    "poles of 64 faces": lambda: cages.double_pole(64),
    "half sharp cube": lambda: cages.creased(cages.cube(), [(0, 1), (1, 3), (4, 5)], 2.5),
    "sharp prism": lambda: cages.creased(cages.prism(5), [(i, (i + 1) % 5) for i in range(5)], 10.0),
}


def borders(cage):
    """Points on the lines between elements of the limit, in object space."""
    surface = cage.surface()
    count = surface.element_count
    at = np.linspace(0, 1, 65)
    elements = np.repeat(np.arange(count, dtype=np.int32), len(at))
    points = [
        surface.points(elements, np.tile(side, (count, 1)))[:, 0]
        for side in (np.stack([at, 0 * at], axis=1), np.stack([0 * at, at], axis=1))
    ]
    center, scale = surface.frame
    return np.concatenate(points) * scale + center


@pytest.mark.slow
@pytest.mark.parametrize("spread", [0.0, 0.003, 0.05])
@pytest.mark.parametrize("name", SHELLS)
def test_every_ray_from_inside_meets_the_shell(name, spread):
    cage = SHELLS[name]()
    random = np.random.default_rng(3)
    tracer = shapes.trace.Tracer([(cage.surface(), np.eye(4), shapes.EVERYTHING)], eye=(0.0, 0.0, 20.0))
    towards = borders(cage)
    towards = towards[random.integers(0, len(towards), RAYS // 2)]
    directions = np.concatenate([shapes.unit(towards), shapes.random_directions(random, RAYS // 2)])
    origins = 0.05 * shapes.random_directions(random, RAYS)
    hits = tracer.closest_hits(
        origins, directions, width=np.zeros(RAYS, np.float32), spread=np.full(RAYS, spread, np.float32)
    )
    missed = np.flatnonzero(hits["instance"] < 0)
    assert len(missed) == 0, f"{len(missed)} missed: {origins[missed[:3]]!r} towards {directions[missed[:3]]!r}"
    inside_out = np.sum(hits["normal"] * directions, axis=1) < -0.2
    # Wide rays see few facets, which may face another way than a wrinkled surface.
    assert spread > 0 or not inside_out.any(), f"{inside_out.sum()} normals point inwards"


def test_hits_lie_on_the_surface_whose_normal_they_have():
    surface = cages.prism(7).surface()
    random = np.random.default_rng(8)
    tracer = shapes.trace.Tracer([(surface, np.eye(4), shapes.EVERYTHING)], pixel_angle=1e-3, eye=(0.0, 0.0, 3.0))
    hits = tracer.closest_hits(np.zeros((2000, 3)), shapes.random_directions(random, 2000))
    at = np.stack([hits["u"], hits["v"]], axis=1).astype(float)
    points = surface.points(hits["primitive"], at)
    center, scale = surface.frame
    np.testing.assert_allclose(hits["position"], points[:, 0] * scale + center, atol=1e-9)
    normals = shapes.unit(np.cross(points[:, 2], points[:, 1]))
    np.testing.assert_allclose(hits["normal"], normals, atol=1e-5)
    # A tenth of a pixel at three units' distance; along the surface, equal parameters may lie farther apart.
    away = np.sum((hits["position"] - hits["facet_position"]) * hits["normal"], axis=1)
    assert np.abs(away).max() < 3e-4


def test_a_ray_from_outside_crosses_a_shell_an_even_number_of_times():
    cage = cages.double_pole(16)
    tracer = shapes.trace.Tracer([(cage.surface(), np.eye(4), shapes.EVERYTHING)], eye=(0.0, 0.0, 20.0))
    random = np.random.default_rng(9)
    directions = shapes.random_directions(random, 5000)
    crossings = np.zeros(5000, int)
    origins = -4 * directions + 0.4 * shapes.random_directions(random, 5000)
    start = np.zeros(5000)
    for _ in range(8):
        hits = tracer.closest_hits(origins, directions, t_min=start)
        found = hits["instance"] >= 0
        crossings += found
        start = np.where(found, hits["t"] + 1e-7, np.inf)
    # A ray along an edge may find both of its facets, or graze it.
    assert np.mean(crossings % 2) < 1e-3
