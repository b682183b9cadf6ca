"""The sky of light that was scattered more than once, against sums over one ray, written as they are told."""

import math

import numpy as np
import pytest

from rayleaf.export import spectral_atmosphere as sky
from rayleaf.export.atmosphere import FROM_XYZ, Air

EARTH, TOP = 6371.0, 6471.0


def to_sphere(height, cosine, radius):
    """The first place in front where a ray meets a sphere around the middle of the earth, or None."""
    along, start = (EARTH + height) * cosine, EARTH + height
    root = along**2 - start**2 + radius**2
    places = [] if root < 0 else [-along - math.sqrt(root), -along + math.sqrt(root)]
    return next((place for place in places if place > 0), None)


def lost_at(height, air):
    """Per km: scattered by molecules and by aerosols, and all that is lost."""
    molecules = (
        np.array([6.605e-3, 1.067e-2, 1.842e-2, 3.156e-2]) * math.exp(-0.07771971 * height**1.16364243) * air.air
    )
    logarithm = math.log(max(height, 1e-4))
    density = 3.78547397e20 * math.exp(-((logarithm - 3.22261) ** 2) * 5.55555555 - logarithm)
    ozone = np.array([3.472e-25, 3.914e-25, 1.349e-25, 11.03e-27]) * 334.5 * density * air.ozone
    number = (1.3681e20 * math.exp(-height / 0.73) + 2e6) * air.dust
    scattered = np.array([1.5908e-22, 1.7711e-22, 2.0942e-22, 2.4033e-22]) * number
    absorbed = np.array([2.8722e-24, 4.6168e-24, 7.9706e-24, 1.3578e-23]) * number
    return molecules, scattered, molecules + ozone + scattered + absorbed


def passed(height, cosine, air, steps=64):
    """From the border of the atmosphere to a height."""
    step = to_sphere(height, cosine, TOP) / steps
    lost = np.zeros(4)
    for i in range(steps):
        far = (i + 0.5) * step
        at = math.sqrt((EARTH + height) ** 2 + far * (2 * (EARTH + height) * cosine + far)) - EARTH
        lost += lost_at(max(at, 0.0), air)[2] * step
    return np.exp(-lost)


def color(elevation, azimuth, air):
    """Of the sky; `azimuth` from the sun's."""
    height = air.altitude / 1000.0
    upward, level = math.sin(elevation), math.cos(elevation)
    to_sun = upward * math.sin(air.elevation) + level * math.cos(azimuth) * math.cos(air.elevation)
    by_molecules = 3 / (16 * math.pi) * (1 + to_sun**2)
    by_aerosols = (1 - 0.64) / (4 * math.pi * (1.64 - 1.6 * to_sun) ** 1.5)
    end = to_sphere(height, upward, EARTH) or to_sphere(height, upward, TOP)
    step, left, total = end / 64, np.ones(4), np.zeros(4)
    for i in range(64):
        far = (i + 0.5) * step
        radius = math.sqrt((EARTH + height) ** 2 + far * (2 * (EARTH + height) * upward + far))
        at = max(radius - EARTH, 0.0)
        cosine = ((EARTH + height) * math.sin(air.elevation) + far * to_sun) / radius
        molecules, aerosols, lost = lost_at(at, air)
        direct = passed(at, cosine, air)
        cap = 2 * math.pi * (1 - math.sqrt(1 - (EARTH / (EARTH + at)) ** 2))
        ground = passed(0.0, 1.0, air) / passed(at, 1.0, air) * passed(0.0, cosine, air) * cosine
        more = cap / (4 * math.pi) * 0.3 / math.pi * ground
        more += 0.02 * np.array([0.217, 0.347, 0.594, 1.0]) / (1 + 5 * math.exp(-17.92 * cosine))
        source = molecules * (by_molecules * direct + more) + aerosols * (by_aerosols * direct + more)
        passes = np.exp(-step * lost)
        total += left * source * (1 - passes) / lost
        left = left * passes
    return np.maximum(FROM_XYZ @ (total * sky._IRRADIANCE @ sky._XYZ), 0.0)


@pytest.mark.slow
@pytest.mark.parametrize("elevation, altitude", [(0.7, 100.0), (0.15, 3000.0)])
def test_the_table_holds_what_rays_bring_one_by_one(elevation, altitude):
    air = Air(elevation, altitude, 1.0, 2.0, 0.5)
    table = sky.whole_sky_table(air, 16, 12)
    for row in (0, 4, 7, 11):
        share = 2 * (row + 0.5) / 12 - 1
        for column in (0, 5, 7):
            azimuth = 2 * math.pi * (column + 0.5) / 16 - math.pi
            wanted = color(math.copysign(share**2, share) * math.pi / 2, azimuth, air)
            # What passes is told by a table there, linear between its places.
            np.testing.assert_allclose(table[row, column], wanted, rtol=0.02, atol=1e-3 * wanted.max())
            np.testing.assert_array_equal(table[row, 15 - column], table[row, column])


def test_the_sun_is_what_passes_over_its_solid_angle():
    air, diameter = Air(0.4, 500.0, 1.0, 1.0, 1.0), 0.01
    low, high = sky.sun_disc(air, diameter)
    for found, edge in ((low, 0.395), (high, 0.405)):
        spectrum = sky._IRRADIANCE * passed(0.5, math.sin(edge), air) / (math.pi * 0.005**2)
        np.testing.assert_allclose(found, FROM_XYZ @ (spectrum @ sky._XYZ), rtol=1e-3)


def test_the_horizon_sinks_with_altitude():
    assert sky.horizon(Air(0.4, 1.0, 1.0, 1.0, 1.0)) == pytest.approx(-math.sqrt(2 * 0.001 / EARTH), rel=1e-3)
    assert sky.horizon(Air(0.4, 10_000.0, 1.0, 1.0, 1.0)) == pytest.approx(-math.acos(EARTH / (EARTH + 10)), rel=1e-9)


def test_a_sky_cannot_be_changed():
    with pytest.raises(ValueError, match="read-only"):
        sky.whole_sky_table(Air(0.5, 0.0, 1.0, 1.0, 1.0), 16, 8)[0] = 0
