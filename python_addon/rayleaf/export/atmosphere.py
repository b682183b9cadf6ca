"""Light of the sky after Nishita et al. ("Display of The Earth Taking into Account Atmospheric Scattering", SIGGRAPH 1993):
single scattering by air and dust, absorption by ozone, with the constants that Cycles takes.

Spectra have 21 wavelengths from 380 to 780 nm. Lengths are in metres.
"""

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_AIR_HEIGHT, _DUST_HEIGHT = 8000.0, 1200.0  # at which the density is 1 / e
_DUST_SCATTERING, _DUST_EXTINCTION = 2e-5, 1.11  # per metre at sea level; the second a factor on the first
_DUST_ANISOTROPY = 0.76
_EARTH, _ATMOSPHERE = 6360e3, 6420e3  # radii
_STEPS = 32
_NANOMETRES = 20.0  # between wavelengths
# Of the sun above the atmosphere, W / (m² nm).
_IRRADIANCE = np.array(
    [
        *(1.457568299, 1.565963006, 1.651484490, 1.714962427, 1.757979838, 1.782564079, 1.790951085),
        *(1.785415501, 1.768155549, 1.741220696, 1.706471272, 1.665560875, 1.619934372, 1.570835974),
        *(1.519323351, 1.466284950, 1.412458527, 1.358449620, 1.304749138, 1.251749633, 1.199759988),
    ]
)
# Scattering of air and absorption of ozone, per metre.
_AIR = 1e-6 * np.array(
    [
        *(54.24820088, 44.18549867, 36.35151910, 30.17929012, 25.26320227, 21.30859311, 18.09838025),
        *(15.47057129, 13.30284977, 11.50184784, 9.995574300, 8.727999736, 7.655137010, 6.742172038),
        *(5.961341258, 5.290345981, 4.711156876, 4.209104811, 3.772183813, 3.390512555, 3.055915317),
    ]
)
_OZONE = 1e-6 * np.array(
    [
        *(0.00325126850, 0.00585395365, 0.01977191155, 0.07309568763, 0.20084561514, 0.40383958096, 0.63551335912),
        *(0.96707041181, 1.54797400424, 2.09038647223, 2.46128056165, 2.73551299462, 2.15125863129, 1.59051840792),
        *(1.12356197980, 0.73527551487, 0.46450130358, 0.33096079921, 0.22512612292, 0.14879129266, 0.16828623364),
    ]
)
# The observer of 1931, at these wavelengths.
_OBSERVER = np.array(
    [
        *((0.001368, 0.000039, 0.006450001), (0.01431, 0.000396, 0.06785001), (0.13438, 0.004, 0.6456)),
        *((0.34828, 0.023, 1.74706), (0.2908, 0.06, 1.6692), (0.09564, 0.13902, 0.8129501)),
        *((0.0049, 0.323, 0.272), (0.06327, 0.71, 0.07825), (0.2904, 0.954, 0.0203)),
        *((0.5945, 0.995, 0.0039), (0.9163, 0.87, 0.00165), (1.0622, 0.631, 0.0008)),
        *((0.85445, 0.381, 0.00019), (0.4479, 0.175, 0.00002), (0.1649, 0.061, 0.0)),
        *((0.04677, 0.017, 0.0), (0.01135916, 0.004102, 0.0), (0.002899327, 0.001047, 0.0)),
        *((0.0006900786, 0.0002492, 0.0), (0.0001661505, 0.00006, 0.0), (0.00004150994, 0.00001499, 0.0)),
    ]
)
# To linear Rec. 709.
FROM_XYZ = np.array(
    [[3.2404542, -1.5371385, -0.4985314], [-0.9692660, 1.8760108, 0.0415560], [0.0556434, -0.2040259, 1.0572252]]
)
# Gauss and Laguerre's eight places and weights for an integral that falls off exponentially, in shares of the way to the
# border of the atmosphere.
_PLACES = (0.006811185, 0.036148071, 0.090043465, 0.170668007, 0.281836216, 0.430340640, 0.629627146, 0.914525269)
_WEIGHTS = (0.017508936, 0.041354774, 0.066788391, 0.095076988, 0.128341637, 0.170743020, 0.232723335, 0.356249049)


@dataclass(frozen=True)
class Air:
    """What a Sky Texture sets."""

    elevation: float  # of the sun, radians
    altitude: float  # of the viewer, metres
    air: float  # factors on what is usual
    dust: float
    ozone: float


def _densities(height: Array) -> Array:
    """Of air, dust and ozone, first axis; 1 where usual at sea level, or at the middle of the ozone layer."""
    ozone = np.clip(1.0 - np.abs(height - 25000.0) / 15000.0, 0.0, None)
    return np.stack([np.exp(-height / _AIR_HEIGHT), np.exp(-height / _DUST_HEIGHT), ozone])


