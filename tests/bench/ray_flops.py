"""Floating-point operations of a frame, counted: additions, subtractions, multiplications, divisions, square roots.

Tracing is counted by a plain tree over the same boxes (core/trace/counting_scene.h, which lists its kernels), for one ray
in SAMPLED of those asked; what fills a tree, by the corner and centre rays of cells that answer. Asking a tree is counted
by the kernels below.
"""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
import rayleaf_rivals
from ray_frames import Answers, Rays, Trees
from ray_scenes import Scene
from rayleaf import _core

SAMPLED = 16
CELLS = 300  # whose corners stand for all samples

# Kernels of a query. The published tree (core/ri_tree/line_space.cpp, corner_weights.cpp, output_ray.cpp):
BOX = 15  # three inverses, six distances
LINE = 23  # two slopes, two intercepts, four shares of the root cell
LEVEL = 2  # which half of a cell
PLACE = 8  # where in the cell
WEIGHTS = 32  # products of four lengths and their complements
BLEND = 31  # an attribute: sixteen products, fifteen sums
UNIT = 10  # a vector's length made one
MIRROR = 11
# The fast tree's (core/ri_tree/line_batch.cpp, cell_leaf.h): its search is of integers.
FAST_PLACE = 12  # a subtraction, product and difference an axis
FAST_TERMS = 34  # products and squares of four numbers
FAST_VALUE = 70  # thirty-five products and sums
FAST_UNFOLD = 6  # the third component of a unit vector
FAST_POSITION = 10  # from the depth along the line
FAST_VALUES = {"SIMPLE": 5, "MIRROR": 3, "GLASS": 8, "VOLUME": 1}
# What a hit of its samples costs beyond tracing: second derivatives of a bicubic patch, changes of four lines.
FAST_CHANGES = 430
HITS = {"SIMPLE": 1, "MIRROR": 1, "GLASS": 3, "VOLUME": 2}

ATTRIBUTES = {"SIMPLE": 8, "MIRROR": 6, "GLASS": 12, "VOLUME": 1}
UNITS = {"SIMPLE": 1, "MIRROR": 1, "GLASS": 2, "VOLUME": 0}

ANSWERS: list[str] = _core.ri_tree.ANSWERS
INTERPOLATED = [i for i, name in enumerate(ANSWERS) if "interpolated" in name]
# What is followed through convex bodies counts as traced: it takes fewer.
TRACED = [i for i, name in enumerate(ANSWERS) if name.startswith(("traced", "followed", "two classes"))]
BESIDE = [ANSWERS.index("box missed"), ANSWERS.index("not a ray")]


@dataclass
class Counters:
    """Rays against all of a scene's objects, by what traces them."""

    triangles: Any
    newton: Any

    @classmethod
    def of(cls, scene: Scene) -> "Counters":
        """For a scene."""
        objects = [(each.surface, each.kind, each.ior) for each in scene.objects]
        hits = scene.interior_hits
        tracers = [
            rayleaf_rivals.RivalTracer(objects, method, most_interior_hits=hits) for method in ("TRIANGLES", "NEWTON")
        ]
        return cls(*(rayleaf_rivals.FlopCounter(tracer) for tracer in tracers))


@dataclass
class Account:
    """Operations of a frame: traced alone, and asked of trees; [by triangles, by Newton]."""

    scene: Scene
    counters: Counters
    tracing: Any = field(default_factory=lambda: np.zeros(2))
    uninterpolated: Any = field(default_factory=lambda: np.zeros(2))
    asking: float = 0.0
    depth: float = 20.0
    fast: bool = False

    def __call__(self, rays: Rays, answers: Answers) -> None:
        """Takes a batch into account."""
        chosen = slice(None, None, SAMPLED)
        origins, directions = rays.origins[chosen], rays.directions[chosen]
        by, objects = answers["answered_by"][chosen], answers["object"][chosen]
        traced = np.isin(by, TRACED)
        for i, counter in enumerate((self.counters.triangles, self.counters.newton)):
            flops = counter.count(origins, directions)
            self.tracing[i] += SAMPLED * flops.sum()
            self.uninterpolated[i] += SAMPLED * flops[traced].sum()
        self.asking += SAMPLED * BOX * len(by)
        search = 0.0 if self.fast else LEVEL * self.depth
        self.asking += SAMPLED * (LINE + search) * np.count_nonzero(~np.isin(by, BESIDE))
        for index, each in enumerate(self.scene.objects):
            blended = np.count_nonzero(np.isin(by, INTERPOLATED) & (objects == index))
            self.asking += SAMPLED * blended * (self.blend_flops(each.kind) + (MIRROR if each.kind == "MIRROR" else 0))

    def blend_flops(self, kind: str) -> int:
        """Of one answer, once its cell is found."""
        if self.fast:
            vectors = FAST_UNFOLD * UNITS[kind] + (FAST_POSITION if kind != "VOLUME" else 0)
            return FAST_PLACE + FAST_TERMS + FAST_VALUE * FAST_VALUES[kind] + vectors
        return PLACE + WEIGHTS + BLEND * ATTRIBUTES[kind] + UNIT * UNITS[kind]

    def speed_up(self, samples: int, sample: Any) -> Any:
        """Operations of tracing over those with trees that took so many samples."""
        changes = FAST_CHANGES * np.mean([HITS[each.kind] for each in self.scene.objects]) if self.fast else 0.0
        return self.tracing / (self.asking + self.uninterpolated + samples * (sample + changes))


def sample_flops(scene: Scene, trees: Trees, counters: Counters, rays: Rays) -> tuple[Any, float]:
    """Mean operations of a sample, and the mean depth of cells, told from those that answer some of the rays."""
    random = np.random.default_rng(5)
    chosen = random.choice(len(rays.origins), min(CELLS * 4, len(rays.origins)), replace=False)
    origins, directions, depths = [], [], []
    for each, tree in zip(scene.objects, trees.trees):
        center, scale = each.surface.frame
        found = tree.final_cells(rays.origins[chosen], rays.directions[chosen])
        for direction, depth, index in sorted({(cell[0], cell[1], tuple(cell[2])) for cell in found if cell})[:CELLS]:
            depths.append(depth)
            for pair in (tree.corner_rays((direction, depth, index)), tree.center_ray((direction, depth, index))):
                origins.append(pair[0] * scale + np.asarray(center))
                directions.append(pair[1])
    if not depths:
        return np.zeros(2), 0.0
    start, towards = np.concatenate(origins), np.concatenate(directions)
    means = [counter.count(start, towards).mean() for counter in (counters.triangles, counters.newton)]
    return np.array(means), float(np.mean(depths))
