"""Phase functions: they sum to one, are sampled as they say, and are those of the literature where that knows numbers."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from shading_support import UP, closures, program_with

# Names, and the numbers each takes.
FUNCTIONS = {
    "Henyey-Greenstein": ("HENYEY_GREENSTEIN", (0.4,)),
    "Henyey-Greenstein, backwards": ("", (-0.8,)),
    "Rayleigh": ("RAYLEIGH", (0.0,)),
    "Draine": ("DRAINE", (0.3, 0.7)),
    "Draine, nearly even": ("DRAINE", (5e-5, 0.5)),
    "Draine, above what is nearly even": ("DRAINE", (2e-4, 0.5)),
    "Draine, narrow": ("DRAINE", (-0.97, 30.0)),
    "water": ("FOURNIER_FORAND", (1.33, 0.1)),
    "clear water": ("FOURNIER_FORAND", (1.1, 0.02)),
    "half backwards": ("FOURNIER_FORAND", (1.5, 0.45)),
    "a pole of the exponent": ("FOURNIER_FORAND", (1 + np.sqrt(2 / 3), 0.2)),
    "a pole of the tail": ("FOURNIER_FORAND", (1 + np.sqrt(4 / 3), 0.2)),
    **{f"Mie, {d} micrometres": ("MIE", (d,)) for d in (0.05, 0.5, 2.0, 8.0, 20.0, 200.0)},
}
SCATTERING = (0.5, 1.0, 0.25)


def medium(text, numbers):
    return closures(program_with("volume_scatter", [1.0, SCATTERING, 1.0, *numbers], text), UP)


def turned(cosines):
    """Directions of light that arrives so turned at who looks along -z."""
    cosines = np.asarray(cosines, np.float64)
    return np.stack([np.sqrt(1 - cosines**2), 0 * cosines, -cosines], -1).astype(np.float32)


def densities(text, numbers, cosines):
    """Per solid angle, of the last colour channel."""
    return medium(text, numbers).evaluate_medium(UP, turned(cosines))[:, 2].astype(np.float64) / SCATTERING[2]


# Angles, by their logarithm: Fournier and Forand's peak is a pole. Single precision ends where a cosine is 1.
ANGLES = np.concatenate([np.geomspace(1e-3, 0.3, 40_000)[:-1], np.linspace(0.3, np.pi, 40_000)])


def shares(text, numbers):
    """Of all light, what is turned by less than each of ANGLES from the first on."""
    per_angle = 2 * np.pi * np.sin(ANGLES) * densities(text, numbers, np.cos(ANGLES))
    steps = 0.5 * (per_angle[1:] + per_angle[:-1]) * np.diff(ANGLES)
    return np.concatenate([[0.0], np.cumsum(steps)])


@pytest.mark.parametrize("name", FUNCTIONS)
def test_all_light_goes_somewhere_and_is_sampled_as_it_goes(name):
    text, numbers = FUNCTIONS[name]
    random = np.random.default_rng(1).uniform(size=(40_000, 3)).astype(np.float32)
    random[:, 0] = (np.arange(len(random)) + 0.5) / len(random)
    sampled = medium(text, numbers).sample_medium(UP, random)
    angles = np.arccos(np.clip(-sampled["direction"][:, 2].astype(np.float64), -1, 1))
    cumulated = shares(text, numbers)
    forwards = np.mean(angles < ANGLES[0])  # within the first angle: the rest is what the density says
    assert forwards + cumulated[-1] == pytest.approx(1, abs=2e-3)
    for level in (0.01, 0.1, 0.4, 1.0, 2.0, 3.0):
        expected = forwards + np.interp(level, ANGLES, cumulated)
        assert np.mean(angles < level) == pytest.approx(expected, abs=6e-3), level
    valid = sampled["density"] > 0
    assert valid.mean() > 0.999
    np.testing.assert_allclose(sampled["weight"][valid], np.broadcast_to(SCATTERING, (valid.sum(), 3)), rtol=1e-4)
    np.testing.assert_allclose(np.linalg.norm(sampled["direction"], axis=1), 1, atol=1e-5)


def test_samples_follow_the_random_number_without_a_jump():
    random = np.full((2000, 3), 0.5, np.float32)
    random[:, 0] = np.linspace(0, 1, 2000, endpoint=False)
    for text, numbers in FUNCTIONS.values():
        if text != "MIE":  # a mixture
            steps = np.diff(medium(text, numbers).sample_medium(UP, random)["direction"][:, 2])
            assert np.all(steps <= 1e-5) or np.all(steps >= -1e-5), (text, numbers)


def test_rayleigh_is_three_quarters_of_one_and_the_squared_cosine():
    cosines = np.linspace(-1, 1, 21)
    np.testing.assert_allclose(densities("RAYLEIGH", (0.9,), cosines) * 4 * np.pi, 0.75 * (1 + cosines**2), rtol=1e-5)


def test_draine_is_henyey_and_greenstein_without_alpha():
    cosines = np.linspace(-1, 1, 21)
    np.testing.assert_array_equal(
        densities("DRAINE", (0.6, 0.0), cosines), densities("HENYEY_GREENSTEIN", (0.6,), cosines)
    )


@pytest.mark.parametrize(("g", "alpha"), [(0.3, 0.7), (-0.5, 2.0), (0.8, 1.0)])
def test_draines_mean_cosine(g, alpha):
    """Draine's equation 5."""
    angles = np.linspace(0, np.pi, 20_001)
    weights = np.sin(angles) * densities("DRAINE", (g, alpha), np.cos(angles))
    mean = (weights * np.cos(angles)).sum() / weights.sum()
    expected = g * (1 + alpha * (3 + 2 * g * g) / 5) / (1 + alpha * (1 + 2 * g * g) / 3)
    assert mean == pytest.approx(expected, abs=1e-4)