def _way_out(squared: Array, along: Array) -> Array:
    """To the border of the atmosphere; `squared`: distance from the middle of the earth, `along`: the part of the place
    that lies in the direction."""
    return np.asarray(-along + np.sqrt(along**2 - squared + _ATMOSPHERE**2), np.float64)


def _depth(squared: Array, along: Array) -> Array:
    """Densities times length, from places to the border."""
    length = _way_out(squared, along)
    total = np.zeros((3, *length.shape))
    for share, weight in zip(_PLACES, _WEIGHTS):
        far = share * length
        total += weight * _densities(np.sqrt(squared + far * (2.0 * along + far)) - _EARTH)
    return total * length


def _direction(latitude: Array, longitude: Array) -> Array:
    return np.stack([np.cos(latitude) * np.cos(longitude), np.cos(latitude) * np.sin(longitude), np.sin(latitude)], -1)


def _xyz(spectrum: Array) -> Array:
    return np.asarray(spectrum @ _OBSERVER * _NANOMETRES, np.float64)


def _is_in_shadow(squared: Array, along: Array, sun: Array) -> Array:
    """Of the earth."""
    return np.asarray((sun[2] < 0.0) & (along**2 >= squared - _EARTH**2))


def _scattered(directions: Array, sun: Array, air: Air) -> Array:
    """Spectra that arrive from directions: (wavelengths, directions)."""
    start = _EARTH + air.altitude
    scale = np.array([[air.air], [air.dust], [air.ozone]])
    cosine, upward = (directions * sun).sum(-1), directions[:, 2]
    g2 = _DUST_ANISOTROPY**2
    phase_air = 3.0 / (16.0 * np.pi) * (1.0 + cosine**2)
    phase_dust = 3.0 / (8.0 * np.pi) * (1.0 - g2) * (1.0 + cosine**2) / (2.0 + g2)
    phase_dust /= (1.0 + g2 - 2.0 * _DUST_ANISOTROPY * cosine) ** 1.5
    step = _way_out(np.array(start**2), start * upward) / _STEPS
    depth = np.zeros((3, len(cosine)))
    total = np.zeros((len(_AIR), len(cosine)))
    for i in range(_STEPS):
        away = (i + 0.5) * step
        squared, along = start**2 + away * (2.0 * start * upward + away), start * sun[2] + away * cosine
        density = scale * _densities(np.sqrt(squared) - _EARTH)
        depth += step * density
        by_air, by_dust, by_ozone = depth + scale * _depth(squared, along)
        lit = step * ~_is_in_shadow(squared, along, sun)
        from_air, from_dust = phase_air * density[0] * lit, phase_dust * density[1] * _DUST_SCATTERING * lit
        by_dust *= _DUST_EXTINCTION * _DUST_SCATTERING
        for band, (air_there, ozone_there) in enumerate(zip(_AIR, _OZONE)):
            passed = np.exp(-(air_there * by_air + by_dust + ozone_there * by_ozone))
            total[band] += passed * (air_there * from_air + from_dust)
    return total * _IRRADIANCE[:, None]


@lru_cache(maxsize=4)
def sky_table(air: Air, width: int = 512, height: int = 128) -> NDArray[np.float32]:
    """(height, width, 3), linear: rows by the root of the elevation, columns by the azimuth, the sun in the middle. Not to
    be changed."""
    sun = _direction(np.array(air.elevation), np.array(0.0))
    rows = (0.5 * np.pi + 0.25 * np.pi / height) * (np.arange(height) / height) ** 2
    columns = 2.0 * np.pi / width * np.arange(width // 2) - np.pi
    directions = _direction(rows[:, None] + 0.0 * columns, columns + 0.0 * rows[:, None])
    half = _xyz(_scattered(directions.reshape(-1, 3), sun, air).T).reshape(height, width // 2, 3)
    whole = np.concatenate([half, half[:, ::-1]], axis=1)
    table = np.maximum(whole @ FROM_XYZ.T, 0.0).astype(np.float32)
    table.flags.writeable = False
    return table


def sun_disc(air: Air, diameter: float) -> tuple[Array, Array]:
    """The radiance at the lower and the upper edge of the sun, linear."""
    half = 0.5 * diameter
    solid_angle = 4.0 * math.pi * math.sin(0.5 * half) ** 2
    start = _EARTH + air.altitude
    found = []
    for elevation in (air.elevation - half, air.elevation + half):
        depth = _depth(np.array(start**2), np.array(start * math.sin(max(elevation, 0.0))))
        lost = _AIR * (depth[0] * air.air) + _DUST_EXTINCTION * _DUST_SCATTERING * depth[1] * air.dust
        found.append(_xyz(_IRRADIANCE * np.exp(-lost) / solid_angle) @ FROM_XYZ.T)
    return found[0], found[1]
