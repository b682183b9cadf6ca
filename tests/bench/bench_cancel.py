"""How soon a render ends that is cancelled: from the call until the render has returned, by what it is doing.

Each scene is long at one thing. It is run whole once, at most so long, and then cancelled at even times of that.
"""

import threading
import time
from collections.abc import Callable
from typing import Any

import numpy as np
from rayleaf import _core

LONGEST = 3.0  # seconds of a scene
MOMENTS = 8


def described() -> Any:
    """A scene with a camera above it, and light."""
    scene = _core.SceneDescription()
    above = np.eye(4)
    above[2, 3] = 5.0
    scene.set_camera("PERSPECTIVE", above, (-0.5, -0.5), (0.5, 0.5), 0.01, 1000.0)
    scene.add_lamp("sun", "SUN", np.eye(4), (2.0, 2.0, 2.0))
    return scene


def dust(count: int) -> tuple[Any, Any]:
    """Triangles at random."""
    corners = np.random.default_rng(1).uniform(-1, 1, (3 * count, 3)).astype(np.float32)
    return corners, np.arange(3 * count, dtype=np.int32).reshape(-1, 3)


def sheet(patches: int) -> Any:
    """A wavy NURBS surface."""
    u, v = np.meshgrid(*[np.linspace(-1, 1, patches + 3)] * 2)
    return _core.NurbsSpline(np.stack([u, v, 0.05 * np.sin(40 * u) * np.cos(30 * v), np.ones_like(u)], -1), 4, 4)


def triangles(size: float) -> tuple[Any, dict[str, Any]]:
    """Embree's tree."""
    scene = described()
    scene.add_instance("dust", scene.add_mesh("dust", *dust(int(2e6 * size))), np.eye(4))
    return scene, {}


def surfaces(size: float) -> tuple[Any, dict[str, Any]]:
    """Dicing, and our own tree."""
    scene = described()
    scene.add_instance("sheet", scene.add_surface("sheet", [sheet(int(200 * size**0.5))]), np.eye(4))
    return scene, {"width": 2000, "height": 2000}


def strands(size: float) -> tuple[Any, dict[str, Any]]:
    """Hair."""
    count = int(2e5 * size)
    roots = np.random.default_rng(2).uniform(-1, 1, (count, 1, 3))
    points = (roots + np.linspace(0, 0.3, 8)[None, :, None] * [0.2, 0.1, 1.0]).reshape(-1, 3)
    offsets = np.arange(count + 1, dtype=np.int32) * 8
    scene = described()
    hair = _core.Strands("hair", points, np.full(len(points), 0.001, np.float32), offsets)
    scene.add_instance("hair", scene.add_shape(hair), np.eye(4))
    return scene, {}


def lights(size: float) -> tuple[Any, dict[str, Any]]:
    """Triangles that glow by a noise, each of which is looked at."""
    program = _core.Program("embers")
    one, place = program.constant(1, 1, 1, 1), program.operation("object_coordinates")
    numbers = [program.constant(*[number] * 4) for number in (0, 5, 15, 0.5, 1)]
    program.operation("emission", [one, program.operation("noise", [place, *numbers], ints=[3]), one])
    scene = described()
    materials = scene.add_material_list([scene.add_material("embers", program)])
    scene.add_instance("embers", scene.add_mesh("embers", *dust(int(4e5 * size))), np.eye(4), materials)
    return scene, {}


def world(size: float) -> tuple[Any, dict[str, Any]]:
    """The table of a world that is a noise."""
    program = _core.Program("world")
    one, place = program.constant(1, 1, 1, 1), program.operation("object_coordinates")
    numbers = [program.constant(*[number] * 4) for number in (0, 5, 15, 0.5, 1)]
    program.operation("background", [one, program.operation("noise", [place, *numbers], ints=[3]), one])
    scene = described()
    scene.set_world(program, int(4096 * size**0.5))
    return scene, {}


def image(size: float) -> tuple[Any, dict[str, Any]]:
    """The conversion of a large picture, which a commit ends."""
    side = int(8192 * size**0.5)
    scene = described()
    pixels = np.random.default_rng(3).uniform(0, 1, (side, side, 3)).astype(np.float32)
    program = _core.Program("picture")
    one = program.constant(1, 1, 1, 1)
    place = program.operation("object_coordinates")
    number = scene.add_image_pixels("picture", pixels, "SRGB")
    program.operation("diffuse", [one, program.operation("image", [place], ints=[number, 0, 0, 0])])
    materials = scene.add_material_list([scene.add_material("picture", program)])
    scene.add_instance("sheet", scene.add_surface("sheet", [sheet(4)]), np.eye(4), materials)
    return scene, {"width": 64, "height": 64}


def rendering(_: float) -> tuple[Any, dict[str, Any]]:
    """Paths."""
    scene = described()
    scene.add_instance("sheet", scene.add_surface("sheet", [sheet(20)]), np.eye(4))
    return scene, {"width": 1000, "height": 1000, "samples": 100_000}


CASES: list[Callable[[float], tuple[Any, dict[str, Any]]]] = [
    *(triangles, surfaces, strands, lights, world, image, rendering),
]


def cancelled_after(made: tuple[Any, dict[str, Any]], seconds: float) -> tuple[float, float, bool]:
    """How long the render took, and how long it went on after it was told to stop, then; and whether it was stopped, not
    over before."""
    scene, settings = made
    session = _core.Session(scene, _core.Settings(**{"width": 8, "height": 8, "samples": 1, **settings}))
    results: list[bool] = []
    worker = threading.Thread(target=lambda: results.append(session.render()))
    began = time.perf_counter()
    worker.start()
    worker.join(seconds)
    told = time.perf_counter()
    session.cancel()
    worker.join()
    ended = time.perf_counter()
    return ended - began, ended - told, not results[0]


def run(quick: bool = False) -> list[dict[str, Any]]:
    """Milliseconds until the end, by what was being done."""
    size, moments = (0.01, 2) if quick else (1.0, MOMENTS)
    rows = []
    for case in CASES:
        whole = cancelled_after(case(size), 0.2 if quick else LONGEST)[0]
        found = [cancelled_after(case(size), whole * (k + 0.5) / moments)[1:] for k in range(moments)]
        values = [1000 * seconds for seconds, was_cancelled in found if was_cancelled]
        rows.append({"name": f"{case.__name__}: {case.__doc__}", "unit": "ms", "values": values or [0.0]})
    return rows
