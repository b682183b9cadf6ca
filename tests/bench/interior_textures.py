"""Two hundred pictures for make_interior.py, by NumPy alone: (size, size, 3), sRGB, rows bottom to top, all different."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Doubles = NDArray[np.float64]
Painter = Callable[[np.random.Generator, int], Doubles]


def squares(size: int) -> tuple[Doubles, Doubles]:
    """u and v of each pixel, 0 to 1."""
    along = (np.arange(size) + 0.5) / size
    u, v = np.meshgrid(along, along)
    return u, v


def noise(random: np.random.Generator, size: int, cells: int, octaves: int = 4) -> Doubles:
    """Smooth noise about 0 that repeats at the borders: sums of finer and finer random grids, blended."""
    total = np.zeros((size, size))
    for octave in range(octaves):
        count = min(cells * 2**octave, size)
        grid = random.normal(size=(count, count))
        place = (np.arange(size) + 0.5) / size * count
        low = np.floor(place).astype(int)
        t = place - low
        t = t * t * (3 - 2 * t)
        near, far = low % count, (low + 1) % count
        rows = grid[near] * (1 - t)[:, None] + grid[far] * t[:, None]
        total += (rows[:, near] * (1 - t) + rows[:, far] * t) * 0.5**octave
    return total


def color(random: np.random.Generator, low: float = 0.1, high: float = 0.85) -> Doubles:
    """Any."""
    return random.uniform(low, high, 3)


def mixed(amount: Doubles, first: Doubles, second: Doubles) -> Doubles:
    """From the first colour, at 0, to the second, at 1."""
    amount = np.clip(amount, 0, 1)[..., None]
    return first * (1 - amount) + second * amount


def wood(random: np.random.Generator, size: int) -> Doubles:
    """Rings along v, and pores."""
    u, v = squares(size)
    rings = np.sin(2 * np.pi * (random.integers(6, 14) * u + 0.5 * noise(random, size, 2, 3)))
    pores = noise(random, size, 16, 3) * 0.25
    base = np.array([0.55, 0.36, 0.2]) * random.uniform(0.5, 1.3)
    return mixed(0.5 + 0.35 * rings + pores, base, base * random.uniform(0.45, 0.75))


def parquet(random: np.random.Generator, size: int) -> Doubles:
    """Boards, each of its own shade, side by side."""
    u, v = squares(size)
    column = np.floor(u * 8).astype(int)
    row = np.floor(v * 2 + column * 0.37).astype(int)
    shade = random.uniform(0.7, 1.1, (8, 4))[column, row % 4]
    gap = (u * 8 % 1 < 0.03) | ((v * 2 + column * 0.37) % 1 < 0.008)
    return np.where(gap[..., None], 0.12, wood(random, size) * shade[..., None])


def weave(random: np.random.Generator, size: int) -> Doubles:
    """Cloth with stripes both ways."""
    u, v = squares(size)
    first, second = color(random), color(random)
    count = int(random.integers(3, 9))
    stripes = (np.sin(2 * np.pi * count * u) > 0).astype(float) + (np.sin(2 * np.pi * count * v) > 0.3)
    threads = 0.85 + 0.15 * np.sin(2 * np.pi * 64 * u) * np.sin(2 * np.pi * 64 * v)
    return mixed(stripes / 2, first, second) * threads[..., None]


def tiles(random: np.random.Generator, size: int) -> Doubles:
    """Stones with joints between them."""
    u, v = squares(size)
    count = int(random.integers(3, 7))
    joint = (u * count % 1 < 0.04) | (v * count % 1 < 0.04)
    base = color(random, 0.4, 0.8)
    return np.where(joint[..., None], 0.3, base * (1 + 0.2 * noise(random, size, 8))[..., None])


def marble(random: np.random.Generator, size: int) -> Doubles:
    """Veins."""
    u, v = squares(size)
    veins = np.abs(np.sin(np.pi * (3 * u + 2 * v + 0.9 * noise(random, size, 3, 5)))) ** 0.4
    return mixed(veins, color(random, 0.1, 0.4), color(random, 0.7, 0.92))


def wallpaper(random: np.random.Generator, size: int) -> Doubles:
    """Flowers in rows that are set off from each other."""
    u, v = squares(size)
    row = np.floor(v * 6)
    x, y = (u * 6 + 0.5 * (row % 2)) % 1 - 0.5, v * 6 % 1 - 0.5
    angle, radius = np.arctan2(y, x), np.hypot(x, y)
    flower = radius < 0.2 + 0.08 * np.cos(random.integers(3, 7) * angle)
    ground = color(random, 0.55, 0.85)
    return mixed(flower * 0.7 + 0.1 * noise(random, size, 4), ground, color(random, 0.2, 0.7))


def cover(random: np.random.Generator, size: int) -> Doubles:
    """Of a book: worn cloth, bands, and a label with lines of type."""
    u, v = squares(size)
    picture = color(random, 0.05, 0.6) * (1 + 0.12 * noise(random, size, 12))[..., None]
    for height in random.uniform(0.05, 0.95, 3):
        picture[np.abs(v - height) < 0.012] = (0.75, 0.62, 0.25)
    label = (np.abs(u - 0.5) < 0.32) & (np.abs(v - 0.62) < 0.14)
    type_lines = label & (v * 40 % 1 < 0.45) & (noise(random, size, 24, 1) > -0.2)
    picture[label] = (0.85, 0.8, 0.68)
    picture[type_lines] = (0.1, 0.08, 0.07)
    return picture


def painting(random: np.random.Generator, size: int) -> Doubles:
    """Fields of colour about random points, with brush strokes."""
    u, v = squares(size)
    u, v = u + 0.04 * noise(random, size, 4), v + 0.04 * noise(random, size, 4)
    points, paints = random.uniform(size=(24, 2)), random.uniform(0.05, 0.95, (24, 3))
    distance = np.stack([np.hypot(u - x, v - y) for x, y in points])
    return paints[np.argmin(distance, axis=0)] * (1 + 0.15 * noise(random, size, 20, 2))[..., None]


# Name of a group of textures -> how one is painted, and how many there are.
GROUPS: dict[str, tuple[Painter, int]] = {
    "floor": (parquet, 1),
    "wall": (wallpaper, 4),
    "book": (cover, 112),
    "painting": (painting, 24),
    "furniture": (wood, 24),
    "cushion": (weave, 20),
    "stone": (marble, 9),
    "tile": (tiles, 6),
}


def textures(seed: int, size: int) -> dict[str, list[Doubles]]:
    """All, by group."""
    random = np.random.default_rng(seed)
    return {
        name: [np.clip(paint(random, size), 0.0, 1.0) for _ in range(count)] for name, (paint, count) in GROUPS.items()
    }
