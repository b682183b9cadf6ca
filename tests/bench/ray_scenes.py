"""The scenes of the ray cache's benchmark: surfaces with what they are made of, and where one looks from."""

import sys
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rayleaf import _core

sys.path.append(str(Path(__file__).resolve().parents[2] / "blend_scenes"))
import scene_shapes as shapes  # noqa: E402

Doubles = NDArray[np.float64]


@dataclass
class Object:
    """A surface and its kind. `transparency`: of a mirror, the share of light that passes straight on."""

    surface: Any
    kind: str
    ior: float = 1.45
    convex: bool = False
    transparency: float = 0.0
    color: tuple[float, float, float] = (1.0, 1.0, 1.0)


@dataclass
class Scene:
    """Objects, the point looked at, the eye's distance and height above the ground in degrees, the picture's width there."""

    name: str
    objects: list[Object]
    target: Doubles = field(default_factory=lambda: np.zeros(3))
    distance: float = 12.0
    rise: float = 35.0
    turn: float = 20.0
    width: float = 0.85  # of the picture, at distance 1
    rounds: int = 1  # how often rays are followed from object to object
    interior_hits: int = 8  # paths that hit glass more often from inside are cut off

    @property
    def lengths(self) -> bool:
        """Whether the length of rays inside all objects is wanted."""
        return self.objects[0].kind == "VOLUME"


def surface(name: str, *parts: shapes.Part) -> Any:
    """What the core makes of parts."""
    return _core.trace.PatchSurface(name, [(part.points, part.u, part.v, True, 0) for part in parts])


def mirror_sheet() -> Scene:
    """100 bicubic patches, smooth to the second derivative, 10 x 10 units."""
    return Scene("mirror sheet", [Object(surface("sheet", shapes.waved_sheet()), "MIRROR")])


def random_volumes(kind: str = "GLASS", seed: int = 1, count: int = 6) -> Scene:
    """Convex bodies of revolution in random cells."""
    bodies = shapes.random_volumes(seed, count)
    objects = [Object(surface(f"body {i}", body), kind, convex=True) for i, body in enumerate(bodies)]
    name = "random volumes, " + ("glass" if kind == "GLASS" else "path length")
    return Scene(name, objects, distance=10.5, rise=25.0)


def gentle_glass() -> Scene:
    """One body with a waist."""
    return Scene("gentle glass", [Object(surface("gentle", shapes.gentle_body()), "GLASS")], distance=7.0, rise=20.0)


def chaotic_glass() -> Scene:
    """A vase with a closed cavity: rays are followed through it."""
    vase = Object(surface("vase", *shapes.chaotic_vase()), "GLASS")
    return Scene("chaotic glass", [vase], distance=8.0, rise=15.0, rounds=4)


def tomatoes() -> Scene:
    """Tomatoes in a bowl under a wrap that reflects and is seen through; one beside it, on a table that reflects."""
    made = shapes.TomatoScene()
    red = (0.75, 0.09, 0.04)
    objects = [
        Object(surface("wrap", made.wrap), "MIRROR", transparency=0.8),
        Object(surface("bowl", made.bowl), "MIRROR", color=(0.85, 0.85, 0.9)),
        Object(surface("tomato", made.beside), "SIMPLE", color=red),
        Object(surface("table", made.table), "MIRROR", color=(0.45, 0.45, 0.5)),
    ]
    for i, part in enumerate(made.in_bowl):
        objects.append(Object(surface(f"tomato {i}", part), "SIMPLE", convex=True, color=red))
    return Scene("tomatoes", objects, np.array([0.5, -0.2, 0.7]), 10.5, 28.0, -75.0, 0.62, rounds=4)
