"""Rays per second against patches: Rayleaf's tracer, and Embree's own grids and triangles fed with the same facets.

One thread, its processor time. The scene is fifteen lumpy closed tori over a wavy ground, all bicubic. Camera rays run
in tiles of 16 x 16 pixels, mirror and hemisphere rays start where they hit.

The work is not the same: Embree alone gives t in single precision; Rayleaf's rays are given and clipped in world space
in double, and it computes t in double, the patch and its parameters, the point and the facet's normal.
"""

from typing import Any

import numpy as np
import rayleaf_rivals
from numpy.typing import NDArray
from rayleaf import _core

Doubles = NDArray[np.float64]

REPEATS = 5
WIDTH, HEIGHT, TILE = 512, 288, 16
# Patches along the ground's and around the tori, so that the sum is about 10^3, 10^4, 10^5.
SIZES = {1_000: 8, 10_000: 25, 100_000: 79}
# 512 triangles a subpatch and about 170 bytes each: 10^5 would take 9 GB.
MOST_SUBPATCHES_AS_TRIANGLES = 20_000
CUBIC_OPEN, CUBIC_CLOSED = (4, False, False, False), (4, True, False, False)
LEAVING_OFFSET = 1e-4
EYE = np.array([0.0, -3.2, 1.9])


def with_weights(points: Doubles) -> Doubles:
    """Control points (v, u, 3) with weight 1."""
    return np.concatenate([points, np.ones((*points.shape[:2], 1))], axis=2)


def torus(center: Doubles, radius: float, around: int, along: int, random: np.random.Generator) -> Doubles:
    """Control points of a lumpy closed torus."""
    u, v = np.meshgrid(np.arange(around) * 2 * np.pi / around, np.arange(along) * 2 * np.pi / along)
    phase = random.uniform(0, 2 * np.pi, 4)
    lump = 1 + 0.15 * np.sin(3 * v + phase[0]) * np.cos(2 * u + phase[1]) + 0.07 * np.sin(5 * v + phase[2] + u)
    tube = 0.4 * radius * lump
    ring = radius + tube * np.cos(u)
    points = np.stack([ring * np.cos(v), ring * np.sin(v), tube * np.sin(u)], axis=2)
    axis, angle = random.normal(size=3), random.uniform(0, np.pi)
    axis /= np.linalg.norm(axis)
    skew = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    rotation = np.eye(3) + np.sin(angle) * skew + (1 - np.cos(angle)) * (skew @ skew)
    return with_weights(points @ rotation.T + center)


def ground(count: int) -> Doubles:
    """Control points of a wavy sheet of count x count patches."""
    x, y = np.meshgrid(np.linspace(-2, 2, count + 3), np.linspace(-2, 2, count + 3))
    return with_weights(np.stack([x, y, 0.08 * np.sin(4 * x) * np.cos(3 * y) - 0.5], axis=2))


