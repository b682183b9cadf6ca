"""One curve rendered as every primitive that can stand for it, beside the exact tube: cost and error of each.

The curve is a spiral of cubic Bezier segments with a round bevel, matte under a lamp, as in the table of the source
on Bezier primitives. Knows no bpy: it goes straight to the core.
"""

import time
from collections.abc import Callable
from dataclasses import dataclass
from statistics import median
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rayleaf import _core

from . import page
from .errors import PictureError, compare, silhouette_error
from .source_figures import BEZ_TABLE_3_4_1

Doubles = NDArray[np.float64]

RADIUS = 0.03
TURNS = 6
SEGMENTS = 48
DETAIL = 16  # sides of a tube of facets; half as many rings a segment, twice as many balls
# Which of the source's primitives ours stands beside.
_SOURCE = {
    "chain of balls": "Bezier curve as spheres",
    "tube of triangles": "Bezier curve as triangles",
    "tube of quads": "Bezier curve as quadrilaterals",
    "swept patch": "Bezier surface",
}


def spiral(segments: int) -> tuple[Doubles, Doubles]:
    """Points and handles of a spiral of Bezier segments that fills the unit cube."""
    angle = np.linspace(0.0, 2.0 * np.pi * TURNS, segments + 1)
    share = angle / angle[-1]
    ring = 0.15 + 0.3 * share
    points = np.stack([ring * np.cos(angle), ring * np.sin(angle), share - 0.5], axis=1)
    slope = np.stack(
        [
            0.3 / angle[-1] * np.cos(angle) - ring * np.sin(angle),
            0.3 / angle[-1] * np.sin(angle) + ring * np.cos(angle),
            np.full(len(angle), 1.0 / angle[-1]),
        ],
        axis=1,
    )
    reach = slope * (angle[1] / 3.0)
    return points, np.stack([points - reach, points + reach], axis=1)


def curve(segments: int) -> Any:
    """The spiral as the core's description of a bevelled curve."""
    points, handles = spiral(segments)
    weighted = np.hstack([points, np.ones((len(points), 1))])
    splines = _core.CurveSplines("BEZIER", np.array([len(points)], np.int32), weighted, handles=handles)
    return _core.SweptCurve("spiral", [splines], bevel_depth=RADIUS)


