"""Rays against strands: none that is aimed at the axis misses, and each leaves as often as it enters."""

import numpy as np
import pytest
from rayleaf import _core

from core.strand_shapes import S_CURVE, bezier_points, crossings, strand, torus_knot, tracer

RANDOM_POINTS = np.random.default_rng(5).random((12, 3))


def rays_at_the_axis(count, seed, offset):
    """Origins and directions of rays that meet the axis of S_CURVE, moved; not at its very ends."""
    random = np.random.default_rng(seed)
    direction = random.normal(size=(count, 3))
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    target = bezier_points(S_CURVE, random.uniform(0.001, 0.999, count)) + offset
    return target, target - direction * 3.0, direction


@pytest.mark.parametrize("form", ["ROUND", "RIBBON"])
@pytest.mark.parametrize("offset", [0.0, 1e2, 1e4, 1e6])
@pytest.mark.parametrize("radius", [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6])
def test_no_ray_aimed_at_the_axis_is_lost(form, offset, radius):
    _, origins, directions = rays_at_the_axis(10_000, 7, np.array([offset, -offset, offset]))
    scene = tracer(strand(S_CURVE, radius, basis="BEZIER", form=form), (offset, -offset, offset))
    hits = scene.closest_hits(origins, directions)
    assert np.count_nonzero(~np.isfinite(hits["t"])) == 0
    assert scene.occluded(origins, directions).all()


def distance_to_axis(position):
    """From a point to S_CURVE: the best of many places of the axis, then of many around it, and again."""
    middle, reach = 0.5, 0.5
    for _ in range(4):
        places = np.clip(np.linspace(middle - reach, middle + reach, 2001), 0.0, 1.0)
        distances = np.linalg.norm(bezier_points(S_CURVE, places) - position, axis=1)
        middle, reach = places[np.argmin(distances)], reach / 500
    return distances.min()


@pytest.mark.parametrize("radius", [1e-1, 1e-3, 1e-5])
def test_a_hit_lies_on_the_balls_around_the_axis(radius):
    _, origins, directions = rays_at_the_axis(300, 8, 0.0)
    hits = tracer(strand(S_CURVE, radius, basis="BEZIER")).closest_hits(origins, directions)
    distances = np.array([distance_to_axis(position) for position in hits["position"]])
    assert np.abs(distances - np.float32(radius)).max() < 1e-13 + 1e-9 * radius


UNEVEN = {
    "fast at an end": np.array([[0, 0, 0], [0.6, 0, 0], [0.8, 0, 0], [1, 0, 0]]),
    "slow at both": np.array([[0, 0, 0], [0.05, 0, 0], [0.95, 0, 0], [1, 0, 0]]),
    "bent a little": np.array([[0, 0, 0], [0.6, 0.02, 0], [0.8, 0.01, 0.02], [1, 0, 0.05]]),
}


@pytest.mark.parametrize("radii", [(0.1, 0.1), (0.1, 0.02), (0.01, 0.008)], ids=["even", "tapered", "thin"])
@pytest.mark.parametrize("name", UNEVEN)
def test_strands_whose_parameter_runs_unevenly_are_the_balls_around_their_axis(name, radii):
    """Rays at all angles, most of them nearly along the axis: the first of many balls that each meets."""
    points, random = UNEVEN[name], np.random.default_rng(17)
    places = np.linspace(0.0, 1.0, 4001)
    centers = bezier_points(points, places)
    ball_radii = np.float32(radii[0]) * (1 - places) + np.float32(radii[1]) * places
    target = bezier_points(points, random.random(400)) + random.normal(size=(400, 3)) * radii[0] * 0.7
    direction = np.array([1.0, 0, 0]) + random.normal(size=(400, 3)) * 10.0 ** random.uniform(-2, 0.5, (400, 1))
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    origins = target - direction * 3.0
    given = np.linspace(*radii, 4).astype(np.float32)
    hits = tracer(strand(points, given, basis="BEZIER")).closest_hits(origins, direction)["t"]
    way = centers[None] - origins[:, None]
    along = np.einsum("rbk,rk->rb", way, direction)
    inside = ball_radii**2 - (np.einsum("rbk,rbk->rb", way, way) - along**2)
    expected = np.where(inside > 0, along - np.sqrt(np.maximum(inside, 0)), np.inf).min(axis=1)
    sure = inside.max(axis=1) > 1e-3 * radii[1] ** 2  # of rays that graze, some pass between the balls
    assert sure.sum() > 100
    np.testing.assert_allclose(hits[sure], expected[sure], rtol=0, atol=3e-4)  # about from ball to ball
    assert not np.isfinite(hits[inside.max(axis=1) < -1e-3 * radii[1] ** 2]).any()


