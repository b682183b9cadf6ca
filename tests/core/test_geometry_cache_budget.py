"""The budget of the geometry cache changes time and memory, never an answer."""

import numpy as np
import pytest
from core import shapes

trace = shapes.trace
BUDGETS = [-1.0, 0.0, 1e-6, 0.02, 0.1, 1.0, 30.0]


def rays(count):
    random = np.random.default_rng(1)
    angle = random.uniform(0, 2 * np.pi, count)
    origins = 0.7 * np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    width = (10 ** random.uniform(-4, 0, count)).astype(np.float32)
    return origins, shapes.random_directions(random, count), width


def tracer_of(**settings):
    matrices = [shapes.moved(0.0), shapes.moved(0.3)]
    instances = [(shape, matrix, shapes.EVERYTHING) for shape, matrix in zip((TORUS, SPHERE), matrices)]
    return trace.Tracer(instances, cache=trace.GeometryCacheSettings(**settings))


TORUS, SPHERE = shapes.lumpy_torus(), shapes.nurbs_sphere()


def cache_statistics(tracer):
    return tracer.statistics()["geometry_cache"]


def test_every_budget_gives_the_same_hits_bit_by_bit():
    origins, directions, width = rays(50_000)
    answers = [
        tracer_of(megabytes=megabytes).closest_hits(origins, directions, width=width, spread=width)
        for megabytes in BUDGETS
    ]
    for answer in answers[:-1]:
        for key, values in answers[-1].items():
            np.testing.assert_array_equal(answer[key], values, err_msg=key)


def test_without_a_cache_rays_see_the_same():
    origins, directions, width = rays(20_000)
    kept = tracer_of().closest_hits(origins, directions, width=width)
    tracer = tracer_of(mode="NONE")
    np.testing.assert_array_equal(kept["t"], tracer.closest_hits(origins, directions, width=width)["t"])
    statistics = cache_statistics(tracer)
    assert all(
        statistics["levels"][name]["diced"] == statistics["levels"][name]["lookups"] for name in ("medium", "fine")
    )


def test_a_single_resolution_is_fine_for_every_ray():
    origins, directions, width = rays(20_000)
    narrow = tracer_of().closest_hits(origins, directions)
    tracer = tracer_of(mode="SINGLE")
    np.testing.assert_array_equal(narrow["t"], tracer.closest_hits(origins, directions, width=width)["t"])
    levels = cache_statistics(tracer)["levels"]
    assert levels["coarse"]["lookups"] == levels["medium"]["lookups"] == 0 < levels["fine"]["lookups"]


@pytest.mark.parametrize("megabytes", [0.5, 1.0, 30.0])
def test_all_memory_counts_within_the_budget(megabytes):
    origins, directions, width = rays(100_000)
    tracer = tracer_of(megabytes=megabytes)
    tracer.closest_hits(origins, directions, width=width)
    statistics = cache_statistics(tracer)
    assert statistics["budget"] == int(megabytes * 2**20)
    assert 0.05 * 2**20 < statistics["bytes"] <= statistics["budget"]


def test_what_fits_is_kept_and_never_diced_again():
    origins, directions, width = rays(50_000)
    width = np.maximum(width, 1e-2)  # no subpatch is split
    tracer = tracer_of(megabytes=100.0)
    # A thread that gets no slot at once, because another one has the lock, dices into its own memory: the grid is kept
    # when it is missed again. How often that happens depends on the machine's load, but each round leaves fewer.
    rounds = []
    while len(rounds) < 2 or rounds[-1]["vertices_diced"] != rounds[-2]["vertices_diced"]:
        assert len(rounds) < 10, [each["vertices_diced"] for each in rounds]
        tracer.closest_hits(origins, directions, width=width)
        rounds.append(cache_statistics(tracer))
    for name, level in rounds[-1]["levels"].items():
        assert level["lookups"] == len(rounds) * rounds[0]["levels"][name]["lookups"]
        assert level["cold"] <= level["diced"]


def test_what_does_not_fit_is_diced_again_and_counted():
    origins, directions, _ = rays(20_000)
    tracer = tracer_of(megabytes=0.5, mode="SINGLE")
    tracer.closest_hits(origins, directions)
    fine = cache_statistics(tracer)["levels"]["fine"]
    assert fine["cold"] < fine["diced"] < fine["lookups"]
    assert cache_statistics(tracer)["vertices_recomputed"] == 289 * (fine["diced"] - fine["cold"])


@pytest.mark.parametrize("megabytes", [0.3, 1.0])
def test_a_thrashing_cache_gives_the_same_hits(megabytes):
    origins, directions, _ = rays(100_000)
    kept = tracer_of(megabytes=30.0).closest_hits(origins, directions)["t"]
    tracer = tracer_of(megabytes=megabytes)
    for _ in range(3):
        np.testing.assert_array_equal(kept, tracer.closest_hits(origins, directions)["t"])


def fine_torus(around):
    """A surface of many small bicubic patches, a few of them across the coordinate planes."""
    u, v = np.meshgrid(*2 * [2 * np.pi * np.arange(around) / around])
    ring = 0.7 + 0.25 * np.cos(u)
    points = np.stack([ring * np.cos(v), ring * np.sin(v), 0.25 * np.sin(u), np.ones_like(u)], axis=2)
    closed = (4, True, False, False)
    return trace.PatchSurface("fine", [(points, closed, closed, True, 0)])


@pytest.mark.parametrize("around", [250, 60])
def test_grids_that_are_kept_are_those_that_were_diced_bit_by_bit(around):
    surface = fine_torus(around)
    origins, directions, _ = rays(40_000)
    origins[:, 2] = 0.3
    width = np.full(len(origins), 2.0 / around, np.float32)  # between a quarter of a patch and all of it

    def tracer(mode):
        settings = trace.GeometryCacheSettings(mode=mode, distance=1e-9)
        return trace.Tracer([(surface, np.eye(4), shapes.EVERYTHING)], cache=settings)

    kept, diced = tracer("MULTI"), tracer("NONE").closest_hits(origins, directions, width=width)
    for _ in range(2):
        again = kept.closest_hits(origins, directions, width=width)
        for key, values in diced.items():
            np.testing.assert_array_equal(again[key], values, err_msg=key)
    medium = cache_statistics(kept)["levels"]["medium"]
    assert medium["cold"] > 1000 and medium["lookups"] > 2 * medium["diced"]


def test_an_unknown_mode_is_named():
    with pytest.raises(Exception, match="mode.*'BOTH'.*one of MULTI, SINGLE, NONE"):
        trace.GeometryCacheSettings(mode="BOTH")
