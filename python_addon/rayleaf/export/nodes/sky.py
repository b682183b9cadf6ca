"""Sky Texture: skies of scattered light with their sun, that of Hosek and Wilkie, and Preetham's (Preetham, Shirley, Smits:
"A Practical Analytic Model for Daylight", SIGGRAPH 1999)."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..atmosphere import FROM_XYZ, Air, sky_table, sun_disc
from ..hosek_wilkie import hosek_wilkie_table
from ..spectral_atmosphere import horizon, whole_sky_table
from ..spectral_atmosphere import sun_disc as spectral_sun_disc
from .compiler import NodeView, value_node
from .emitter import Register
from .textures import name_hidden_mapping

# Perez' five parameters of Y, x and y: factors on the turbidity, and what is added.
_PEREZ = (
    ((0.1787, -1.4630), (-0.3554, 0.4275), (-0.0227, 5.3251), (0.1206, -2.5771), (-0.0670, 0.3703)),
    ((-0.0193, -0.2592), (-0.0665, 0.0008), (-0.0004, 0.2125), (-0.0641, -0.8989), (-0.0033, 0.0452)),
    ((-0.0167, -0.2608), (-0.0950, 0.0092), (-0.0079, 0.2102), (-0.0441, -1.6537), (-0.0109, 0.0529)),
)
# The zenith's x and y: by powers of the turbidity (2, 1, 0), by powers of the sun's angle to the zenith (3, 2, 1, 0).
_ZENITH = (
    (
        (0.00166, -0.00375, 0.00209, 0.0),
        (-0.02903, 0.06377, -0.03202, 0.00394),
        (0.11693, -0.21196, 0.06052, 0.25886),
    ),
    (
        (0.00275, -0.00610, 0.00317, 0.0),
        (-0.04214, 0.08970, -0.04153, 0.00516),
        (0.15346, -0.26756, 0.06670, 0.26688),
    ),
)
_BRIGHTNESS = 0.06  # Cycles' factor on Preetham's luminance


def _direction(view: NodeView) -> Register:
    """With the sun's disc, Blender takes the vector away; a link to it may still be there."""
    socket = view.socket("Vector")
    is_asked = socket is not None and socket.enabled
    return view.vector("Vector") if is_asked else view.compiler.generated()


class _Sky:
    """A direction, and arithmetic with what is known of it."""

    def __init__(self, view: NodeView) -> None:
        self.emitter = view.emitter
        self.direction = self.vector("NORMALIZE", _direction(view))
        self.height = self.emitter.component(self.direction, 2)

    def vector(self, name: str, *operands: Register) -> Register:
        return self.emitter.operation("vector_math", operands, text=name)

    def number(self, name: str, *operands: Register | float) -> Register:
        known = [self.emitter.scalar(each) if isinstance(each, float) else each for each in operands]
        return self.emitter.math(name, *known)

    def angle_to(self, direction: tuple[float, float, float]) -> Register:
        """Exact where it is small, too."""
        other = self.emitter.constant(*direction)
        apart, together = (
            self.vector("LENGTH", self.vector(name, self.direction, other)) for name in ("SUBTRACT", "ADD")
        )
        return self.number("MULTIPLY", self.number("ARCTAN2", apart, together), 2.0)


@value_node("ShaderNodeTexSky")
def sky(view: NodeView, output: str) -> Register:
    """Sky Texture."""
    name_hidden_mapping(view)
    if view.node.sky_type == "PREETHAM":
        return _preetham(view)
    if view.node.sky_type == "HOSEK_WILKIE":
        return _hosek_wilkie(view)
    if view.node.sky_type not in ("NISHITA", "SINGLE_SCATTERING", "MULTIPLE_SCATTERING"):
        view.warn(f"the sky type {view.node.sky_type} is rendered as Nishita's")
    return _scattering(view)


# --- Preetham -----------------------------------------------------------------------------------------------------------


def _perez_at(parameters: list[float], zenith_angle: float, sun_angle: float) -> float:
    a, b, c, d, e = parameters
    gradation = 1.0 + a * math.exp(b / math.cos(zenith_angle))
    return gradation * (1.0 + c * math.exp(d * sun_angle) + e * math.cos(sun_angle) ** 2)


def _zenith(turbidity: float, angle: float) -> list[float]:
    """Y, x and y."""
    depth = (4.0 / 9.0 - turbidity / 120.0) * (math.pi - 2.0 * angle)
    luminance = (4.0453 * turbidity - 4.9710) * math.tan(depth) - 0.2155 * turbidity + 2.4192
    powers = np.array([angle**3, angle**2, angle, 1.0])
    chromaticities = [float(np.array([turbidity**2, turbidity, 1.0]) @ np.array(each) @ powers) for each in _ZENITH]
    return [luminance * _BRIGHTNESS, *chromaticities]


