"""What is kept from one render to the next: the same pictures, and nothing built twice."""

import os
import tempfile
from pathlib import Path

import numpy as np
import pytest
import scenes
from path_scenes import material

from rayleaf import _core


def checkered(scene, seed):
    """A texture in the world: noise of a seed."""
    pixels = np.random.default_rng(seed).uniform(0, 2, (16, 32, 3)).astype(np.float32)
    texture = scene.add_image_pixels("noise", pixels, "LINEAR")
    program = _core.Program("world")
    one = program.constant(1, 1, 1, 1)
    seen = program.operation("environment", [program.operation("generated")], ints=[texture, 0, 0])
    program.operation("background", [one, seen, one])
    return program


def make(parts=None, height=6.0, place=0.0, color=0.5, seed=1, mesh=1.0, interpolation=None):
    """A surface, a mesh and hair-free ground under a textured sky."""
    scene = _core.SceneDescription(parts)
    cube = scene.add_mesh("cube", np.float32(scenes.CUBE_VERTICES) * np.float32(mesh), scenes.CUBE_TRIANGLES)
    ball = scene.add_surface("ball", [scenes.sphere_spline(_core)])
    scene.add_instance("cube", cube, scenes.matrix((1.5, 0, 0), 0.7), material(_core, scene, ("diffuse", 1.0, color)))
    glass = material(_core, scene, ("glass", 1.0, 1.0, 0.0, 1.45, "SHARP"))
    scene.add_instance("ball", ball, scenes.matrix((place, 0, 0)), glass)
    scene.set_world(checkered(scene, seed), 64)
    scenes.look_down(scene, height, 0.6)
    # A picture of so few pixels would ask for the coarsest facets from everywhere.
    scenes.look_down(scene, height, 1e-3, dicing=True)
    return scene


def render(scene, **settings):
    session = _core.Session(scene, _core.Settings(width=16, height=16, samples=4, **settings))
    assert session.render()
    return session.pass_pixels("combined"), session.statistics()["geometry"]["kept_shapes"]


EDITS = {
    "nothing": ({}, 2),
    "a camera that comes nearer": ({"height": 3.0}, 1),  # the mesh is not diced
    "a camera that moves a little": ({"height": 6.01}, 2),
    "an object that moves a little": ({"place": -0.01}, 2),
    "an object that moves far": ({"place": -12.0}, 1),
    "a material": ({"color": 0.9}, 2),
    "an image": ({"seed": 2}, 2),
    "a mesh": ({"mesh": 0.5}, 1),
}


@pytest.mark.parametrize("edit", EDITS)
def test_after_an_edit_the_picture_is_that_of_a_fresh_scene_and_the_rest_is_kept(edit):
    change, kept = EDITS[edit]
    parts = _core.SceneParts()
    assert render(make(parts))[1] == 0
    edited, found = render(make(parts, **change))
    np.testing.assert_array_equal(edited, render(make(**change))[0])
    assert found == kept
    back, found = render(make(parts))  # an undo finds what there was
    np.testing.assert_array_equal(back, render(make())[0])
    assert found == 2


@pytest.mark.parametrize("megabytes", [0.0, 1e-4])
def test_facets_beyond_the_budget_are_not_kept(megabytes):
    parts = _core.SceneParts()
    for _ in range(2):
        picture, kept = render(make(parts), resident_megabytes=megabytes)
        np.testing.assert_array_equal(picture, render(make(), resident_megabytes=megabytes)[0])
    assert kept == 1  # the mesh
    assert render(make(parts))[1] == 1  # more memory: the surface's facets are made
    picture, kept = render(make(parts), resident_megabytes=megabytes)  # less again
    np.testing.assert_array_equal(picture, render(make(), resident_megabytes=megabytes)[0])
    assert kept == 1


def test_what_two_renders_did_not_use_is_dropped():
    parts = _core.SceneParts()
    render(make(parts))
    for mesh in (0.5, 0.6, 0.7):
        render(make(parts, mesh=mesh, place=24 * mesh))
    assert render(make(parts))[1] == 0


@pytest.mark.slow
@pytest.mark.parametrize("side", [2048, 512])  # by all threads when the scene is rendered, or while it is described
def test_an_image_is_converted_once(side):
    parts = _core.SceneParts()
    pixels = np.random.default_rng(3).uniform(0, 1, (side, side, 4)).astype(np.float32)

    def rendered(*spaces):
        scene = make(parts)
        for space in spaces:
            scene.add_image_pixels("large", pixels, space)
        render(scene)
        return scene

    first = rendered("SRGB")
    before = converted_files()
    second = rendered("SRGB")
    assert converted_files() == before
    third = rendered("SRGB", "NON_COLOR")
    assert converted_files() == before + 1
    del first, second, third, parts
    assert converted_files() == before - 2  # the sky's too


def converted_files():
    """Files of textures that this process holds."""
    folders = Path(tempfile.gettempdir()).glob(f"rayleaf_textures_{os.getpid()}_*")
    return sum(len(list(folder.iterdir())) for folder in folders)