RODS = {
    "straight": lambda: strand([[0, 0, 0], [1, 0.2, 0.1]], 0.05, basis="LINEAR"),
    "bent at corners": lambda: strand([[0, 0, 0], [1, 0, 0], [0.3, 0.4, 0.1], [0, 0.1, 0]], 0.1, basis="LINEAR"),
    "bent": lambda: strand(RANDOM_POINTS, 0.05),
    "tapered to nothing": lambda: strand(RANDOM_POINTS, np.linspace(0.1, 0.0, 12)),
    "knotted": lambda: strand(torus_knot(), 0.3, cyclic=np.array([1], np.uint8)),
    "touching itself": lambda: strand(torus_knot(), 0.9, cyclic=np.array([1], np.uint8)),
    "a hairpin tighter than its radius": lambda: strand(
        [[0, 0, 0], [1, 0, 0], [1, 0.01, 0], [0, 0.01, 0]], 0.1, basis="BEZIER"
    ),
    "a B-spline": lambda: strand(RANDOM_POINTS, 0.05, basis="BSPLINE"),
    "a ball": lambda: strand([[0, 0, 0], [0, 0, 0]], 0.2),
    "a chain of balls": lambda: strand(RANDOM_POINTS, 0.08, form="SPHERES"),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", RODS)
def test_a_ray_leaves_a_glass_rod_as_often_as_it_enters(name):
    counts = crossings(RODS[name](), 4000, seed=3)
    assert counts["hits"] > 200
    assert (counts["unbalanced"], counts["misplaced"], counts["endless"]) == (0, 0, 0)


@pytest.mark.parametrize("basis", ["LINEAR", "CATMULL_ROM", "BSPLINE"])
def test_a_strand_whose_points_are_one_is_a_ball(basis):
    middle, radius = np.array([0.3, -0.2, 0.7]), float(np.float32(0.4))
    scene = tracer(strand(np.tile(middle, (4, 1)), radius, basis=basis))
    random = np.random.default_rng(11)
    origins, aims = middle + 3 * random.normal(size=(2000, 3)), middle + 0.3 * random.normal(size=(2000, 3))
    directions = (aims - origins) / np.linalg.norm(aims - origins, axis=1)[:, None]
    hits = scene.closest_hits(origins, directions)
    towards = np.einsum("ij,ij->i", middle - origins, directions)
    inside = radius**2 - (np.linalg.norm(middle - origins, axis=1) ** 2 - towards**2)
    root = np.sqrt(np.maximum(inside, 0.0))
    outside = np.linalg.norm(middle - origins, axis=1) > radius
    expected = np.where((inside > 0) & (towards > 0), np.where(outside, towards - root, towards + root), np.inf)
    clear = np.abs(inside) > 1e-9
    assert (expected[clear] < np.inf).sum() > 500
    assert np.allclose(hits["t"][clear], expected[clear], atol=1e-7)
    normals = hits["facet_normal"][hits["t"] < np.inf]
    places = hits["position"][hits["t"] < np.inf]
    assert np.allclose(normals, (places - middle) / radius, atol=1e-5)


def test_a_ray_along_a_straight_strand_meets_its_round_ends():
    scene = tracer(strand([[0, 0, 0], [1, 0, 0]], 0.1, basis="LINEAR"))
    hits = scene.closest_hits([[-2, 0.03, 0], [0.5, 0.03, 0]], [[1, 0, 0], [1, 0, 0]])
    reach = np.sqrt(np.float32(0.1) ** 2 - 0.03**2)
    assert np.allclose(hits["t"], [2 - reach, 0.5 + reach], atol=1e-9)


def test_a_ray_that_starts_in_hair_meets_other_hair_alone():
    """At the roots, strands lie in one another: the one that the ray starts in is not there, whatever pieces it has."""
    bent = [[0, 0, 0], [0.3, 0.1, 0], [0.7, -0.1, 0], [1, 0, 0]]
    points = np.concatenate([bent, np.add(bent, (0, 0, 0.15)), np.add(bent, (0, 0, 1.0))])
    radii, offsets = np.full(12, 0.1, np.float32), np.array([0, 4, 8, 12], np.int32)
    random = np.random.default_rng(5)
    directions = random.normal(size=(500, 3)) * (1.0, 0.3, 0.3)
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    inside = np.tile([0.5, 0.0, 0.0], (500, 1))
    solid, hair = (
        tracer(_core.Strands("hair", points, radii, offsets, has_inside=inside_too)).closest_hits(inside, directions)
        for inside_too in (True, False)
    )
    facing = np.einsum("ij,ij->i", hair["facet_normal"], directions)
    met = hair["t"] < np.inf
    assert (solid["t"] < np.inf).all() and 50 < met.sum() < 450
    assert (facing[met] < 0).all()
    assert (hair["t"] >= solid["t"]).all()


def hair_loop(form):
    """A closed loop of hair in the plane z = 0, of radius 1, and its tracer."""
    angles = np.linspace(0.0, 2.0 * np.pi, 25)[:-1]
    points = np.stack([np.cos(angles), np.sin(angles), np.zeros(24)], 1)
    closed = np.ones(1, np.uint8)
    return tracer(strand(points, 0.05, cyclic=closed, form=form, has_inside=False))


def rays_off(hits, side, seed):
    """Rays from hits on hair: on the outer side of the wall, or through the fibre."""
    random = np.random.default_rng(seed)
    normals = hits["facet_normal"].astype(float)
    directions = random.normal(size=normals.shape)
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    cosines = np.einsum("ij,ij->i", directions, normals)
    directions *= np.where(cosines * side < 0, -1.0, 1.0)[:, None]
    origins = hits["facet_position"] + normals * (side * hits["start_offset"])[:, None]
    clear = np.abs(cosines) > 1e-3
    return origins[clear], directions[clear], hits["anchors"][clear]


@pytest.mark.parametrize("together", [1, 16])
@pytest.mark.parametrize("form, side", [("ROUND", 1), ("ROUND", -1), ("RIBBON", 1)])
def test_a_ray_that_starts_on_hair_does_not_meet_it_there(form, side, together):
    """It meets the far side of the loop, where it goes there."""
    scene = hair_loop(form)
    random = np.random.default_rng(7)
    angles, sides = random.uniform(0, 2 * np.pi, 4000), random.uniform(-0.04, 0.04, 4000)
    aims = np.stack([np.cos(angles) * (1 + sides), np.sin(angles) * (1 + sides), np.zeros(4000)], 1)
    first = scene.closest_hits(aims + (0, 0, 2), np.tile([0.0, 0.0, -1.0], (4000, 1)))
    assert np.isfinite(first["t"]).all()
    origins, directions, starts = rays_off(first, side, 8)
    hits = scene.closest_hits(origins, directions, starts=starts, together=together)
    met = np.isfinite(hits["t"])
    own, other = starts[met, 3].astype(int), hits["primitive"][met]
    assert 5 < met.sum() < 0.1 * len(met)
    assert (own != other).all()
    if form == "ROUND":
        assert (hits["t"][met] > 0.1).all()
        assert (np.einsum("ij,ij->i", hits["facet_normal"][met], directions[met]) < 0).all()
    else:  # the band beside it turns towards each ray
        assert np.isin((own - other)[hits["t"][met] < 0.1] % 24, (1, 23)).all()


def test_a_ribbon_is_cut_straight_at_its_ends_and_faces_the_ray():
    scene = tracer(strand([[0, 0, 0], [1, 0, 0]], 0.1, basis="LINEAR", form="RIBBON"))
    origins = [[-0.05, 0, 2], [0.05, 0.09, 2], [0.05, 0.11, 2], [0.95, -0.09, 2], [1.05, 0, 2]]
    hits = scene.closest_hits(origins, [[0, 0, -1]] * 5)
    assert np.isfinite(hits["t"]).tolist() == [False, True, False, True, False]
    assert np.allclose(hits["facet_normal"][1], [0, 0, 1]) and np.allclose(hits["t"][1], 2.0)
    # Shaded as if round: the normal turns to the side on which the ray passes the axis.
    assert np.allclose(hits["normal"][1], [0, 0.9, np.sqrt(1 - 0.81)], atol=1e-5)


def test_the_same_hits_come_whichever_way_the_bases_describe_a_curve():
    points = RANDOM_POINTS
    before, after = np.vstack([points[:1], points[:-2]]), np.vstack([points[2:], points[-1:]])
    handles_out, handles_in = points[:-1] + (points[1:] - before) / 6, points[1:] - (after - points[:-1]) / 6
    bezier = np.vstack([np.stack([points[:-1], handles_out, handles_in], 1).reshape(-1, 3), points[-1:]])
    random = np.random.default_rng(2)
    directions = random.normal(size=(2000, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    origins = random.random((2000, 3)) - 5 * directions
    hits = [
        tracer(strand(given, 0.1, basis=basis)).closest_hits(origins, directions)["t"]
        for given, basis in ((points, "CATMULL_ROM"), (bezier, "BEZIER"))
    ]
    found = np.isfinite(hits[0])
    assert np.array_equal(found, np.isfinite(hits[1])) and found.sum() > 200
    assert np.allclose(hits[0][found], hits[1][found], rtol=0, atol=1e-6)


def test_of_many_strands_the_nearest_is_hit():
    height = np.arange(50) * 0.1
    points = np.zeros((100, 3))
    points[:, 2] = np.repeat(height, 2)
    points[0::2, 0], points[1::2, 0] = -1, 1
    offsets = np.arange(0, 101, 2, dtype=np.int32)
    many = _core.Strands("many", points, np.full(100, 0.01, np.float32), offsets, basis="LINEAR")
    hits = tracer(many).closest_hits([[0.3, 0, 10], [0.3, 0, -10]], [[0, 0, -1], [0, 0, 1]])
    assert hits["primitive"].tolist() == [49, 0]
    assert np.allclose(hits["t"], [10 - 4.9 - 0.01, 10 - 0.01])


def tuft():
    """A few hundred strands in each other's way."""
    random = np.random.default_rng(12)
    points = random.random((300, 1, 3)) + np.cumsum(random.normal(0, 0.08, (300, 6, 3)), axis=1)
    offsets = np.arange(0, 300 * 6 + 1, 6, dtype=np.int32)
    return _core.Strands("tuft", points.reshape(-1, 3), np.full(300 * 6, 0.02, np.float32), offsets)


SHAPES = {**RODS, "a tuft": tuft, "ribbons": lambda: strand(RANDOM_POINTS, 0.05, form="RIBBON")}


@pytest.mark.slow
@pytest.mark.parametrize("coherent", [False, True])
@pytest.mark.parametrize("name", SHAPES)
def test_packets_find_the_very_hits_of_single_rays_on_all_instruction_sets(name, coherent, any_target):
    """Also of rays that start on strands and inside them, and of short ones."""
    random = np.random.default_rng(31)
    shape = SHAPES[name]()
    low, high = (np.array(corner) for corner in tracer(shape).bounds())
    origins = low + random.random((3000, 3)) * (high - low)
    directions = random.normal(size=origins.shape)
    origins[:1000] = low - 1.0  # as a camera's
    directions[:1000] = low + random.random((1000, 3)) * (high - low) - origins[:1000]
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    on = tracer(shape).closest_hits(origins, directions)
    hit = np.isfinite(on["t"])
    starts = np.concatenate([origins, on["facet_position"][hit]])
    towards = np.concatenate([directions, random.normal(size=(hit.sum(), 3))])
    alone, shadows = None, None
    for target in _core.trace.simd_targets():
        assert _core.trace.use_simd_target(target)
        scene = tracer(shape)
        if alone is None:
            alone = scene.closest_hits(starts, towards)
            reach = np.where(np.isfinite(alone["t"]), alone["t"] * random.choice([0.5, 1.0, 2.0], len(starts)), 1.0)
            shadows = scene.occluded(starts, towards, t_max=reach)
            assert 50 < np.isfinite(alone["t"]).sum()
        together = _core.trace.closest_in_packets(scene, starts, towards, coherent)
        for part in ("t", "instance", "primitive"):
            np.testing.assert_array_equal(together[part], alone[part], err_msg=f"{part} by {target}")
        found = np.isfinite(alone["t"])
        np.testing.assert_array_equal(together["position"][found], alone["position"][found])
        np.testing.assert_array_equal(
            _core.trace.occluded_in_packets(scene, starts, towards, reach, coherent), shadows, err_msg=target
        )


@pytest.mark.parametrize("height", [0.0, 0.2, 0.315])
def test_coincident_points_are_a_ball_of_the_largest_radius(height):
    """Where the axis stands still, the radius changes: the nearest ball decides, not a place near it."""
    radii = np.array([0.1, 0.5, 0.4, 0.1])
    places = np.linspace(0.0, 1.0, 100_001)
    weights = [(1 - places) ** 3, 3 * (1 - places) ** 2 * places, 3 * (1 - places) * places**2, places**3]
    largest = sum(weight * radius for weight, radius in zip(weights, radii)).max()
    strands = _core.Strands("ball", np.zeros((4, 3)), radii.astype(np.float32), np.int32([0, 4]), basis="BEZIER")
    scene = _core.trace.Tracer([(strands, np.eye(4), 31)])
    found = scene.closest_hits([[0.0, height, -2.0]], [[0.0, 0.0, 1.0]])["t"][0]
    assert found == pytest.approx(2.0 - np.sqrt(largest**2 - height**2), abs=2e-7)
