"""Surfaces of bevelled curves that are made in the background."""

import gc

import numpy as np
import pytest
from core.swept_support import curve
from rayleaf import _core

POINTS = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (2, 1, 1)]
ORIGINS, DOWN = np.array([[0.5, 0, 3.0], [1, 0.5, 3], [0.5, 0.05, 3]]), np.tile([0.0, 0, -1], (3, 1))


def tube(**options):
    return curve("POLY", POINTS, bevel_depth=0.1, **options)


def distances(shape):
    return _core.trace.Tracer([(shape, np.eye(4), 31)], pixel_angle=1e-3).closest_hits(ORIGINS, DOWN)["t"]


def test_the_surface_is_the_same_from_the_background():
    begun = tube()
    begun.begin()
    assert np.array_equal(distances(_core.trace.SweptSurface(begun)), distances(_core.trace.SweptSurface(tube())))


def test_scenes_do_not_share_a_surface():
    begun, scenes = tube(), [_core.SceneDescription() for _ in range(2)]
    begun.begin()
    for scene in scenes:
        scene.add_curve(begun)
    scenes[0].set_texture_space(0, (0, 0, 0), (1, 1, 1))
    assert scenes[0].shape(0) is not scenes[1].shape(0)


def test_an_error_from_the_background_arrives_where_the_surface_is_asked_for():
    # So large that only the whole surface shows it.
    begun = curve("POLY", np.array(POINTS) * 1e99, radii=np.full(4, 1e99), bevel_depth=1e99)
    begun.begin()
    for _ in range(2):
        with pytest.raises(_core.InputError, match="too large"):
            _core.SceneDescription().add_curve(begun)


def test_curves_may_be_forgotten_while_they_are_made():
    for _ in range(200):
        begun = tube(bevel_resolution=30)
        begun.begin()
        begun.begin()
        del begun
    gc.collect()
    assert _core.SceneDescription().add_curve(tube()) == 0