def scene(resolution: int) -> Any:
    """The surface with `resolution` patches around a torus's tube."""
    random = np.random.default_rng(7)
    splines = [(ground(2 * resolution), CUBIC_OPEN, CUBIC_OPEN, True, 0)]
    for i in range(15):
        center = np.array([0.75 * (i % 5 - 2), 0.75 * (i // 5 - 1), 0.15 + 0.2 * random.uniform()])
        points = torus(center, 0.22, resolution, resolution, random)
        splines.append((points, CUBIC_CLOSED, CUBIC_CLOSED, True, 0))
    return _core.trace.PatchSurface("benchmark", splines)


def unit(vectors: Doubles) -> Doubles:
    """Vectors of length 1."""
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def camera_rays(width: int = WIDTH, height: int = HEIGHT) -> tuple[Doubles, Doubles]:
    """Origins and directions, tile by tile."""
    x, y = np.meshgrid(np.arange(width), np.arange(height))
    order = np.lexsort(((x % TILE).ravel(), (y % TILE).ravel(), (x // TILE).ravel(), (y // TILE).ravel()))
    screen_x = ((x + 0.5) / width - 0.5).ravel()[order]
    screen_y = ((y + 0.5) / width - 0.5 * height / width).ravel()[order]
    forward = unit(np.array([0.0, 0.0, -0.1]) - EYE)
    right = unit(np.cross(forward, [0, 0, 1]))
    up = np.cross(right, forward)
    directions = unit(forward + 1.1 * (screen_x[:, None] * right + screen_y[:, None] * up))
    return np.broadcast_to(EYE, directions.shape).copy(), directions


def leaving(hits: dict[str, Any], directions: Doubles) -> Doubles:
    """Origins of rays that leave the hit points, far enough for Embree's single precision too."""
    facet = hits["facet_normal"].astype(np.float64)
    side = np.where(np.sum(directions * facet, axis=1) < 0, -1.0, 1.0)
    return hits["facet_position"] + facet * (side * LEAVING_OFFSET)[:, None]


def ray_sets(tracer: Any) -> dict[str, tuple[Doubles, Doubles]]:
    """Camera rays, and the mirror and hemisphere rays that leave their hits."""
    origins, directions = camera_rays()
    hits = tracer.closest_hits(origins, directions)
    hit = hits["instance"] >= 0
    hits = {key: value[hit] for key, value in hits.items()}
    seen = directions[hit]
    normal = hits["normal"].astype(np.float64)
    normal *= -np.sign(np.sum(normal * seen, axis=1))[:, None]
    mirrored = unit(seen - 2 * np.sum(seen * normal, axis=1)[:, None] * normal)
    random = np.random.default_rng(3)
    scattered = unit(normal + unit(random.normal(size=normal.shape)))
    return {
        "camera": (origins, directions),
        "mirror": (leaving(hits, mirrored), mirrored),
        "hemisphere": (leaving(hits, scattered), scattered),
    }


def check(expected: Doubles, got: Doubles, name: str) -> None:
    """The methods see the same surface, but for rays that graze a facet's edge or start on one."""
    same = np.isclose(expected, got, rtol=1e-4, atol=1e-4) | (np.isinf(expected) & np.isinf(got))
    assert same.mean() > 0.995, f"{name}: {np.sum(~same)} of {len(same)} rays differ"


def run() -> list[dict[str, Any]]:
    """Rows of rays per second, and what each method holds."""
    rows = []
    for size, resolution in SIZES.items():
        surface = scene(resolution)
        tracer = _core.trace.Tracer([(surface, np.eye(4), 31)], eye=list(EYE))
        statistics = tracer.statistics()
        subpatches = statistics["subpatches"]
        methods = {"rayleaf": tracer, "embree grid": rayleaf_rivals.EmbreeBaseline(surface, "GRID", eye=list(EYE))}
        if subpatches <= MOST_SUBPATCHES_AS_TRIANGLES:
            methods["embree triangle"] = rayleaf_rivals.EmbreeBaseline(surface, "TRIANGLE", eye=list(EYE))
        for kind, (origins, directions) in ray_sets(tracer).items():
            _, expected = tracer.timed_closest(origins, directions)
            times: dict[str, list[float]] = {method: [] for method in methods}
            for repeat in range(REPEATS + 1):  # interleaved, so that a busy machine slows all; the first one warms up
                for method, target in methods.items():
                    seconds, t = target.timed_closest(origins, directions)
                    if repeat == 0:
                        check(expected, t, f"{size} {kind} {method}")
                    else:
                        times[method].append(len(origins) / seconds / 1e6)
            for method, values in times.items():
                rows.append({"name": f"{subpatches} subpatches, {kind}: {method}", "unit": "Mrays/s", "values": values})
        held = {"rayleaf": tracer.statistics()["geometry_cache"]["bytes"] + statistics["bvh_bytes"]}
        held |= {method: target.bytes for method, target in methods.items() if method != "rayleaf"}
        for method, count in held.items():
            rows.append({"name": f"{subpatches} subpatches: {method}", "unit": "MB", "values": [count / 1e6]})
    return rows