@pytest.mark.parametrize(("ior", "backscatter"), [(1.33, 0.1), (1.05, 0.02), (1.9, 0.3), (3.0, 0.45)])
def test_fournier_and_forands_backscatter_is_what_is_asked_for(ior, backscatter):
    angles = np.linspace(np.pi / 2, np.pi, 20_001)
    back = (np.sin(angles) * densities("FOURNIER_FORAND", (ior, backscatter), np.cos(angles))).sum()
    assert 2 * np.pi * back * (angles[1] - angles[0]) == pytest.approx(backscatter, rel=2e-3)


def test_large_droplets_scatter_forwards_and_small_particles_to_both_sides():
    for diameter, least, most in ((0.01, -0.05, 0.05), (5.0, 0.7, 0.9), (20.0, 0.8, 0.95)):
        weights = np.sin(ANGLES) * densities("MIE", (diameter,), np.cos(ANGLES)) * np.gradient(ANGLES)
        assert least < (weights * np.cos(ANGLES)).sum() / weights.sum() < most, diameter


extreme = st.one_of(
    st.sampled_from([0.0, 1.0, -1.0, 0.5, 1e-30, 1 + 1e-6, 1 - 1e-6, 1e6, -1e6, 3e38]),
    st.floats(-3, 3, width=32),
)


@given(
    st.sampled_from(["HENYEY_GREENSTEIN", "DRAINE", "RAYLEIGH", "FOURNIER_FORAND", "MIE"]),
    *(extreme, extreme),
    st.floats(-1, 1, width=32),
    st.tuples(*[st.floats(0, 1, width=32, exclude_max=True)] * 3),
)
def test_phase_functions_of_any_numbers_are_finite_and_not_negative(text, first, second, cosine, random):
    found = medium(text, (first, second))
    for each in (1.0, -1.0, cosine):
        value = found.evaluate_medium(UP, turned([each]))
        assert np.all(np.isfinite(value)) and np.all(value >= 0)
    sampled = found.sample_medium(UP, np.float32([random]))
    assert all(np.all(np.isfinite(values)) for values in sampled.values())
