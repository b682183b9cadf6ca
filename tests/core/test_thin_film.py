"""Interference in thin films, against Airy's formula for single wavelengths, summed over a spectrum as it is seen."""

import numpy as np
import pytest
from rayleaf import _core
from shading_support import closures, direction, program_with

COSINES = (1.0, 0.9, 0.6, 0.3, 0.1)
# The approximation of the observer's sensitivities below is as good as this, times how much reflectances vary.
OBSERVER = 0.03


def sensitivities():
    """Wavelengths, and how red, green and blue answer; each sums to 1. X, Y, Z by Wyman, Sloan, Shirley, "Simple Analytic
    Approximations to the CIE XYZ Color Matching Functions", JCGT 2(2), 2013."""
    wavelength = np.arange(380.0, 781.0, 2.0)

    def lobe(height, middle, left, right):
        return height * np.exp(-0.5 * ((wavelength - middle) * np.where(wavelength < middle, left, right)) ** 2)

    x = lobe(1.056, 599.8, 0.0264, 0.0323) + lobe(0.362, 442.0, 0.0624, 0.0374) - lobe(0.065, 501.1, 0.0490, 0.0382)
    y = lobe(0.821, 568.8, 0.0213, 0.0247) + lobe(0.286, 530.9, 0.0613, 0.0322)
    z = lobe(1.217, 437.0, 0.0845, 0.0278) + lobe(0.681, 459.0, 0.0385, 0.0725)
    to_rgb = [[3.2405, -1.5371, -0.4985], [-0.9693, 1.8760, 0.0416], [0.0556, -0.2040, 1.0572]]
    rgb = np.stack([x, y, z], axis=1) @ np.transpose(to_rgb)
    return wavelength, rgb / rgb.sum(axis=0)


WAVELENGTH, SENSITIVITY = sensitivities()


def amplitudes(start, end, sine):
    """Of light that goes from one index to another, both polarizations; `sine` in the vacuum. Cosines of both sides."""
    inside, beyond = (np.sqrt(1 - (sine / index) ** 2 + 0j) for index in (start, end))
    beyond = np.where((end * beyond).imag < 0, -beyond, beyond)
    perpendicular = (start * inside - end * beyond) / (start * inside + end * beyond)
    parallel = (end * inside - start * beyond) / (end * inside + start * beyond)
    return np.array([perpendicular, parallel]), inside


def exact(thickness, film, below, cosine):
    """Seen reflectance, by the sum of all reflections; and the most that those beyond the third term can bring."""
    sine = np.sqrt(1 - cosine * cosine)
    outer, _ = amplitudes(1.0, film, sine)
    inner, within = amplitudes(film, below, sine)
    turn = np.exp(4j * np.pi * film * within.real * thickness / WAVELENGTH)
    both = [(a + b * turn) / (1 + a * b * turn) for a, b in zip(outer, inner)]
    first, step = np.abs(outer) ** 2, np.abs(outer * inner)
    tail = 2 * (1 - first) * (1 + np.abs(inner) ** 2) * step**4 / (1 - step)
    return np.clip((np.abs(both) ** 2).mean(axis=0) @ SENSITIVITY, 0, 1), tail.mean()


def reflectance(identifier, cosine, film, operands, ints=()):
    """Of a mirror under a film."""
    text = "SHARP" if identifier == "glass" else "GGX"
    lobes = closures(program_with(identifier, [*operands, *film], text, ints), direction(cosine))
    return np.array(lobes.albedo(direction(cosine), _core.shading.LobeKind.GLOSSY))


@pytest.mark.parametrize("thickness", (60.0, 200.0, 350.0, 500.0, 800.0))
@pytest.mark.parametrize("film, below", ((1.33, 1.5), (1.8, 1.5), (1.33, 2.2), (2.2, 1.3)))
def test_a_film_on_glass_has_the_colour_that_airys_formula_gives_the_spectrum(thickness, film, below):
    for cosine in COSINES:
        found = reflectance("glass", cosine, (thickness, film), (1.0, (1.0, 1.0, 1.0), 0.0, below, None))
        expected, rest = exact(thickness, film, below, cosine)
        np.testing.assert_allclose(found, expected, atol=OBSERVER * max(expected) + rest, err_msg=f"cosine {cosine}")