def _preetham(view: NodeView) -> Register:
    found, node, emitter = _Sky(view), view.node, view.emitter
    sun = np.array(node.sun_direction, float)
    sun /= max(float(np.linalg.norm(sun)), 1e-9)
    angle = math.acos(float(np.clip(sun[2], -1.0, 1.0)))
    slant = found.number("MAXIMUM", found.height, math.sin(0.001))  # the cosine to the zenith
    apart = found.angle_to((float(sun[0]), float(sun[1]), float(sun[2])))
    near = found.number("POWER", found.number("COSINE", apart), 2.0)
    channels = []
    for zenith, rows in zip(_zenith(node.turbidity, angle), _PEREZ):
        parameters = [factor * node.turbidity + added for factor, added in rows]
        a, b, c, d, e = parameters
        gradation = found.number("EXPONENT", found.number("DIVIDE", b, slant))
        gradation = found.number("MULTIPLY_ADD", gradation, a, 1.0)
        glow = found.number("EXPONENT", found.number("MULTIPLY", apart, d))
        scattering = found.number("ADD", found.number("MULTIPLY_ADD", glow, c, 1.0), found.number("MULTIPLY", near, e))
        scale = zenith / _perez_at(parameters, 0.0, angle)
        channels.append(found.number("MULTIPLY", found.number("MULTIPLY", gradation, scattering), scale))
    luminance, x, y = channels
    by_y = found.number("DIVIDE", luminance, y)
    rest = found.number("SUBTRACT", found.number("SUBTRACT", 1.0, x), y)
    xyz = emitter.operation(
        "combine", [found.number("MULTIPLY", x, by_y), luminance, found.number("MULTIPLY", rest, by_y)]
    )
    rgb = [found.vector("DOT_PRODUCT", xyz, emitter.constant(*row)) for row in FROM_XYZ]
    return found.vector("MAXIMUM", emitter.operation("combine", rgb), emitter.scalar(0.0))


def _header(table: NDArray[np.float32], azimuth: float, is_whole: bool) -> NDArray[np.float32]:
    """Of the table of core/shading/sky.h, without a disc; `azimuth`: of the sun, from y towards x."""
    height, width = table.shape[:2]
    header = np.zeros((5, 4), np.float32)
    header[3] = (azimuth - math.pi, width, height, 0.0)
    header[4, 0] = is_whole
    return header


# --- Hosek and Wilkie ---------------------------------------------------------------------------------------------------


def _hosek_wilkie(view: NodeView) -> Register:
    node = view.node
    x, y, z = node.sun_direction
    elevation = math.atan2(z, math.hypot(x, y))
    table = hosek_wilkie_table(node.turbidity, node.ground_albedo, elevation)
    header = _header(table, math.atan2(x, y), True)
    return view.emitter.operation("sky", [_direction(view)], floats=np.concatenate([header.ravel(), table.ravel()]))


# --- Scattering, once or more ---------------------------------------------------------------------------------------------


def _scattering(view: NodeView) -> Register:
    node = view.node
    dust = node.dust_density if hasattr(node, "dust_density") else node.aerosol_density  # 5.0
    elevation, rotation = node.sun_elevation, node.sun_rotation
    # Cycles takes the sun over the zenith to the other side.
    elevation = math.remainder(elevation, 2.0 * math.pi)
    if abs(elevation) > 0.5 * math.pi:
        elevation = math.copysign(math.pi, elevation) - elevation
        rotation += math.pi
    is_whole = node.sky_type == "MULTIPLE_SCATTERING"
    altitude = min(max(node.altitude, 1.0), 99999.0 if is_whole else 59999.0)
    air = Air(elevation, altitude, node.air_density, dust, node.ozone_density)
    return view.emitter.operation("sky", [_direction(view)], floats=_sky_floats(node, air, rotation, is_whole))


def _sky_floats(node: Any, air: Air, rotation: float, is_whole: bool) -> NDArray[np.float32]:
    """The table of core/shading/sky.h."""
    table = whole_sky_table(air) if is_whole else sky_table(air)
    half, e = 0.5 * node.sun_size, air.elevation
    lowest = horizon(air) if is_whole else 0.0
    header = _header(table, rotation, is_whole)
    header[4, 1] = lowest
    if node.sun_disc and half > 0.0 and e + half > lowest:
        edges = (spectral_sun_disc if is_whole else sun_disc)(air, node.sun_size)
        low, high = (edge * node.sun_intensity for edge in edges)
        header[0] = (math.cos(e) * math.sin(rotation), math.cos(e) * math.cos(rotation), math.sin(e), half)
        header[1] = (*low, e - half if is_whole else max(e - half, 0.0))
        header[2] = (*high, e + half)
    return np.concatenate([header.ravel(), table.ravel()])
