"""Nishita's sky: the table against rays that are followed one by one, in vectors."""

import numpy as np
import pytest
from rayleaf.export import atmosphere
from rayleaf.export.atmosphere import Air, sky_table

EARTH, TOP = 6360e3, 6420e3


def densities(point):
    height = np.linalg.norm(point) - EARTH
    return np.array(
        [np.exp(-height / 8000.0), np.exp(-height / 1200.0), max(1.0 - abs(height - 25000.0) / 15000.0, 0.0)]
    )


def way_out(point, direction):
    along = point @ direction
    return -along + np.sqrt(along**2 - point @ point + TOP**2)


def color(direction, sun, air):
    point, scale = np.array([0.0, 0.0, EARTH + air.altitude]), np.array([air.air, air.dust, air.ozone])
    step, cosine = way_out(point, direction) / 32, direction @ sun
    of_air = 3.0 / (16.0 * np.pi) * (1.0 + cosine**2)
    of_dust = 3.0 / (8.0 * np.pi) * (1.0 - 0.76**2) * (1.0 + cosine**2) / (2.0 + 0.76**2)
    of_dust /= (1.0 + 0.76**2 - 2.0 * 0.76 * cosine) ** 1.5
    passed_by, total = np.zeros(3), np.zeros(21)
    extinction = np.array([atmosphere._AIR, np.full(21, 1.11 * 2e-5), atmosphere._OZONE])
    for i in range(32):
        place = point + direction * ((i + 0.5) * step)
        density, length = scale * densities(place), way_out(place, sun)
        passed_by = passed_by + density * step
        if sun[2] < 0 and (place @ sun) ** 2 >= place @ place - EARTH**2:
            continue
        shares = zip(atmosphere._PLACES, atmosphere._WEIGHTS, strict=True)
        beyond = sum(weight * densities(place + sun * (share * length)) for share, weight in shares) * length
        brought = of_air * density[0] * atmosphere._AIR + of_dust * density[1] * 2e-5
        total += np.exp(-(passed_by + scale * beyond) @ extinction) * brought * atmosphere._IRRADIANCE * step
    return np.maximum(atmosphere.FROM_XYZ @ (total @ atmosphere._OBSERVER * 20.0), 0.0)


@pytest.mark.parametrize("elevation, altitude", [(0.3, 0.0), (1.4, 5000.0), (-0.03, 100.0)])
def test_the_table_holds_what_rays_bring_one_by_one(elevation, altitude):
    air = Air(elevation, altitude, 1.0, 2.0, 0.5)
    table = sky_table(air, 16, 8)
    sun = np.array([np.cos(elevation), 0.0, np.sin(elevation)])
    for row in (0, 3, 7):
        latitude = (0.5 * np.pi + 0.25 * np.pi / 8) * (row / 8) ** 2
        for column in (0, 5, 7):
            longitude = 2.0 * np.pi / 16 * column - np.pi
            level = np.cos(latitude)
            direction = np.array([level * np.cos(longitude), level * np.sin(longitude), np.sin(latitude)])
            wanted = color(direction, sun, air)
            np.testing.assert_allclose(table[row, column], wanted, rtol=2e-5, atol=2e-6 * wanted.max())
            np.testing.assert_array_equal(table[row, 15 - column], table[row, column])


def test_a_sky_is_computed_once_and_cannot_be_changed():
    air = Air(0.5, 0.0, 1.0, 1.0, 1.0)
    assert sky_table(air, 16, 8) is sky_table(Air(0.5, 0.0, 1.0, 1.0, 1.0), 16, 8)
    with pytest.raises(ValueError, match="read-only"):
        sky_table(air, 16, 8)[0] = 0