@pytest.mark.parametrize("thickness", (60.0, 200.0, 350.0, 500.0, 800.0))
@pytest.mark.parametrize("film", (1.33, 2.2))
def test_a_film_on_a_conductor_has_it_too(thickness, film):
    index, extinction = 2.757, 3.867
    for cosine in COSINES:
        operands = (1.0, (index,) * 3, (extinction,) * 3, 0.0, None, 0.0, 0.0, None)
        found = reflectance("metal", cosine, (thickness, film), operands, [1])
        expected, rest = exact(thickness, film, index + 1j * extinction, cosine)
        np.testing.assert_allclose(found, expected, atol=OBSERVER + rest, err_msg=f"cosine {cosine}")


METAL = (1.0, (0.8, 0.5, 0.3), (0.4, 0.7, 0.9), 0.0, None, 0.0, 0.0, None)
CONDUCTOR = (1.0, (0.183, 0.421, 1.373), (3.425, 2.346, 1.770), 0.0, None, 0.0, 0.0, None)
GLASS = (1.0, (1.0, 1.0, 1.0), 0.0, 1.5, None)
ALL = {"glass": (GLASS, []), "metal": (METAL, [0]), "conductor": (CONDUCTOR, [1])}


@pytest.mark.parametrize("kind", ALL)
def test_a_film_that_fades_leaves_the_bare_surface(kind):
    operands, ints = ALL[kind]
    # The curve of a metal given by colours is not a conductor's, so that at grazing even a film of nothing changes it.
    for cosine in COSINES[: 3 if kind == "metal" else 5]:
        thin, bare = (
            reflectance("glass" if kind == "glass" else "metal", cosine, (thickness, 1.4), operands, ints)
            for thickness in (0.11, 0.0)
        )
        np.testing.assert_allclose(thin, bare, atol=0.02)


def test_a_thick_film_is_grey_and_reflects_what_its_two_sides_do_without_interference():
    found = reflectance("glass", 1.0, (1e5, 1.4), GLASS)
    first, second = (0.4 / 2.4) ** 2, (0.1 / 2.9) ** 2
    assert found == pytest.approx(first + (1 - first) ** 2 * second / (1 - first * second), abs=1e-6)


def test_glass_under_a_film_lets_through_what_the_film_does_not_reflect():
    kinds = _core.shading.LobeKind
    for cosine in (*COSINES, -0.3, -0.9):
        view = np.float32((np.sqrt(1 - cosine * cosine), 0, cosine))
        lobes = closures(program_with("glass", [*GLASS, 400.0, 1.33], "SHARP"), view)
        both = [np.array(lobes.albedo(view, kind)) for kind in (kinds.GLOSSY, kinds.TRANSMISSION)]
        np.testing.assert_allclose(sum(both), 1.0, atol=1e-6)
        assert both[0].std() > 0 or cosine == -0.3  # total reflection, white


def test_films_before_blender_5_are_seen_by_another_observer_and_leave_metal_bare():
    base = [1.0, (0.1, 0.1, 0.1), 0.0, 0.5, (1.0, 1.0, 1.0), 0.0, 0.0, 0.0, 0.0, 0.5, (1.0, 1.0, 1.0), 0.0, 0.03, 1.5]
    base += [(1.0, 1.0, 1.0), (0.0, 0.0, 0.0), 1.0, 1.0, 1.5, 0.0, None, None, None, 0.0, *[None] * 4]

    def seen(metallic, ints, thickness=400.0):
        operands = [*base[:2], metallic, *base[3:], thickness, 1.33]
        view = direction(0.8)
        return np.array(
            closures(program_with("principled_layers", operands, ints=ints), view).albedo(
                view, _core.shading.LobeKind.GLOSSY
            )
        )

    newer, older = seen(0.0, [0, 0]), seen(0.0, [0, 1])
    assert 0 < abs(newer - older).max() < 0.1 * newer.max()
    assert (seen(1.0, [0, 1]) == seen(1.0, [0, 1], 0.0)).all()
    assert abs(seen(1.0, [0, 0]) - seen(1.0, [0, 0], 0.0)).max() > 0.01