def primitives() -> dict[str, Callable[[], Any]]:
    """What makes the shape of each type; the first is the exact tube."""
    bevelled = curve(SEGMENTS)

    def tube(facets: str) -> Any:
        strands = _core.strands_along(bevelled, "ROUND")
        assert strands is not None, "the spiral's bevel is round"
        return _core.strand_tubes(strands, DETAIL // 2, DETAIL, facets)

    return {
        "exact tube": lambda: _core.strands_along(bevelled, "ROUND"),
        "chain of balls": lambda: _core.strands_along(bevelled, "SPHERES", 2 * DETAIL),
        "tube of triangles": lambda: tube("TRIANGLES"),
        "tube of quads": lambda: tube("QUADS"),
        "ribbon": lambda: _core.strands_along(bevelled, "RIBBON"),
        "Embree's round curve": lambda: _core.strands_along(bevelled, "EMBREE_ROUND"),
        "swept patch": lambda: _core.trace.SweptSurface(bevelled),
    }


def _pose(eye: tuple[float, float, float], target: tuple[float, float, float]) -> Doubles:
    """A matrix that looks from a point at another along its -z, its y upwards."""
    back = np.subtract(eye, target)
    back = back / np.linalg.norm(back)
    right = np.cross((0.0, 0.0, 1.0), back)
    right /= np.linalg.norm(right)
    matrix = np.eye(4)
    matrix[:3] = np.column_stack([right, np.cross(back, right), back, eye])
    return matrix


def _scene(shape: Any | None) -> Any:
    """The curve above a ground, under a lamp; without a shape, what stays."""
    scene = _core.SceneDescription()

    def matte(name: str, red: float, green: float, blue: float) -> int:
        program = _core.Program(name)
        program.operation("diffuse", [program.constant(1, 1, 1, 1), program.constant(red, green, blue, 1)])
        return int(scene.add_material_list([scene.add_material(name, program)]))

    corners = np.array([(-4, -4, -0.6), (4, -4, -0.6), (4, 4, -0.6), (-4, 4, -0.6)], np.float32)
    ground = scene.add_mesh("ground", corners, np.array([(0, 1, 2), (0, 2, 3)], np.int32))
    scene.add_instance("ground", ground, np.eye(4), matte("blue", 0.07, 0.16, 0.5))
    if shape is not None:
        scene.add_instance("spiral", scene.add_shape(shape), np.eye(4), matte("green", 0.13, 0.55, 0.12))
    lamp = _pose((-1.6, -1.8, 2.6), (0, 0, 0))
    scene.add_lamp("lamp", "POINT", lamp, strength=(260, 250, 235), radius=0.15)
    scene.set_camera("PERSPECTIVE", _pose((0.6, -2.6, 0.9), (0, 0, -0.03)), (-0.24, -0.24), (0.24, 0.24), 0.01, 100)
    return scene


@dataclass
class Rendered:
    """One primitive's picture and what it cost."""

    name: str
    build: float  # seconds: shape, dicing plan and tree
    render: float  # seconds
    memory: int  # bytes above those of the scene without the curve
    picture: Any
    coverage: Any  # (height, width): how much of each pixel the curve covers


def _memory(statistics: dict[str, Any]) -> int:
    return sum(statistics["memory"][name] for name in ("shapes", "facets", "grids", "subpatches", "acceleration"))


def rendered(name: str, make: Callable[[], Any] | None, width: int, samples: int, repeats: int) -> Rendered:
    """Medians of so many renders with equal random numbers."""
    builds, renders = [], []
    for _ in range(repeats):
        began = time.perf_counter()
        shape = make() if make else None
        made = time.perf_counter() - began
        passes = ["combined", "position"]
        settings = _core.Settings(width=width, height=width, samples=samples, seed=1, passes=passes)
        session = _core.Session(_scene(shape), settings)
        session.render()
        statistics = session.statistics()
        builds.append(made + statistics["time"]["build_seconds"])
        renders.append(statistics["time"]["render_seconds"])
    # Positions are means over a pixel, and the ground lies in one plane.
    coverage = np.clip((session.pass_pixels("position")[..., 2] + 0.6) / 0.1, 0.0, 1.0)
    return Rendered(
        name, median(builds), median(renders), _memory(statistics), session.pass_pixels("combined"), coverage
    )


def measured(width: int, samples: int, repeats: int) -> list[tuple[Rendered, PictureError, float]]:
    """Each primitive with its picture's error and its outlines' distance, pixels; the exact tube comes first."""
    empty = rendered("", None, width, 1, 1)
    all_made = [rendered(name, make, width, samples, repeats) for name, make in primitives().items()]
    exact = all_made[0]
    for each in all_made:
        each.memory -= empty.memory
    return [
        (each, compare(each.picture, exact.picture), silhouette_error(each.coverage, exact.coverage))
        for each in all_made
    ]


def section(width: int, samples: int, repeats: int) -> str:
    """The part of the report."""
    results = measured(width, samples, repeats)
    times = {str(row[0]): row[1] for row in BEZ_TABLE_3_4_1.rows}
    head = (
        "primitive",
        "build, ms",
        "KiB",
        "render, s",
        "mean RGB",
        "99 %",
        "largest",
        "outline, pixels",
        "the source",
    )
    rows = [
        (each.name, 1e3 * each.build, each.memory / 1024, each.render, error.mean_rgb, error.p99, error.maximum, outline,
         times.get(_SOURCE.get(each.name, "")))
        for each, error, outline in results
    ]  # fmt: skip
    words = (
        f"A spiral of {SEGMENTS} cubic Bezier segments, {width} pixels wide, {samples} samples with equal random numbers. "
        f"Tubes have {DETAIL} sides and {DETAIL // 2} rings a segment, the chain {2 * DETAIL} balls. Errors are those of "
        "pictures against the exact tube's. The source's times are of its own scene, without an acceleration structure."
    )
    return page.section(
        "One curve, seven primitives",
        page.paragraph(words),
        page.table(head, rows),
        page.pictures(*(page.picture(each.picture, each.name) for each, _, _ in results)),
    )
