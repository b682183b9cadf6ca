"""Light of the sky with multiple scattering, after F. García Liñán ("Real-Time Spectral Sky", 2024), with the constants
that Cycles 5 takes: four wavelengths stand for the spectrum, and light that was scattered more than once is told by a fit
for the earth's atmosphere.

Lengths are in kilometres, wavelengths in the order 630, 560, 490, 430 nm, as the last axis. Directions in a plane through
the zenith and the sun are told by their cosine to the zenith.
"""

import math
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from .atmosphere import FROM_XYZ, Air

Array = NDArray[np.float64]

_EARTH, _THICKNESS = 6371.0, 100.0
_ATMOSPHERE = _EARTH + _THICKNESS
_STEPS = 64
_IRRADIANCE = np.array([1.679, 1.828, 1.986, 1.307])  # of the sun above the atmosphere, W / (m² nm)
_MOLECULES = np.array([6.605e-3, 1.067e-2, 1.842e-2, 3.156e-2])  # scattering at sea level, per km
_OZONE = 334.5 * np.array([3.472e-25, 3.914e-25, 1.349e-25, 11.03e-27])  # absorption by density
_AEROSOL_ABSORPTION = np.array([2.8722e-24, 4.6168e-24, 7.9706e-24, 1.3578e-23])
_AEROSOL_SCATTERING = np.array([1.5908e-22, 1.7711e-22, 2.0942e-22, 2.4033e-22])
_AEROSOL_DENSITY, _AEROSOL_BACKGROUND, _AEROSOL_HEIGHT = 1.3681e20, 2e6, 0.73
_ANISOTROPY = 0.8  # of aerosols
_ALBEDO = 0.3  # of the ground
_FIT = 0.02 * np.array([0.217, 0.347, 0.594, 1.0])  # scattered more than once, with the sun in the zenith
# Of each wavelength, the part of X, Y and Z.
_XYZ = np.array(
    [
        [53.386917738564668, 22.981337506691025, 0.0],
        [43.904844466369358, 71.347795700053394, 0.10250686796574131],
        [1.6137278251608962, 18.422960591455485, 31.742921188390806],
        [20.762668673810577, 2.3614213523314369, 110.48009643252140],
    ]
)
_ALTITUDES, _COSINES = 64, 256  # of the table of what passes


def _coefficients(height: Array, air: Air) -> tuple[Array, Array, Array]:
    """Scattering by molecules, by aerosols, and all that is lost, per km."""
    height = np.maximum(height, 0.0)[..., None]
    molecules = _MOLECULES * np.exp(-0.07771971 * height**1.16364243) * air.air
    logarithm = np.log(np.maximum(height, 1e-4))
    ozone = _OZONE * 3.78547397e20 * np.exp(-((logarithm - 3.22261) ** 2) * 5.55555555 - logarithm) * air.ozone
    density = _AEROSOL_DENSITY * np.exp(-height / _AEROSOL_HEIGHT) + _AEROSOL_BACKGROUND
    aerosols = _AEROSOL_SCATTERING * density * air.dust
    return molecules, aerosols, molecules + ozone + aerosols + _AEROSOL_ABSORPTION * density * air.dust


def _way_out(radius: Array, cosine: Array) -> Array:
    """To the border of the atmosphere, from a distance from the middle of the earth."""
    along = radius * cosine
    return np.asarray(-along + np.sqrt(along**2 - radius**2 + _ATMOSPHERE**2), np.float64)


def _way_to_ground(radius: float, cosine: Array) -> Array:
    """Infinity where the ground is not met."""
    along = radius * cosine
    squared = along**2 - radius**2 + _EARTH**2
    meets = (squared >= 0.0) & (cosine < 0.0)
    return np.where(meets, -along - np.sqrt(np.maximum(squared, 0.0)), np.inf)


def _passed(cosine: Array, height: Array, air: Air) -> Array:
    """What passes from the border of the atmosphere to a height, by the earth too; (..., 4)."""
    radius = _EARTH + height
    step = _way_out(radius, cosine) / _STEPS
    lost = np.zeros((*np.broadcast(cosine, height).shape, 4))
    for i in range(_STEPS):
        far = (i + 0.5) * step
        at = np.sqrt(radius**2 + far * (2.0 * radius * cosine + far)) - _EARTH
        lost += _coefficients(at, air)[2] * step[..., None]
    return np.exp(-lost)


def _between(table: Array, at: Array) -> Array:
    """Linearly between the rows of a table, at numbers from 0 to 1."""
    place = np.clip(at, 0.0, 1.0) * (len(table) - 1)
    first = np.minimum(place.astype(np.int64), len(table) - 2)
    share = (place - first).reshape(*first.shape, *(1,) * (table.ndim - 1))
    return np.asarray(table[first] * (1.0 - share) + table[first + 1] * share, np.float64)


