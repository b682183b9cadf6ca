"""How light enters a body that it scatters in: all ways alike, refracted by its facets, or by chance the one or the other."""

import numpy as np
import pytest
from shading_support import UP, WHITE, closures, direction, program_with, stratified

FIXED, PHYSICAL, MEAN_FREE_PATH = 0, 1, 2
OUTGOING = direction(0.6)


def ways_in(method, refracted, ior=1.5, roughness=1.0, side=64):
    """Sampled directions, all of them into the body."""
    operands = [1.0, WHITE, 0.5, (1.0, 0.4, 0.2), ior, 0.0, None, roughness]
    lobes = closures(program_with("subsurface", operands, ints=[method, int(refracted)]), OUTGOING)
    sample = lobes.sample(OUTGOING, UP, stratified(side))
    assert sample["valid"].all()
    np.testing.assert_allclose(np.linalg.norm(sample["direction"], axis=1), 1, atol=1e-5)
    assert (sample["direction"][:, 2] < 0).all()
    return sample["direction"]


def refracted(ior):
    """The way of light that a smooth surface bends (Snell)."""
    across = OUTGOING[:2] / ior
    return np.array([*-across, -np.sqrt(1 - across @ across)])


@pytest.mark.parametrize("method", (FIXED, PHYSICAL, MEAN_FREE_PATH))
def test_light_enters_all_ways_alike_up_to_blender_3(method):
    ways = ways_in(method, False, roughness=0.0)
    assert ways[:, 2].mean() == pytest.approx(-2 / 3, abs=0.01)
    np.testing.assert_allclose(ways[:, :2].mean(axis=0), 0, atol=0.01)


@pytest.mark.parametrize("method", (FIXED, MEAN_FREE_PATH))
@pytest.mark.parametrize("ior", (1.0, 1.33, 2.5))
def test_a_smooth_surface_refracts_what_enters(method, ior):
    np.testing.assert_allclose(ways_in(method, True, ior, 0.0), np.tile(refracted(ior), (64 * 64, 1)), atol=2e-6)


def test_an_index_of_one_bends_nothing_however_rough():
    np.testing.assert_allclose(ways_in(FIXED, True, 1.0, 1.0), np.tile(-OUTGOING, (64 * 64, 1)), atol=1e-5)
    below_one = ways_in(FIXED, True, 0.7, 0.5)
    np.testing.assert_allclose(below_one, np.tile(-OUTGOING, (64 * 64, 1)), atol=1e-5)


def test_rough_surfaces_spread_what_they_refract():
    spread = [np.linalg.norm(np.std(ways_in(FIXED, True, 1.5, each), axis=0)) for each in (0.2, 0.5, 1.0)]
    assert 0.005 < spread[0] < 0.5 * spread[1] < 0.5 * spread[2]


def test_half_of_what_enters_by_the_physical_method_is_refracted_by_the_roughest_surface():
    ways = [ways_in(method, True, 1.001, roughness) for method, roughness in ((PHYSICAL, 0.0), (PHYSICAL, 1.0))]
    np.testing.assert_array_equal(*ways)
    straight = np.linalg.norm(ways[0] + OUTGOING, axis=1) < 0.01
    assert straight.mean() == pytest.approx(0.5, abs=0.03)
    assert ways[0][~straight][:, 2].mean() == pytest.approx(-2 / 3, abs=0.02)


def test_light_enters_straight_below_layers_that_reflect_nothing():
    operands = [1.0, (0.8, 0.8, 0.8), 0.0, 0.0, WHITE, 0.0, 0.0, 0.0, 0.0, 0.5, WHITE, 0.0, 0.03, 1.5, WHITE]
    operands += [(0.0, 0.0, 0.0), 0.0, 1.0, 1.5, 0.0, None, None, None, 0.0, 1.0, (1.0, 0.4, 0.2), 1.4, 0.0]
    lobes = closures(program_with("principled_layers", operands, "MULTI_GGX", ints=[FIXED]), OUTGOING)
    ways = lobes.sample(OUTGOING, UP, stratified(8))["direction"]
    np.testing.assert_allclose(ways, np.tile(-OUTGOING, (64, 1)), atol=2e-6)
