"""Rays of the geometry cache's benchmark, with the widths that they have in a picture."""

from typing import Any

import bench_trace
import numpy as np
from numpy.typing import NDArray
from rayleaf import _core

Doubles = NDArray[np.float64]
Rays = dict[str, Any]

HEMISPHERE_RAYS = 64
HEMISPHERE_EVERY = 16  # hits: a sixteenth of the pixels


def joined(sets: list[Rays]) -> Rays:
    """All rays of several sets, one set after the other."""
    return {key: np.concatenate([each[key] for each in sets]) for key in sets[0]}


def rays_of(origins: Doubles, directions: Doubles, width: Any, spread: Any, starts: Any = None) -> Rays:
    """Rays with their widths; one number may stand for all."""
    count = len(origins)
    none = np.full((count, 4), 2**32 - 1, np.uint32)
    return {
        "origins": origins,
        "directions": directions,
        "width": np.broadcast_to(np.float32(width), count).copy(),
        "spread": np.broadcast_to(np.float32(spread), count).copy(),
        "starts": none if starts is None else starts,
    }


def mixed_rays(tracer: Any, width: int) -> Rays:
    """Camera rays, mirror rays, hemisphere rays, of a picture 16 : 9 of so many pixels across."""
    origins, directions = bench_trace.camera_rays(width, width * 9 // 16)
    pixel = 1.1 / width
    camera = rays_of(origins, directions, 0.0, pixel)
    hits = tracer.closest_hits(**camera)
    hit = hits["instance"] >= 0
    hits = {key: value[hit] for key, value in hits.items()}
    seen, wide = directions[hit], (pixel * hits["t"]).astype(np.float32)
    normal = hits["normal"].astype(np.float64)
    normal *= -np.sign(np.sum(normal * seen, axis=1))[:, None]
    mirrored = bench_trace.unit(seen - 2 * np.sum(seen * normal, axis=1)[:, None] * normal)
    # The normal turns by about the curvature times the width: lumps of a fifth of a unit.
    mirror = rays_of(bench_trace.leaving(hits, mirrored), mirrored, wide, pixel + 10 * wide, hits["anchors"])
    random = np.random.default_rng(3)
    chosen = np.repeat(np.arange(0, len(seen), HEMISPHERE_EVERY), HEMISPHERE_RAYS)
    few = {key: value[chosen] for key, value in hits.items()}
    scattered = bench_trace.unit(normal[chosen] + bench_trace.unit(random.normal(size=(len(chosen), 3))))
    cosine = np.maximum(np.sum(scattered * normal[chosen], axis=1), 0.05)
    share = np.minimum(np.sqrt(np.pi / (HEMISPHERE_RAYS * cosine)), 1.0)
    around = rays_of(bench_trace.leaving(few, scattered), scattered, wide[chosen], share, few["anchors"])
    return joined([camera, mirror, around])


def hills(surface: Any, scale: float, height: float) -> Any:
    """The surface displaced along its normal by noise: what a vertex costs then is the material's program."""
    program = _core.Program("displacement")

    def number(value: float) -> Any:
        return program.constant(value, value, value, value)

    operands = [program.operation("object_coordinates"), number(0), number(scale), number(1), number(0.5), number(0)]
    level = program.operation("component", [program.operation("noise", operands, ints=[3])], ints=[3])
    middle = program.operation("math", [level, number(0.5)], ints=[0], text="SUBTRACT")
    amount = program.operation("math", [middle, number(height)], ints=[0], text="MULTIPLY")
    normal = program.operation("object_normal")
    return _core.displaced(surface, program, object=program.operation("vector_math", [normal, amount], text="MULTIPLY"))


def offset(surface: Any, height: float) -> Any:
    """The surface moved evenly along its normal: about the cheapest displacement, its point and normal and a product."""
    program = _core.Program("displacement")
    amount = program.constant(height, height, height, height)
    normal = program.operation("object_normal")
    return _core.displaced(surface, program, object=program.operation("vector_math", [normal, amount], text="MULTIPLY"))


def cracks_in_shells(count: int, displaced: bool) -> int:
    """How many of so many rays of all widths find crossings that no closed shell has."""
    random = np.random.default_rng(5)
    torus = bench_trace.torus(np.zeros(3), 0.7, 16, 24, random)
    closed = bench_trace.CUBIC_CLOSED
    surface = _core.trace.PatchSurface("shell", [(torus, closed, closed, True, 0)])
    shell = hills(surface, 6.0, 0.08) if displaced else surface
    tracer = _core.trace.Tracer([(shell, np.eye(4), 31)])
    found, block = 0, 100_000
    for _ in range(count // block):
        origins = 5 * bench_trace.unit(random.normal(size=(block, 3)))
        directions = bench_trace.unit(random.uniform(-0.9, 0.9, (block, 3)) - origins)
        width, spread = ((10 ** random.uniform(-6, 0, block)).astype(np.float32) for _ in range(2))
        found += int(_core.trace.cracks(tracer, origins, directions, width, spread, inside=False).sum())
    return found
