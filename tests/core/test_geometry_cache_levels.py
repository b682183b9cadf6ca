"""Rays of different widths see shells diced at different levels, and no ray passes between them."""

import numpy as np
import pytest
from core import shapes

trace = shapes.trace
RAYS = 100_000
COARSE, MEDIUM, FINE = range(3)


def ring_points(random, count, radius):
    angle = random.uniform(0, 2 * np.pi, count)
    return radius * np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)


# Points inside each shell.
SHELLS = {
    "nurbs_sphere": lambda random, n: 0.3 * shapes.random_directions(random, n),
    "nurbs_torus": lambda random, n: ring_points(random, n, 0.75),
    "lumpy_torus": lambda random, n: ring_points(random, n, 0.7),
}


def any_widths(random, count):
    """Widths and spreads over six orders of magnitude."""
    return [(10 ** random.uniform(-6, 0, count)).astype(np.float32) for _ in range(2)]


def own_level(anchors):
    return anchors[:, 2] & 15


def tracer_of(name, matrix=np.eye(4), **settings):
    return trace.Tracer(
        [(getattr(shapes, name)(), matrix, shapes.EVERYTHING)], cache=trace.GeometryCacheSettings(**settings)
    )


@pytest.mark.slow
@pytest.mark.parametrize("stochastic", [False, True])
@pytest.mark.parametrize("name", SHELLS)
def test_rays_of_all_widths_cross_a_closed_shell_in_turn(name, stochastic):
    random = np.random.default_rng(1)
    tracer = tracer_of(name, stochastic=stochastic)
    origins, directions = SHELLS[name](random, RAYS), shapes.random_directions(random, RAYS)
    width, spread = any_widths(random, RAYS)
    broken = trace.cracks(tracer, origins, directions, width, spread, inside=True)
    assert not broken.any(), f"{broken.sum()}, first {origins[broken][0]!r} towards {directions[broken][0]!r}"
    far = 5 * shapes.random_directions(random, RAYS)
    towards = shapes.unit(SHELLS[name](random, RAYS) - far)
    broken = trace.cracks(tracer, far, towards, width, spread, inside=False)
    assert not broken.any(), f"{broken.sum()}, first {far[broken][0]!r} towards {towards[broken][0]!r}"
    hits = tracer.closest_hits(origins, directions, width=width, spread=spread)
    levels = np.bincount(own_level(hits["anchors"]), minlength=4)
    assert (levels[:4] > RAYS / 200).all(), levels  # levels were mixed, and subpatches split on demand


def test_a_shell_with_a_hole_is_told_from_a_closed_one():
    random = np.random.default_rng(2)
    u, v = np.meshgrid(np.linspace(0, 1.8 * np.pi, 12), np.linspace(0, 2 * np.pi, 12))
    tube = 0.75 + 0.25 * np.cos(u)
    points = np.stack([tube * np.cos(v), tube * np.sin(v), 0.25 * np.sin(u), np.ones_like(u)], axis=2)
    open_torus = trace.PatchSurface("open", [(points, (4, False, True, False), (4, False, True, False), True, 0)])
    tracer = trace.Tracer([(open_torus, np.eye(4), shapes.EVERYTHING)])
    origins, directions = ring_points(random, 2000, 0.75), shapes.random_directions(random, 2000)
    broken = trace.cracks(tracer, origins, directions, 0.0, 0.0, inside=True)
    assert 0.02 < broken.mean() < 0.9


