"""No ray leaves a closed shell: not from inside, not from a point of its wall, at no size and no distance."""

import numpy as np
import pytest
from core import shapes

BOUNCES = 5
RAYS = 20_000
# The inside of each shape: points near its middle line.
SHELLS = {
    "nurbs_sphere": lambda random, n: 0.3 * shapes.random_directions(random, n),
    "nurbs_torus": lambda random, n: ring_points(random, n, 0.75),
    "lumpy_torus": lambda random, n: ring_points(random, n, 0.7),
    "cube": lambda random, n: random.uniform(-0.9, 0.9, (n, 3)),
    "lumpy_mesh": lambda random, n: 0.3 * shapes.random_directions(random, n),
}
PLACES = {
    "at the origin": shapes.moved(0.0),
    "a million away": shapes.moved(1e6),
    "tiny": shapes.moved(1.0, 1e-6),
    "huge": shapes.moved(0.0, 1e6),
    "mirrored and stretched": np.diag([-3.0, 0.01, 1.0, 1.0]),
}


def ring_points(random, count, radius):
    angle = random.uniform(0, 2 * np.pi, count)
    return radius * np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)


@pytest.mark.slow
@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("name", SHELLS)
def test_rays_bounce_inside_a_closed_shell_and_never_leave(name, place):
    random = np.random.default_rng(11)
    matrix = PLACES[place]
    tracer = shapes.trace.Tracer([(getattr(shapes, name)(), matrix, shapes.EVERYTHING)])
    origins = SHELLS[name](random, RAYS) @ matrix[:3, :3].T + matrix[:3, 3]
    directions = shapes.random_directions(random, RAYS)
    for bounce in range(BOUNCES):
        hits = tracer.closest_hits(origins, directions)
        escaped = np.flatnonzero(hits["instance"] < 0)
        assert len(escaped) == 0, f"bounce {bounce}: {origins[escaped[:3]]!r} towards {directions[escaped[:3]]!r}"
        normals = hits["facet_normal"].astype(np.float64)
        outside = np.flatnonzero(np.sum(normals * directions, axis=1) < -1e-6)
        # Where two walls meet at a sharp edge, a ray that starts on one may lie behind the other by the offset.
        assert len(outside) <= RAYS * 1e-4, f"bounce {bounce}: hit from outside, {origins[outside[:3]]!r}"
        directions = shapes.random_directions(random, RAYS)
        directions *= -np.sign(np.sum(normals * directions, axis=1))[:, None]
        origins = shapes.leaving(hits, directions)


@pytest.mark.parametrize("name", SHELLS)
def test_a_ray_that_leaves_to_the_outside_of_a_convex_wall_meets_nothing(name):
    if "torus" in name or name == "lumpy_mesh":
        pytest.skip("not convex: rays outside may come back")
    random = np.random.default_rng(12)
    tracer = shapes.trace.Tracer([(getattr(shapes, name)(), np.eye(4), shapes.EVERYTHING)])
    directions = shapes.random_directions(random, RAYS)
    hits = tracer.closest_hits(SHELLS[name](random, RAYS), directions)
    normals = hits["facet_normal"].astype(np.float64)
    outwards = shapes.random_directions(random, RAYS)
    outwards *= np.sign(np.sum(normals * outwards, axis=1))[:, None]
    again = tracer.closest_hits(shapes.leaving(hits, outwards), outwards)
    assert np.sum(again["instance"] >= 0) == 0
    assert not tracer.occluded(shapes.leaving(hits, outwards), outwards).any()


def test_the_far_wall_of_a_thin_slab_is_found_from_the_near_one():
    thickness = 1e-5  # of a slab 2 wide: what single precision still tells apart
    slab = np.diag([1.0, 1.0, thickness / 2, 1.0])
    tracer = shapes.trace.Tracer([(shapes.cube(), slab, shapes.EVERYTHING)])
    random = np.random.default_rng(13)
    origins = np.column_stack([random.uniform(-0.9, 0.9, (1000, 2)), np.full(1000, 1.0)])
    down = np.broadcast_to([0.0, 0.0, -1.0], origins.shape).copy()
    first = tracer.closest_hits(origins, down)
    second = tracer.closest_hits(shapes.leaving(first, down), down)
    np.testing.assert_allclose(second["t"], thickness, rtol=1e-2)
    np.testing.assert_array_equal(second["facet_normal"][:, 2], -1.0)


@pytest.mark.parametrize("name", ["cube", "lumpy_mesh", "nurbs_sphere", "lumpy_torus"])
def test_rays_at_the_shared_edges_and_corners_of_facets_hit(name):
    random = np.random.default_rng(14)
    shape = getattr(shapes, name)()
    tracer = shapes.trace.Tracer([(shape, np.eye(4), shapes.EVERYTHING)])
    if name == "cube":
        targets = shapes.CUBE_VERTICES.astype(float)[shapes.CUBE_TRIANGLES]
    elif name == "lumpy_mesh":
        hits = tracer.closest_hits(np.zeros((500, 3)), shapes.random_directions(random, 500))
        targets = hits["facet_position"][:, None, :]
    else:
        grids = [shapes.trace.diced_patch(shape, i).astype(float) for i in range(min(shape.element_count, 24))]
        targets = np.concatenate([grid.reshape(-1, 3) for grid in grids])[:, None, :]
    corners = targets.reshape(-1, 3)
    edges = 0.5 * (targets + np.roll(targets, 1, axis=1)).reshape(-1, 3)
    points = np.concatenate([corners, edges])
    middle = np.zeros_like(points)
    if name == "lumpy_torus":
        middle[:, :2] = 0.7 * shapes.unit(points[:, :2])
    towards = shapes.unit(points - middle)
    assert (tracer.closest_hits(middle, towards)["instance"] >= 0).all()
    assert tracer.occluded(middle, towards).all()
