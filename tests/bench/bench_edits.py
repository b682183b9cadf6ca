"""What an edit of a large scene costs: the time until its first ray can be traced, beside that of the whole scene.

100,000 instances of 1,000 surfaces, a million subpatches, 200 materials. Each edit is made in a copy of the scene, which
is then committed: copy and change, and build. Edited pictures are checked against those of the scene made anew.
"""

import time
from typing import Any

import numpy as np
from rayleaf import _core

INSTANCES, SHAPES, MATERIALS, PATCHES = 100_000, 1_000, 200, 32  # patches along a side
QUICK = (1_000, 10, 20, 4)
ROUNDS = 5


def spline(seed: float, patches: int) -> Any:
    """A wavy sheet."""
    u, v = np.meshgrid(*[np.linspace(-1, 1, patches + 3)] * 2)
    return _core.NurbsSpline(np.stack([u, v, 0.1 * np.sin(3 * u + seed) * np.cos(2 * v), np.ones_like(u)], -1), 4, 4)


def program(red: float) -> Any:
    """A diffuse material."""
    made = _core.Program("material")
    made.operation("diffuse", [made.constant(1, 1, 1, 1), made.constant(red, 0.5, 0.5, 1)])
    return made


def shape(seed: float, patches: int) -> Any:
    """A sheet as scenes hold it."""
    scene = _core.SceneDescription()
    return scene.shape(scene.add_surface(f"sheet {seed}", [spline(seed, patches)]))


def places(count: int) -> Any:
    """On a lattice."""
    side, k = int(np.ceil(count**0.5)), np.arange(count)
    matrices = np.tile(np.eye(4), (count, 1, 1))
    matrices[:, 0, 3], matrices[:, 1, 3] = 3 * (k % side - side / 2), 3 * (k // side - side / 2)
    return matrices


def set_light(scene: Any, sun: float, sky: float) -> None:
    """A sun and a plain sky."""
    scene.clear_lamps()
    scene.add_lamp("sun", "SUN", np.eye(4), (sun, sun, sun))
    world = _core.Program("world")
    world.operation(
        "background", [world.constant(1, 1, 1, 1), world.constant(sky, sky, 1, 1), world.constant(1, 1, 1, 1)]
    )
    scene.set_world(world, 0)


def set_camera(scene: Any, x: float) -> None:
    """High above."""
    above = np.eye(4)
    above[:3, 3] = x, 0, 400
    scene.set_camera("PERSPECTIVE", above, (-0.5, -0.5), (0.5, 0.5), 0.1, 1e4)


def make(parts: Any, shapes: list[Any], count: int, materials: int) -> Any:
    """The whole scene."""
    scene = _core.SceneDescription(parts)
    for each in shapes:
        scene.add_shape(each)
    lists = [
        scene.add_material_list([scene.add_material(f"m{i}", program(0.2 + 0.5 * i / materials))])
        for i in range(materials)
    ]
    k, zeros = np.arange(count, dtype=np.int32), np.zeros(count, np.int32)
    names = [f"object {i}" for i in range(count)]
    rows = (k % len(shapes), places(count), np.int32(lists)[k % materials], zeros, np.float32(zeros), zeros + 31)
    scene.add_instances(names, *rows)
    set_light(scene, 2.0, 0.5)
    set_camera(scene, 0.0)
    return scene


def built(scene: Any) -> Any:
    """A session that has committed the scene."""
    session = _core.Session(scene, _core.Settings(width=64, height=36, samples=1))
    assert session.build()
    return session


def picture(session: Any) -> Any:
    """One sample a pixel."""
    assert session.render_more(1)
    return session.pass_pixels("combined")


def edits(patches: int) -> dict[str, Any]:
    """By name: what changes a scene, the number of the round given."""
    moved = np.eye(4)
    moved[2, 3] = 1.0

    def move(scene: Any, number: int) -> None:
        moved[0, 3] = 0.1 * number
        scene.place_instances(np.int32([number]), moved[None])

    others = [shape(0.3 + number, patches) for number in range(ROUNDS)]
    return {
        "camera moved a little": lambda scene, number: set_camera(scene, 0.05 * (number + 1)),
        "one material value": lambda scene, number: scene.replace_material(0, "m0", program(0.05 * number)),
        "one object moved": move,
        "control points of one surface": lambda scene, number: scene.replace_shape(0, others[number]),
        "lamp and world": lambda scene, number: set_light(scene, 1.0 + number, 0.2),
    }


def run(quick: bool = False) -> list[dict[str, Any]]:
    """Milliseconds of each edit."""
    count, shape_count, materials, patches = QUICK if quick else (INSTANCES, SHAPES, MATERIALS, PATCHES)
    shapes = [shape(float(i), patches) for i in range(shape_count)]
    scene = make(_core.SceneParts(), shapes, count, materials)
    began = time.perf_counter()
    session = built(scene)
    whole = time.perf_counter() - began
    rows = [{"name": "the whole scene, built", "unit": "ms", "values": [1000 * whole]}]
    for name, edit in edits(patches).items():
        milliseconds = []
        for number in range(ROUNDS):
            before, scene = scene, scene.copy()
            del session  # what it holds goes to the next
            began = time.perf_counter()
            edit(scene, number)
            session = built(scene)
            milliseconds.append(1000 * (time.perf_counter() - began))
            del before
        rows.append({"name": name, "unit": "ms", "values": milliseconds})
    check(session, scene)
    return rows


def check(session: Any, scene: Any) -> None:
    """An edited scene shows what one without anything kept does."""
    edited = picture(session)
    del session
    alone = _core.SceneDescription()
    assert not alone.shows_same_as(scene)
    again = scene.copy()
    np.testing.assert_array_equal(edited, picture(built(again)))
