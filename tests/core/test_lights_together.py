"""Lights that are chosen together are those that are chosen one by one, bit by bit."""

import numpy as np
import pytest
from light_support import NORMAL, POSITION, random_numbers
from path_scenes import uneven_world
from rayleaf import _core as core
from scenes import look_down, matrix, quad, sphere_spline

PARTS = ("direction", "distance", "radiance", "density", "delta")
SWING = np.stack([matrix((x, 2, 1)) for x in (-2, -1)])


def glow(name):
    """A program that emits noise, the brighter the farther away it is seen."""
    program = core.Program(name)
    numbers = [program.constant(*[x] * 4) for x in (0, 3, 2, 0.5, 0)]
    noise = program.operation("noise", [program.operation("position"), *numbers], [3])
    length = program.operation("light_path", text="ray_length")
    program.operation("emission", [program.constant(1, 1, 1, 1), noise, length])
    return program


def materials(scene, name):
    return scene.add_material_list([scene.add_material(name, glow(name))])


def lamps(scene, count=3):
    for i in range(count):
        scene.add_lamp(
            f"lamp {i}",
            "POINT",
            matrix((i - 1, 1, 2)),
            strength=(100,) * 3,
            radius=0.1,
            emission=glow(f"lamp {i}"),
        )
    scene.add_lamp("plain", "RECTANGLE", matrix((0, -2, 2)), strength=(30,) * 3, size_x=1.0, size_y=0.5)
    scene.add_lamp("sun", "SUN", matrix(), strength=(2,) * 3, angle=0.1, emission=glow("sun"))


def meshes(scene):
    scene.add_instance("near", quad(scene, "near", 0.5, 2.0), matrix(), materials(scene, "near"))
    scene.add_instance(
        "moving", quad(scene, "moving", 0.5), matrix((-2, 2, 1)), materials(scene, "moving"), motion=SWING
    )


def splines(scene):
    ball = scene.add_surface("ball", [sphere_spline(core)])
    scene.add_instance("ball", ball, matrix((1, 1, 2), 0.5), materials(scene, "ball"))


def world(scene):
    scene.set_world(uneven_world(core), 32)


KINDS = {
    "lamps": (lamps,),
    "meshes": (meshes,),
    "splines": (splines,),
    "world": (world,),
    "all": (lamps, meshes, splines, world),
}


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("normal", [None, NORMAL], ids=["medium", "surface"])
def test_lights_chosen_together_are_those_chosen_one_by_one(kind, normal):
    scene = core.SceneDescription()
    look_down(scene)
    for add in KINDS[kind]:
        add(scene)
    probe = core.LightProbe(scene)
    numbers = random_numbers(150)  # more than go together
    together = probe.sample(POSITION, numbers, normal=normal)
    alone = [probe.sample(POSITION, numbers[i : i + 1], normal=normal) for i in range(len(numbers))]
    assert (together["density"] > 0).mean() > 0.5
    for part in PARTS:
        np.testing.assert_array_equal(together[part], np.concatenate([each[part] for each in alone]))
