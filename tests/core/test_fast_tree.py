"""The fast tree: answers close to tracing, the same for any number of threads, cache size and batch of rays."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from core import ri_tree_support as support
from core import shapes
from core.ri_tree_support import BOX_MISSED, CELL_MISSED, INTERPOLATED, NOT_A_RAY, ORIGIN
from rayleaf import _core

KINDS = ("SIMPLE", "MIRROR", "GLASS", "VOLUME")


def fast_tree(shape, kind, **settings):
    """A fast tree with facets so fine that they do not matter."""
    return support.ri_tree.FastTree(shape, kind, **{"facet_tolerance": 2.0**-20, **settings})


def in_parts(tree, rays, order, size, threads=1, **spacing):
    """Asks rays in another order, a few at a time, by several threads; answers in the given order."""
    parts = [order[i : i + size] for i in range(0, len(order), size)]

    def ask(part):
        return tree.ask(rays[0][part], rays[1][part], **{name: value[part] for name, value in spacing.items()})

    with ThreadPoolExecutor(threads) as pool:
        answers = list(pool.map(ask, parts))
    back = np.argsort(order)
    names = (*support.OUTPUTS, "answered_by", "error")
    return {name: np.concatenate([answer[name] for answer in answers])[back] for name in names}


@pytest.mark.parametrize("kind", [*(pytest.param(kind, marks=pytest.mark.slow) for kind in KINDS[:-1]), KINDS[-1]])
def test_neither_threads_nor_company_nor_order_nor_cache_size_change_an_answer(kind):
    rays = support.scattered_rays(700, spread=0.6)
    shape, settings = shapes.nurbs_torus(), {"depth_limit": 20, "ior": 1.2, "angle_threshold": 1.5}
    plenty = fast_tree(shape, kind, **settings)
    expected = plenty.ask(*rays)
    assert plenty.statistics()["prunes"] == 0
    assert (expected["answered_by"] == INTERPOLATED).mean() > 0.1, support.counts(expected)
    random = np.random.default_rng(3)
    for cache_bytes, size, threads in ((10**8, 1, 1), (10**8, 7, 4), (300_000, 33, 4), (60_000, 50, 3)):
        tree = fast_tree(shape, kind, cache_bytes=cache_bytes, **settings)
        got = in_parts(tree, rays, random.permutation(len(rays[0])), size, threads)
        support.check_same_answers(expected, got)
        assert tree.statistics()["most_bytes"] <= cache_bytes
    few = slice(0, 40)
    tree = fast_tree(shape, kind, cache_bytes=0, **settings)
    got = tree.ask(rays[0][few], rays[1][few])
    support.check_same_answers({name: value[few] for name, value in expected.items() if name != "seconds"}, got)
    assert tree.statistics()["most_bytes"] == 0


@pytest.mark.parametrize("kind", KINDS)
def test_answers_are_tracings_own_or_close_to_it(kind):
    rays = support.rays_towards(np.zeros(3), 1.3, 4000)
    tree = fast_tree(shapes.nurbs_sphere(), kind, distance_threshold=0.01, direction_threshold=0.01)
    got, truth = tree.ask(*rays), tree.trace(*rays)
    by = got["answered_by"]
    assert (by == INTERPOLATED).mean() > 0.3, support.counts(got)
    traced = by >= support.MANY_CLASSES
    assert (got["error"][by == INTERPOLATED] <= 0.01 + 1e-6).all()
    for name in support.OUTPUTS:
        np.testing.assert_array_equal(got[name][traced], truth[name][traced], err_msg=name)
    used = (by == INTERPOLATED) & truth["hit"]
    # Misses in cells whose samples all hit, and vice versa, are silhouettes between samples.
    assert (got["hit"] != truth["hit"]).mean() < 0.002
    for name in ("normal", "exit_direction") if kind != "VOLUME" else ():
        error = support.angles(got[name], truth[name])[used]
        # The thresholds bound the error at centres, where that of an even function is largest.
        assert error.mean() < 0.004 and np.quantile(error, 0.99) < 0.02, (name, error.mean(), error.max())
    difference = np.abs(got["length"] - truth["length"])[used]
    assert difference.mean() < 0.004, difference.mean()


def test_rays_with_wide_spacing_are_traced_and_with_none_interpolated():
    rays = support.rays_towards(np.zeros(3), 0.6, 600)
    count = len(rays[0])
    tree = fast_tree(shapes.nurbs_sphere(), "MIRROR")
    wide = np.full(count, 5.0, np.float32)
    got = tree.ask(*rays, distances=wide, angles=wide)
    assert (got["answered_by"] == support.NOT_WORTH_IT).all(), support.counts(got)
    assert tree.statistics()["samples_taken"] == 0
    zero = np.zeros(count, np.float32)
    close = tree.ask(*rays, distances=zero, angles=zero)
    support.check_same_answers(close, tree.ask(*rays))
    # The cells exist now, but a ray's own spacing decides how it is answered.
    support.check_same_answers(got, tree.ask(*rays, distances=wide, angles=wide))
    mixed = np.where(np.arange(count) % 2 == 0, wide, zero)
    half = tree.ask(*rays, distances=mixed, angles=mixed)
    for first, expected in ((0, got), (1, close)):
        np.testing.assert_array_equal(half["exit_direction"][first::2], expected["exit_direction"][first::2])


def test_fewer_rays_per_cell_buy_more_samples_and_change_what_is_traced_alone():
    rays = support.rays_towards(np.zeros(3), 0.6, 600)
    spacing = {"distances": np.full(600, 0.02, np.float32), "angles": np.full(600, 0.005, np.float32)}
    shares = []
    for rays_per_cell in (0.0, 1.0, 8.0, 64.0, np.inf):
        tree = fast_tree(shapes.nurbs_sphere(), "MIRROR", rays_per_cell=rays_per_cell)
        got, truth = tree.ask(*rays, **spacing), tree.trace(*rays)
        traced = got["answered_by"] == support.NOT_WORTH_IT
        shares.append(traced.mean())
        np.testing.assert_array_equal(got["exit_direction"][traced], truth["exit_direction"][traced])
        if rays_per_cell == 0.0:
            support.check_same_answers(got, tree.ask(*rays))
    assert shares[0] == 0.0 and shares[-1] == 1.0 and (np.diff(shares) >= 0).all(), shares
    assert 0.0 < shares[3], shares


def spaced_frames(tree, rays, count, **company):
    """The same rays in consecutive frames: their answers, and the share of them in cells that too few rays cross."""
    spacing = {"distances": np.full(len(rays[0]), 0.02, np.float32), "angles": np.full(len(rays[0]), 0.005, np.float32)}
    frames = []
    for _ in range(count):
        order = np.arange(len(rays[0])) if not company else company["random"].permutation(len(rays[0]))
        frames.append(in_parts(tree, rays, order, company.get("size", 64), company.get("threads", 1), **spacing))
        tree.next_frame()
    return frames, [float((frame["answered_by"] == support.NOT_WORTH_IT).mean()) for frame in frames]


@pytest.mark.slow
def test_what_many_frames_cross_is_bought_in_the_end_for_any_threads_and_cache_size():
    rays = support.rays_towards(np.zeros(3), 0.6, 800)
    shape, settings = shapes.nurbs_torus(), {"rays_per_cell": 6.0, "depth_limit": 24, "mixed_depth_limit": 24}
    kept = fast_tree(shape, "GLASS", **settings)
    expected, shares = spaced_frames(kept, rays, 8)
    assert shares[0] > shares[-1] + 0.05 and (np.diff(shares) <= 0).all(), shares
    truth = kept.trace(*rays)
    used = expected[-1]["answered_by"] == INTERPOLATED
    assert used.sum() > (expected[0]["answered_by"] == INTERPOLATED).sum()
    # The thresholds also hold for cells that are sampled in later frames: 1 degree at centres, where they are tested.
    late = used & (expected[0]["answered_by"] != INTERPOLATED) & truth["hit"]
    error = support.angles(expected[-1]["exit_direction"], truth["exit_direction"])[late]
    assert late.any() and np.median(error) < np.radians(1.0), (late.sum(), np.median(error))
    random = np.random.default_rng(5)
    for cache_bytes, size, threads in ((10**8, 7, 4), (200_000, 33, 3), (0, 100, 2)):
        tree = fast_tree(shape, "GLASS", cache_bytes=cache_bytes, **settings)
        got, _ = spaced_frames(tree, rays, 4, random=random, size=size, threads=threads)
        for frame, wanted in zip(got, expected):
            support.check_same_answers(wanted, frame)


def test_a_tree_of_which_no_frame_ends_buys_nothing_more():
    rays = support.rays_towards(np.zeros(3), 0.6, 300)
    spacing = {"distances": np.full(300, 0.02, np.float32), "angles": np.full(300, 0.005, np.float32)}
    tree = fast_tree(shapes.nurbs_torus(), "GLASS")
    first = tree.ask(*rays, **spacing)
    for _ in range(20):
        support.check_same_answers(first, tree.ask(*rays, **spacing))


def test_rays_from_inside_the_box_are_not_told_what_lies_behind_them():
    random = np.random.default_rng(9)
    origins = random.uniform([-1, -1, -0.25], [1, 1, 0.25], (3000, 3))
    ring = np.hypot(origins[:, 0], origins[:, 1]) - 0.75
    origins = origins[np.hypot(ring, origins[:, 2]) > 0.3]
    directions = shapes.random_directions(random, len(origins))
    for kind in ("SIMPLE", "VOLUME"):
        tree = fast_tree(shapes.nurbs_torus(), kind, depth_limit=20)
        got, truth = tree.ask(origins, directions), tree.trace(origins, directions)
        by = got["answered_by"]
        assert (by == ORIGIN).any() and (by == CELL_MISSED).any(), support.counts(got)
        assert (got["hit"] != truth["hit"]).mean() < 0.005, support.counts(got)


def test_rays_that_are_none_and_rays_that_miss_the_box():
    nan, inf = np.nan, np.inf
    bad = [((0, 0, 3), (0, 0, 0)), ((nan, 0, 0), (0, 0, 1)), ((0, 0, 3), (0, nan, -1)), ((inf, 0, 0), (-1, 0, 0))]
    bad.append(((0, 0, 3), (0, 0, -inf)))
    origins, directions = (np.array(part, float) for part in zip(*bad))
    tree = fast_tree(shapes.nurbs_sphere(), "MIRROR")
    got = tree.ask(origins, directions)
    assert (got["answered_by"] == NOT_A_RAY).all() and not got["hit"].any()
    got = tree.ask(np.array([[0.0, 0, 5], [5.0, 5, 5]]), np.array([[0.0, 0, 1], [0.0, 0, -1]]))
    assert (got["answered_by"] == BOX_MISSED).all()
    assert tree.statistics()["nodes"] == 0


def test_one_number_sets_the_thresholds_and_bounds_the_error():
    rays = support.rays_towards(np.zeros(3), 0.8, 1500)
    errors, samples = [], []
    for error in (0.02, 0.005, 0.001):
        tree = fast_tree(shapes.nurbs_sphere(), "MIRROR", **support.ri_tree.quality_settings(error))
        got, truth = tree.ask(*rays), tree.trace(*rays)
        used = (got["answered_by"] == INTERPOLATED) & truth["hit"]
        assert used.mean() > 0.5, support.counts(got)
        # A colour that changes as much as the direction.
        errors.append(support.angles(got["exit_direction"], truth["exit_direction"])[used].mean())
        assert errors[-1] < error, (error, errors)
        samples.append(tree.statistics()["samples_taken"])
    assert errors == sorted(errors, reverse=True) and samples == sorted(samples), (errors, samples)
    for error in (0.0, -1.0, np.nan, np.inf):
        with pytest.raises(_core.InputError, match="error"):
            support.ri_tree.quality_settings(error)


@pytest.mark.slow
def test_of_a_view_that_moves_a_small_cache_forgets_what_is_not_asked_for_again():
    def taken(cache_bytes):
        tree = fast_tree(shapes.nurbs_torus(), "GLASS", ior=1.2, depth_limit=24, cache_bytes=cache_bytes)
        for angle in np.arange(40) * 0.05:
            eye = (4 * np.sin(angle), -4 * np.cos(angle), 2.0)
            tree.ask(*support.rays_towards(np.zeros(3), 1.2, 1500, eye=eye))
        return tree.statistics()

    all_held, few_held = taken(10**9), taken(16 * 10**6)
    assert all_held["samples"] == all_held["samples_taken"]
    assert few_held["samples"] < 0.1 * all_held["samples"]
    # If random samples were replaced, twice as many would be traced.
    assert few_held["samples_taken"] < 1.1 * all_held["samples_taken"]