@pytest.mark.slow
@pytest.mark.parametrize("place", [shapes.moved(0.0), shapes.moved(1e6), np.diag([-3.0, 0.01, 1.0, 1.0])])
@pytest.mark.parametrize("name", SHELLS)
def test_wide_rays_that_start_where_others_hit_never_leave_a_closed_shell(name, place):
    random = np.random.default_rng(3)
    count = 20_000
    tracer = tracer_of(name, place)
    origins = SHELLS[name](random, count) @ place[:3, :3].T + place[:3, 3]
    directions = shapes.random_directions(random, count)
    starts = np.zeros((0, 4), np.uint32)
    for bounce in range(5):
        width, spread = any_widths(random, count)
        hits = tracer.closest_hits(origins, directions, width=width, spread=spread, starts=starts)
        normals = hits["facet_normal"].astype(np.float64)
        missed = hits["instance"] < 0
        outside = np.flatnonzero(missed | (np.sum(normals * directions, axis=1) < -1e-6))
        # As for facets of one size, but coarse ones meet at sharper edges: a ray that starts near a sharp edge may be
        # behind the other facet by the offset.
        assert len(outside) <= count * 5e-4, f"bounce {bounce}: {origins[outside[:3]]!r}"
        normals[missed] = -directions[missed]
        directions = shapes.random_directions(random, count)
        directions *= -np.sign(np.sum(normals * directions, axis=1))[:, None]
        origins = shapes.leaving(hits, directions)
        starts = np.where(missed[:, None], np.uint32(2**32 - 1), hits["anchors"])


def test_a_ray_without_the_start_of_another_width_meets_the_wall_that_it_leaves():
    random = np.random.default_rng(4)
    tracer = tracer_of("nurbs_sphere")
    count = 20_000
    origins, directions = SHELLS["nurbs_sphere"](random, count), shapes.random_directions(random, count)
    hits = tracer.closest_hits(origins, directions)
    outwards = shapes.random_directions(random, count)
    outwards *= np.sign(np.sum(hits["facet_normal"] * outwards, axis=1))[:, None]
    inwards, wide = -outwards, np.float32(0.3)
    leaving = shapes.leaving(hits, inwards)
    anchored = tracer.closest_hits(leaving, inwards, width=wide, spread=wide, starts=hits["anchors"])
    forgotten = tracer.closest_hits(leaving, inwards, width=wide, spread=wide)
    assert (anchored["instance"] >= 0).all()
    assert (forgotten["instance"] < 0).sum() > 100  # they began outside of the coarse wall


def test_wider_rays_see_coarser_facets_and_narrow_ones_the_finest():
    random = np.random.default_rng(5)
    tracer = tracer_of("lumpy_torus")
    origins, directions = SHELLS["lumpy_torus"](random, 5000), shapes.random_directions(random, 5000)
    means = []
    for width in (1e-5, 1e-4, 1e-3, 1e-2, 0.1, 1.0):
        hits = tracer.closest_hits(origins, directions, width=np.float32(width))
        means.append(own_level(hits["anchors"]).mean())
    assert means == sorted(means, reverse=True) and means[0] > FINE and means[-1] == COARSE
    without = tracer.closest_hits(origins, directions)
    assert (own_level(without["anchors"]) == FINE).all()


def test_facets_lie_as_near_to_the_surface_as_the_rays_width_asks_for():
    random = np.random.default_rng(6)
    tracer = tracer_of("lumpy_torus")
    origins, directions = SHELLS["lumpy_torus"](random, 20_000), shapes.random_directions(random, 20_000)
    for width in (1e-4, 1e-3, 1e-2):
        hits = tracer.closest_hits(origins, directions, width=np.float32(width))
        off = np.linalg.norm(hits["facet_position"] - hits["position"], axis=1)
        along = np.abs(np.sum(hits["normal"] * (hits["facet_position"] - hits["position"]), axis=1))
        # A quad is no longer than the ray is wide, or its facets lie within a tenth of the width; either bounds the
        # distance along the normal.
        assert along.max() < 0.15 * width, (width, along.max(), off.max())


def test_a_factor_of_two_is_a_ray_twice_as_wide():
    random = np.random.default_rng(7)
    origins, directions = SHELLS["lumpy_torus"](random, 5000), shapes.random_directions(random, 5000)
    wide = tracer_of("lumpy_torus").closest_hits(origins, directions, width=np.float32(0.02))
    doubled = tracer_of("lumpy_torus", factor=2.0).closest_hits(origins, directions, width=np.float32(0.01))
    np.testing.assert_array_equal(wide["t"], doubled["t"])


