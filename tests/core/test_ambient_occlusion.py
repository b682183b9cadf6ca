"""Ambient occlusion as a pass, against closed forms."""

import numpy as np
import pytest
from path_scenes import lit_plane, material, render, veil
from scenes import background, look_down, matrix, quad


def occlusion(core, scene, **settings):
    return render(core, scene, passes=["combined", "ambient_occlusion"], **settings).pass_pixels("ambient_occlusion")


def plane_below_a_disk(core, height=1.0, half=1.0):
    """The plane's middle below a square that hides part of the sky; the camera looks past it from the side."""
    scene = core.SceneDescription()
    grey = material(core, scene, ("diffuse", 1.0, 0.5))
    scene.add_instance("plane", quad(scene, "plane", 20), matrix(), grey)
    scene.add_instance("roof", quad(scene, "roof", half), matrix((0, 0, height)), grey, visibility=30)
    look_down(scene, half=0.002)
    return scene


def square_form_factor(half, height):
    """Share of the cosine-weighted hemisphere of a point that a square straight above it hides."""
    a = half / height
    return 4 * 2 / (2 * np.pi) * a / np.hypot(1, a) * np.arctan(a / np.hypot(1, a))


def test_a_free_plane_is_not_occluded_and_nothing_is_where_nothing_is_hit(core):
    assert np.all(occlusion(core, lit_plane(core), samples=4) == 1.0)
    scene = core.SceneDescription()
    scene.set_world(background(core))
    look_down(scene)
    assert np.all(occlusion(core, scene, samples=4) == 0.0)


def test_a_square_above_hides_its_form_factor(core):
    values = occlusion(core, plane_below_a_disk(core), samples=256)
    # 16384 rays, stratified within each pixel.
    assert values.mean() == pytest.approx(1 - square_form_factor(1.0, 1.0), abs=0.01)


def test_what_is_farther_than_the_occlusion_distance_hides_nothing(core):
    scene = plane_below_a_disk(core)
    assert np.all(occlusion(core, scene, samples=16, occlusion_distance=0.99) == 1.0)
    near = occlusion(core, scene, samples=256, occlusion_distance=1.2).mean()
    # Only the part of the square within 1.2 counts: the disk of tangent sqrt(0.44) about the normal.
    assert near == pytest.approx(1 - 0.44 / 1.44, abs=0.01)


def test_transparent_surfaces_colour_the_occlusion(core):
    scene = lit_plane(core)
    pane = veil(core, scene, (0.9, 0.5, 0.2))
    scene.add_instance("pane", quad(scene, "pane", 1000), matrix((0, 0, 1)), pane, visibility=30)
    values = occlusion(core, scene, samples=16)
    assert values.mean((0, 1)) == pytest.approx([0.9, 0.5, 0.2], abs=0.01)
    assert np.all(occlusion(core, scene, samples=1, transparent_bounces=0) == 0.0)