class _Light:
    """What comes of the sun to places in the atmosphere: at one height for each row of cosines between it and the zenith."""

    def __init__(self, air: Air) -> None:
        heights = np.linspace(0.0, _THICKNESS, _ALTITUDES)[:, None]
        self._passed = _passed(np.linspace(-1.0, 1.0, _COSINES)[None], heights, air)  # by height, then cosine

    def direct(self, heights: Array, cosines: Array) -> Array:
        """The share that passes."""
        of_height = _between(self._passed, heights / _THICKNESS)
        place = np.clip(0.5 * cosines + 0.5, 0.0, 1.0) * (_COSINES - 1)
        first = np.minimum(place.astype(np.int64), _COSINES - 2)
        share, row = (place - first)[..., None], np.arange(len(cosines))[:, None]
        return np.asarray(of_height[row, first] * (1.0 - share) + of_height[row, first + 1] * share, np.float64)

    def scattered(self, heights: Array, cosines: Array) -> Array:
        """Of the ground, and of the rest of the atmosphere."""
        cap = 2.0 * np.pi * (1.0 - np.sqrt(1.0 - (_EARTH / (_EARTH + heights)) ** 2))
        of_zenith = self._passed[:, -1]
        from_ground = of_zenith[0] / _between(of_zenith, heights / _THICKNESS)
        of_ground = from_ground * (cap / (4.0 * np.pi) * _ALBEDO / np.pi)[:, None]
        lit = _between(self._passed[0], 0.5 * cosines + 0.5) * cosines[..., None]
        of_air = _FIT / (1.0 + 5.0 * np.exp(-17.92 * cosines[..., None]))
        return np.asarray(of_ground[:, None] * lit + of_air, np.float64)


def horizon(air: Air) -> float:
    """The elevation below which the earth is seen."""
    return math.asin(_EARTH / (_EARTH + air.altitude / 1000.0)) - 0.5 * math.pi


@lru_cache(maxsize=4)
def whole_sky_table(air: Air, width: int = 512, height: int = 256) -> NDArray[np.float32]:
    """(height, width, 3), linear: rows from the nadir to the zenith, by the root of the elevation to either side; columns by
    the azimuth, the sun in the middle. Not to be changed."""
    light, start = _Light(air), _EARTH + air.altitude / 1000.0
    share = 2.0 * (np.arange(height) + 0.5) / height - 1.0
    elevation = np.copysign(share**2, share) * 0.5 * np.pi
    upward, level = np.sin(elevation)[:, None], np.cos(elevation)[:, None]
    azimuth = 2.0 * np.pi * (np.arange(width // 2) + 0.5) / width - np.pi
    to_sun = upward * math.sin(air.elevation) + level * np.cos(azimuth) * math.cos(air.elevation)
    by_molecules = 3.0 / (16.0 * np.pi) * (1.0 + to_sun**2)[..., None]
    peak = 1.0 + _ANISOTROPY**2 - 2.0 * _ANISOTROPY * to_sun
    by_aerosols = (1.0 - _ANISOTROPY**2) / (4.0 * np.pi * peak**1.5)[..., None]
    step = np.minimum(_way_out(np.array(start), upward), _way_to_ground(start, upward)) / _STEPS
    found, passed = np.zeros((height, width // 2, 4)), np.ones((height, 1, 4))
    for i in range(_STEPS):
        far = (i + 0.5) * step
        radius = np.sqrt(start**2 + far * (2.0 * start * upward + far))
        at, cosines = np.maximum(radius - _EARTH, 0.0), (start * math.sin(air.elevation) + far * to_sun) / radius
        molecules, aerosols, lost = _coefficients(at, air)
        direct, scattered = light.direct(at[:, 0], cosines), light.scattered(at[:, 0], cosines)
        source = molecules * (by_molecules * direct + scattered) + aerosols * (by_aerosols * direct + scattered)
        passes = np.exp(-step[..., None] * lost)
        found += passed * (1.0 - passes) / np.maximum(lost, 1e-7) * source
        passed = passed * passes
    half = found * _IRRADIANCE @ _XYZ @ FROM_XYZ.T
    table = np.maximum(np.concatenate([half, half[:, ::-1]], axis=1), 0.0).astype(np.float32)
    table.flags.writeable = False
    return table


def sun_disc(air: Air, diameter: float) -> tuple[Array, Array]:
    """The radiance at the lower and the upper edge of the sun, linear."""
    half = 0.5 * diameter
    solid_angle = 4.0 * math.pi * math.sin(0.5 * half) ** 2
    edges = np.sin([air.elevation - half, air.elevation + half])
    spectra = _IRRADIANCE * _passed(edges, np.array(air.altitude / 1000.0), air) / solid_angle
    low, high = spectra @ _XYZ @ FROM_XYZ.T
    return low, high