def test_stochastic_rounding_is_the_same_for_the_same_ray_and_coarser_for_some():
    random = np.random.default_rng(8)
    origins, directions = SHELLS["lumpy_torus"](random, 20_000), shapes.random_directions(random, 20_000)
    width = np.float32(0.01)
    up = own_level(tracer_of("lumpy_torus").closest_hits(origins, directions, width=width)["anchors"])
    tracer = tracer_of("lumpy_torus", stochastic=True)
    first, second = (tracer.closest_hits(origins, directions, width=width) for _ in range(2))
    np.testing.assert_array_equal(first["t"], second["t"])
    rounded = own_level(first["anchors"])
    # Where two levels meet, a ray may hit another subpatch than before, at most one level coarser.
    assert 0.1 < (rounded < up).mean() < 0.9 and (rounded > up).mean() < 0.01


def test_a_beam_that_narrows_sees_finer_facets_near_its_focus_than_before_and_behind_it():
    random = np.random.default_rng(9)
    tracer = tracer_of("lumpy_torus")
    origins = 4 * shapes.random_directions(random, 20_000)
    directions = shapes.unit(SHELLS["lumpy_torus"](random, 20_000) - origins)
    away = np.linalg.norm(SHELLS["lumpy_torus"](random, 1)[0] - origins, axis=1)
    means = []
    for focus in (0.3, 1.0, 3.0):  # of the way, about
        hits = tracer.closest_hits(
            origins, directions, width=np.float32(0.2), spread=(-0.2 / (focus * away)).astype(np.float32)
        )
        means.append(own_level(hits["anchors"])[hits["instance"] >= 0].mean())
    assert means[1] > means[0] + 0.3 and means[1] > means[2] + 0.3, means


def test_a_concave_mirror_that_looks_at_a_large_patch_gets_facets_as_fine_as_its_rays_are_narrow():
    random = np.random.default_rng(11)
    count, focal_length, width = 20_000, 3.0, 0.02
    # A view that needs no detail: the sphere has few large patches. Its lowest point is near the mirror's focus.
    ball = [(shapes.nurbs_sphere(), np.eye(4), shapes.EVERYTHING)]
    tracer = trace.Tracer(ball, pixel_angle=1.0, cache=trace.GeometryCacheSettings())
    focus = np.array([0.0, 0.0, -1.0])
    places = 0.5 * random.uniform(-1, 1, (count, 2))
    # Parallel rays come down on a mirror that looks up, a paraboloid, and leave it towards the focus.
    height = np.sum(places**2, axis=1) / (4 * focal_length) - focal_length - 1.0
    origins = np.concatenate([places, height[:, None]], axis=1)
    directions = shapes.unit(focus + random.normal(0, 2e-3, (count, 3)) - origins)
    reach = np.linalg.norm(focus - origins, axis=1)
    mirrored, plain = (
        tracer.closest_hits(origins, directions, width=np.float32(width), spread=spread)
        for spread in ((-width / reach * 0.98).astype(np.float32), np.float32(0.0))
    )
    at_hit = width * (1 - 0.98 * mirrored["t"] / reach)
    off = np.abs(np.sum(mirrored["normal"] * (mirrored["facet_position"] - mirrored["position"]), axis=1))
    assert (at_hit < 0.05 * width).all() and (mirrored["instance"] == 0).all()
    assert (off < 0.15 * at_hit).all(), (off / at_hit).max()
    assert (own_level(mirrored["anchors"]) > own_level(plain["anchors"])).all()
    assert (own_level(mirrored["anchors"]) > FINE).all()


def test_wide_rays_in_a_stretched_instance_see_what_they_see_in_the_shape_itself():
    random = np.random.default_rng(10)
    scale = 1e3
    origins, directions = SHELLS["lumpy_torus"](random, 5000), shapes.random_directions(random, 5000)
    width, spread = any_widths(random, 5000)
    alone = tracer_of("lumpy_torus").closest_hits(origins, directions, width=width, spread=spread)
    large = tracer_of("lumpy_torus", np.diag([scale, scale, scale, 1.0])).closest_hits(
        origins * scale, directions, width=width * np.float32(scale), spread=spread
    )
    # Levels are chosen in single precision; a width at the border of two levels may give either.
    assert (own_level(alone["anchors"]) == own_level(large["anchors"])).mean() > 0.99
