"""Programs and points for the shading tests, and the statistics they judge samplers by."""

from collections.abc import Callable, Sequence
from typing import Any

import mpmath
import numpy as np
from numpy.typing import NDArray
from rayleaf import _core

Doubles = NDArray[np.float64]
UP = np.float32((0, 0, 1))
WHITE = (1.0, 1.0, 1.0)


def scalar(program: Any, value: float) -> int:
    """A register with a number."""
    return int(program.constant(value, value, value, value))


def program_with(
    identifier: str,
    operands: Sequence[Any],
    text: str = "",
    ints: Sequence[int] = (),
    bump_shadow: str = "CUBIC",
    clearing: str = "ALL",
) -> Any:
    """A program of one operation; operands are numbers, triples, or None for unconnected ones."""
    program = _core.Program("Test", bump_shadow, clearing)
    registers = []
    for operand in operands:
        if operand is None:
            registers.append(-1)
        elif isinstance(operand, (tuple, list)):
            registers.append(program.constant(*operand, 1.0))
        else:
            registers.append(scalar(program, operand))
    program.operation(identifier, registers, ints, text=text)
    return program


PRINCIPLED_DEFAULTS = {
    **{"weight": 1.0, "base_color": (0.8, 0.8, 0.8), "metallic": 0.0, "specular": 0.5, "specular_tint": 0.0},
    **{"roughness": 0.5, "anisotropic": 0.0, "anisotropic_rotation": 0.0, "sheen": 0.0, "sheen_tint": 0.5},
    **{"clearcoat": 0.0, "clearcoat_roughness": 0.03, "ior": 1.45, "transmission": 0.0, "transmission_roughness": 0.0},
    **{"emission_color": (0.0, 0.0, 0.0), "emission_strength": 1.0, "alpha": 1.0, "normal": None},
    **{"clearcoat_normal": None, "tangent": None},
}


def principled(text: str = "", clearing: str = "ALL", **values: Any) -> Any:
    """A Principled material, by name of operand; the rest as Blender has it."""
    assert set(values) <= set(PRINCIPLED_DEFAULTS)
    return program_with("principled", list({**PRINCIPLED_DEFAULTS, **values}.values()), text, clearing=clearing)


LAYERS_DEFAULTS = {
    **{"weight": 1.0, "base_color": (0.8, 0.8, 0.8), "metallic": 0.0, "specular_level": 0.5},
    **{"specular_tint": (1.0, 1.0, 1.0), "roughness": 0.5, "anisotropic": 0.0, "anisotropic_rotation": 0.0},
    **{"sheen": 0.0, "sheen_roughness": 0.5, "sheen_tint": (1.0, 1.0, 1.0), "coat": 0.0, "coat_roughness": 0.03},
    **{"coat_ior": 1.5, "coat_tint": (1.0, 1.0, 1.0), "emission_color": (0.0, 0.0, 0.0), "emission_strength": 1.0},
    **{"alpha": 1.0, "ior": 1.45, "transmission": 0.0, "normal": None, "coat_normal": None, "tangent": None},
    **{"diffuse_roughness": 0.0, "subsurface": 0.0, "subsurface_radius": (1.0, 0.2, 0.1), "subsurface_ior": 1.4},
    **{"subsurface_anisotropy": 0.0, "film_thickness": 0.0, "film_ior": 1.33, "thin_wall": 0.0},
}


def layers(text: str = "MULTI_GGX", clearing: str = "ALL", **values: Any) -> Any:
    """A Principled material of Blender 4, by name of operand; the rest as Blender has it."""
    assert set(values) <= set(LAYERS_DEFAULTS)
    return program_with("principled_layers", list({**LAYERS_DEFAULTS, **values}.values()), text, clearing=clearing)


def direction(cosine: float, azimuth: float = 0.4) -> NDArray[np.float32]:
    """A unit vector at an angle to +z."""
    sine = np.sqrt(1.0 - cosine * cosine)
    return np.float32((sine * np.cos(azimuth), sine * np.sin(azimuth), cosine))


def one_point(outgoing: Any, facet_normal: Any = UP, normal: Any = None) -> Any:
    """A point whose facet has `facet_normal`."""
    rows = [np.float32(v).reshape(1, 3) for v in (facet_normal, outgoing, facet_normal if normal is None else normal)]
    tangent = np.float32([[1, 0, 0]])
    return _core.shading.surface_points(
        np.zeros((1, 3), np.float32),
        rows[2],
        rows[1],
        facet_normal=rows[0],
        dp_du=tangent,
        dp_dv=np.float32([[0, 1, 0]]),
    )


