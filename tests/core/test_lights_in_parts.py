"""Sixteen stratified numbers choose every light equally often, but for lights that are chosen seldom."""

import numpy as np
import pytest
from light_support import NORMAL, random_numbers
from scenes import look_down
from test_lights_sampling import LAMPS, POWER, probe_of, striped_world, tilted

PARTS = 16
CASES = {
    "two lamps": [("point", (-1, 0.3, 2.0), 1.0), ("point", (1.5, 0, 3.0), 1.0)],
    "three lamps": [("point", (-1, 0.3, 2.0), 1.0), ("sphere", (1.5, 0, 3.0), 0.7), ("rectangle", (0, 3, 4.0), 2.0)],
    "a lamp, two suns": [("point", (-1, 0.3, 2.0), 1.0), ("sun", (0, 0, 1.0), 0.02), ("wide sun", (0, 0, 1.0), 0.05)],
    "four lamps, a sun": [("point", (x, 0.3, 4.0), 1.0) for x in (-1.5, -0.5, 0.8, 1.6)] + [("sun", (0, 0, 1.0), 0.01)],
    "a sun, a sky": [("sun", (0, 0, 1.0), 0.01)],
    "a lamp, a sun, a sky": [("point", (-1, 0.3, 2.0), 1.0), ("sun", (0, 0, 1.0), 0.05)],
}


def probe_of_case(core, name):
    """Lamps that shine light of different colours."""
    scene = core.SceneDescription()
    look_down(scene)
    for i, (lamp, place, strength) in enumerate(CASES[name]):
        color = (POWER * strength * 2**i, POWER * strength, 0.0)
        scene.add_lamp(name=f"lamp {i}", **LAMPS[lamp], matrix=tilted(place), strength=color)
    if "sky" in name:
        scene.set_world(striped_world(core), 64)
    return core.LightProbe(scene)


def chosen(samples):
    """A number for each light by its colour; of the sky: -1."""
    red, green, blue = samples["radiance"].T
    return np.where(blue > 0, -1, np.rint(np.log2(np.maximum(red, 1e-20) / np.maximum(green, 1e-20)))).astype(int)


def evenly_spread(count):
    """A number in the middle of each of `count` parts, and the same for the place on the light."""
    x = (np.arange(count) + 0.5) / count
    return np.stack([x, np.full(count, 0.5)], 1).astype(np.float32)


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("position", [[0.3, 0.2, -0.4], [-2.0, 1.0, 0.1], [1.5, -1.0, -1.0]])
def test_the_share_of_each_light_is_in_whole_parts(core, name, position):
    probe, count = probe_of_case(core, name), PARTS * 100
    lights = chosen(probe.sample(np.array(position), evenly_spread(count), normal=NORMAL))
    expected = len(CASES[name]) + ("sky" in name)
    shares = np.unique(lights, return_counts=True)[1] / count * PARTS
    assert len(shares) == expected
    assert np.abs(shares - np.rint(shares)).max() < 0.011


@pytest.mark.parametrize("name", CASES)
def test_sixteen_stratified_numbers_choose_each_light_equally_often(core, name):
    probe = probe_of_case(core, name)
    numbers = random_numbers(PARTS * 200).reshape(-1, PARTS, 2)
    numbers[..., 0] = ((np.arange(PARTS) + numbers[..., 0]) / PARTS).clip(0, np.float32(1 - 2**-24))
    lights = chosen(probe.sample(np.array([0.3, 0.2, -0.4]), numbers.reshape(-1, 2), normal=NORMAL)).reshape(-1, PARTS)
    counts = np.array([(lights == each).sum(1) for each in np.unique(lights)])
    assert (counts.min(1) == counts.max(1)).all(), counts[:, :5]


def test_a_light_that_deserves_less_than_half_a_part_is_chosen_as_often_as_it_deserves(core):
    """Its share is exact, and the strongest has what is left."""
    places = {(-1.0, 0.0, 2.0): 1.0, (1.0, 0.0, 2.0): 1.0, (0.0, 40.0, 2.0): 1.0}
    lamps = [{**LAMPS["point"], "matrix": tilted(p), "strength": (POWER * s,) * 3} for p, s in places.items()]
    samples = probe_of(core, *lamps).sample(np.zeros(3), evenly_spread(200000), normal=np.array([0, 0, 1.0]))
    far = samples["direction"][:, 1] > 0.5
    assert 0 < far.mean() < 0.5 / PARTS
    np.testing.assert_allclose(samples["density"][far], far.mean(), rtol=0.01)


def test_of_many_lights_all_are_chosen(core):
    """Of forty, none deserves a part."""
    places = [(np.cos(a), np.sin(a), 2.0) for a in np.arange(40) * 2 * np.pi / 40]
    samples = probe_of(core, *[{**LAMPS["point"], "matrix": tilted(p)} for p in places]).sample(
        np.zeros(3), evenly_spread(20000), normal=np.array([0, 0, 1.0])
    )
    _, counts = np.unique(np.rint(samples["direction"] * 1000), axis=0, return_counts=True)
    assert len(counts) == 40
    assert counts.max() < 2 * counts.min()
