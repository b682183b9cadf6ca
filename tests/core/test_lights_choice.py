"""Which of many lights is chosen: by the cosine at the point, and by the side that shines."""

import numpy as np
import pytest
from test_lights_sampling import (
    LAMPS,
    NORMAL,
    POSITION,
    SHAPES,
    emitter_scene,
    irradiance,
    probe_of,
    random_numbers,
    tilted,
)


@pytest.mark.parametrize("normal", [[0, 0, 1.0], [1.0, 0, 0.2], [0, 0, -1.0]])
def test_a_normal_changes_which_light_is_chosen_but_not_how_much_arrives(core, normal):
    normal = np.array(normal) / np.linalg.norm(normal)
    lamps = [LAMPS[name] for name in ("sphere", "wide sun", "rectangle", "disk")]
    frames = [tilted((x, 0.4, z), a) for x, z, a in ((-2.5, 1.2, 0), (0, 1, 0.3), (0.6, 1.2, 0.3), (2.0, -3, 3.0))]
    probe = probe_of(core, *[{**lamp, "matrix": frame} for lamp, frame in zip(lamps, frames, strict=True)])
    random = random_numbers(100000)
    plain, plain_error = irradiance(probe.sample(POSITION, random), normal)
    samples = probe.sample(POSITION, random, normal=normal)
    value, error = irradiance(samples, normal)
    assert abs(value - plain) < 5 * np.hypot(error, plain_error)
    assert error < 1.1 * plain_error
    # Lights that are behind the surface are still chosen.
    behind = (samples["density"] > 0) & (samples["direction"] @ normal < 0)
    assert 0 < behind.mean() < ((samples["direction"] @ normal > 0) & (samples["density"] > 0)).mean()


def test_with_a_normal_few_samples_go_to_a_lamp_behind_the_surface(core):
    frames = [tilted((0.3, 0.2, z - 0.4), angle) for z, angle in ((2.0, 0.0), (-2.0, np.pi))]
    probe = probe_of(core, *[{**LAMPS["rectangle"], "matrix": frame} for frame in frames])
    random = random_numbers(20000)
    (_, error), (_, plain_error) = (
        irradiance(probe.sample(POSITION, random, normal=normal), NORMAL) for normal in (NORMAL, None)
    )
    assert error < 0.5 * plain_error


def test_with_a_normal_the_density_is_the_one_that_scattered_rays_are_told(core):
    lamps = [{**LAMPS["rectangle"], "matrix": tilted((x, 0.4, 1.2))} for x in (-2.5, 0.6, 3.0)]
    probe = probe_of(core, *lamps)
    normal = np.array([0.6, 0, 0.8])
    samples = probe.sample(POSITION, random_numbers(2000), normal=normal)
    _, density = probe.look(POSITION, samples["direction"].astype(np.float64), normal=normal)
    np.testing.assert_allclose(density, samples["density"], rtol=1e-3)


@pytest.mark.parametrize(
    "position, near_side", [([0.3, 0.2, -2.0], True), ([0.1, 0.0, 1.6], False)], ids=["outside", "within"]
)
def test_of_a_ball_of_light_the_side_that_is_seen_is_chosen_nearly_always(core, position, near_side):
    probe = core.LightProbe(emitter_scene(core, SHAPES["a spline sphere"](core)))
    position = np.array(position)
    samples = probe.sample(position, random_numbers(20000))
    used = samples["density"] > 0
    at = position + samples["direction"][used] * samples["distance"][used, None]
    faces = ((at - [0, 0, 1.5]) * -samples["direction"][used]).sum(1) > 0
    if near_side:
        assert faces.mean() > 0.7, "patches cross the ball's horizon, so that some of its far side is chosen"
    else:
        assert not faces.any() and used.mean() > 0.99
