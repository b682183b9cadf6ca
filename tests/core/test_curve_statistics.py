"""The statistics name the curves and the hair of a scene."""

import numpy as np
from core import scenes
from core import swept_support as swept


def statistics_of(core, *shapes):
    scene = core.SceneDescription()
    for number, shape in enumerate(shapes):
        index = scene.add_curve(shape) if isinstance(shape, core.SweptCurve) else scene.add_shape(shape)
        for copy in range(2):
            scene.add_instance(f"{number}.{copy}", index, scenes.matrix())
    scenes.look_down(scene)
    session = core.Session(scene, core.Settings(width=4, height=4, samples=1))
    session.render()
    return session.statistics()["curves"]


def test_bevelled_curves_and_hair_are_counted_once_however_many_instances(core):
    lines = swept.splines("POLY", np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 0, 1], [1, 0, 1]]), counts=[3, 2])
    curve = core.SweptCurve("wire", [lines], bevel_depth=0.1)
    points = np.random.default_rng(3).normal(size=(12, 3))
    hair = core.Strands("hair", points, np.full(12, 0.01, np.float32), np.array([0, 4, 8, 12], np.int32))
    told = statistics_of(core, curve, hair, hair)
    assert told["swept"].pop("bytes") > 0 and told["hair"].pop("bytes") >= points.nbytes / 2
    assert told == {
        "swept": {"surfaces": 1, "splines": 2, "pieces": 3},  # legs
        "hair": {"objects": 1, "strands": 3, "segments": 9},
    }


def test_a_scene_without_curves_tells_of_none(core):
    assert statistics_of(core) == {}
