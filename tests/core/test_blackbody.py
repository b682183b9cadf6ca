"""The colour of a black body by its temperature."""

import numpy as np
from test_thin_film import SENSITIVITY, WAVELENGTH

from rayleaf import _core

# Of luminance: the approximation of the observer's sensitivities is as good as this.
CLOSE = 0.03
# Linear Rec. 709 of a spectrum that is the same at all wavelengths; the sensitivities each sum to 1.
EVEN_SPECTRUM = (1.2048, 0.9484, 0.9088)


def colors(kelvins):
    program = _core.Program("Blackbody")
    result = program.operation("blackbody", [program.operation("component", [program.operation("position")], ints=[0])])
    places = np.zeros((len(kelvins), 3), np.float32)
    places[:, 0] = kelvins
    up = np.tile(np.float32([0, 0, 1]), (len(kelvins), 1))
    return _core.shading.surface_points(places, up, up).values(program, result)[:, :3].astype(float)


def test_it_is_plancks_law_seen_by_the_observer():
    # Below, most light comes by the last red, where the approximation is poor.
    kelvins = np.array([2000, 2500, 3000, 4500, 6504, 9000, 12000.0])
    meters = WAVELENGTH * 1e-9
    for found, temperature in zip(colors(kelvins), kelvins, strict=True):
        radiance = meters**-5 / np.expm1(1.438776877e-2 / (meters * temperature))
        rgb = (SENSITIVITY * radiance[:, None]).sum(axis=0) * EVEN_SPECTRUM
        expected = np.maximum(rgb, 0) / (rgb @ [0.2126729, 0.7151522, 0.0721750])
        np.testing.assert_allclose(found, expected, atol=CLOSE * expected.max())


def test_it_changes_smoothly_and_stays_beyond_the_limits():
    found = colors(np.linspace(800, 12000, 50_001))
    steps = np.abs(np.diff(found, axis=0))
    assert steps.max() < 2e-3  # where red changes fastest, at 800 kelvins
    assert np.abs(np.diff(found[:, 0])).max() > 0 and (np.diff(found[:, 0]) <= 1e-6).all()  # less and less red
    np.testing.assert_array_equal(colors([0.0, -5.0, 799.0]), colors([800.0] * 3))
    np.testing.assert_array_equal(colors([1e9, np.inf]), colors([12000.0] * 2))


def test_lines_of_the_table_are_no_visible_error():
    # Between three neighbours at equal steps of the reciprocal temperature, the middle is the mean of the others.
    reciprocal = np.linspace(1 / 12000, 1 / 800, 20_001)
    found = colors(1 / reciprocal)
    bent = np.abs(found[:-2] - 2 * found[1:-1] + found[2:])
    assert bent.max() < 1e-4