def closures(program: Any, outgoing: Any, facet_normal: Any = UP, normal: Any = None) -> Any:
    """The closures of a program at such a point."""
    return one_point(outgoing, facet_normal, normal).closures(program, 0)


def stratified(side: int, seed: int = 0) -> NDArray[np.float32]:
    """side² x 1 random triples, stratified in the first two."""
    random = np.random.default_rng(seed)
    x, y = np.meshgrid(np.arange(side), np.arange(side))
    cells = np.stack([x.ravel(), y.ravel()], axis=1)
    pairs = (cells + random.random(cells.shape)) / side
    return (
        np.column_stack([pairs, random.random(len(pairs))]).clip(0, np.nextafter(np.float32(1), 0)).astype(np.float32)
    )


def albedo(lobes: Any, outgoing: Any, side: int = 128, facet_normal: Any = UP) -> Doubles:
    """Share of light scattered, all directions together, estimated by sampling."""
    sample = lobes.sample(outgoing, facet_normal, stratified(side))
    assert np.isfinite(sample["weight"]).all()
    return np.asarray((sample["weight"] * sample["valid"][:, None]).mean(axis=0, dtype=np.float64))


def integrated(density: Callable[[Any], Any], rows: int, columns: int) -> Doubles:
    """Integral of a density over each cell of an equal-area grid of the sphere, finer where it varies."""

    def integrals(cells: Any, steps: tuple[int, int]) -> tuple[Doubles, Doubles]:
        points, weights = cell_points(cells, rows, columns, steps)
        values = density(points.reshape(-1, 3).astype(np.float32)).astype(np.float64).reshape(weights.shape)
        return (values * weights).sum(axis=1), values

    everywhere = np.arange(rows * columns)
    sums, values = integrals(everywhere, (6, 6))
    rough = values.max(axis=1) > 1.5 * (values.min(axis=1) + 1e-4)
    if rough.any():
        sums[rough] = integrals(everywhere[rough], (96, 32))[0]  # the narrowest lobes are about a degree wide
    return sums


def cell_points(cells: Any, rows: int, columns: int, steps: tuple[int, int]) -> tuple[Doubles, Doubles]:
    """Midpoints (n, m, 3) of equal steps in angle over each cell, and the solid angle of each (n, m)."""
    row, column = np.divmod(cells, columns)
    bottom, top = np.arccos(row / rows * 2 - 1), np.arccos((row + 1) / rows * 2 - 1)
    shares = [(np.arange(count) + 0.5) / count for count in steps]
    polar = bottom[:, None, None] + (top - bottom)[:, None, None] * shares[0][None, :, None]
    azimuth = (column[:, None, None] + shares[1][None, None, :]) / columns * 2 * np.pi - np.pi
    parts = np.broadcast_arrays(np.sin(polar) * np.cos(azimuth), np.sin(polar) * np.sin(azimuth), np.cos(polar))
    points = np.stack(parts, axis=-1).reshape(len(cells), -1, 3)
    weights = np.broadcast_to(np.sin(polar), parts[0].shape).reshape(len(cells), -1)
    return points, weights / weights.sum(axis=1)[:, None] * 4 * np.pi / (rows * columns)


def cell_of(directions: Any, rows: int, columns: int) -> NDArray[np.int64]:
    """The cell of the grid in which each direction lies."""
    row = np.clip(((directions[:, 2] + 1) / 2 * rows).astype(np.int64), 0, rows - 1)
    azimuth = np.arctan2(directions[:, 1], directions[:, 0])
    column = np.clip(((azimuth + np.pi) / (2 * np.pi) * columns).astype(np.int64), 0, columns - 1)
    return np.asarray(row * columns + column)


def chi_square_p_value(observed: Doubles, expected: Doubles, least: float = 8.0) -> float:
    """Probability of counts at least this far from those expected; cells expected to hold less than `least` are pooled."""
    order = np.argsort(expected)
    observed, expected = observed[order], expected[order]
    split = int(np.searchsorted(np.cumsum(expected), least)) + 1  # the rarest cells, together at least `least`
    observed = np.concatenate([[observed[:split].sum()], observed[split:]])
    expected = np.concatenate([[expected[:split].sum()], expected[split:]])
    while len(expected) > 1 and expected[1] < least:  # and the next ones that are still too rare
        observed = np.concatenate([[observed[:2].sum()], observed[2:]])
        expected = np.concatenate([[expected[:2].sum()], expected[2:]])
    if expected[0] < 1e-9:
        return float(observed[0] == 0)
    statistic = float(((observed - expected) ** 2 / expected).sum())
    freedom = max(len(expected) - 1, 1)
    return float(mpmath.gammainc(freedom / 2, statistic / 2, mpmath.inf, regularized=True))
