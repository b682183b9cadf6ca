"""What is kept from one render to the next: the same pictures, and nothing built twice."""

import os
import tempfile
from pathlib import Path

import numpy as np
import pytest
import scenes
from core import swept_support as swept
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


def threads(parts=None, width=0.1, bend=0.3, depth=0.2, slot=0):
    """A strand and a bevelled curve."""
    scene = _core.SceneDescription(parts)
    points = [[-2, 0, 0.4], [-1, 0, bend], [1, 0, 0.1], [2, 0, 0.4]]
    strands = _core.Strands("hair", np.float64(points), np.float32([width] * 4), np.int32([0, 4]))
    curve = swept.curve("POLY", [[-2, 1, 0], [0, 1.3, 0], [2, 1, 0]], bevel_depth=depth, material_slot=slot)
    plain = material(_core, scene, ("diffuse", 1.0, 0.5))
    scene.add_instance("hair", scene.add_shape(strands), scenes.matrix(), plain)
    scene.add_instance("curve", scene.add_curve(curve), scenes.matrix(), plain)
    scene.set_world(checkered(scene, 1), 64)
    scenes.look_down(scene, 6.0, 0.6)
    return scene


@pytest.mark.parametrize(
    "change, kept", [({}, 2), ({"width": 0.2}, 1), ({"bend": -0.3}, 1), ({"depth": 0.3}, 1), ({"slot": 1}, 1)]
)
def test_hair_and_curves_are_known_by_their_content(change, kept):
    parts = _core.SceneParts()
    assert render(threads(parts))[1] == 0
    picture, found = render(threads(parts, **change))
    np.testing.assert_array_equal(picture, render(threads(**change))[0])
    assert found == kept


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


def rising(scene, height=0.2, image=None, reads_camera=False):
    """A displacement along z: so far, times an image, or where the camera sees the point."""
    program = _core.Program("rising")
    moved = program.constant(0, 0, height, 1)
    if image is not None:
        pixels = np.random.default_rng(image).uniform(0, 1, (8, 8, 3)).astype(np.float32)
        texture = scene.add_image_pixels("heights", pixels, "NON_COLOR")
        read = program.operation("image", [program.operation("uv", ints=[-1])], ints=[texture, 0, 0])
        moved = program.operation("vector_math", [moved, read], text="MULTIPLY")
    if reads_camera:
        seen = program.operation("component", [program.operation("camera_coordinates")], ints=[2])
        moved = program.operation("vector_math", [moved, seen], text="MULTIPLY")
    return program, moved, -1


def strands(parts=None):
    """A few hairs."""
    scene = _core.SceneDescription(parts)
    points = np.array([[x, y, z] for x in (-1, 0, 1) for y in (-1, 1) for z in (0, 1, 2)], np.float32)
    arrays = points, np.full(18, 0.2, np.float32), np.arange(0, 19, 3, dtype=np.int32)
    hair = scene.add_shape(_core.Strands("hair", *arrays))
    scene.add_instance("hair", hair, scenes.matrix(), material(_core, scene, ("diffuse", 1.0, 0.5)))
    scene.set_world(checkered(scene, 1), 64)
    scenes.look_down(scene, 6.0, 0.6)
    return scene


def hills(parts=None, place=0.0, camera=6.0, color=0.5, **displacement):
    """A displaced ball."""
    scene = _core.SceneDescription(parts)
    ball = scene.add_surface("ball", [scenes.sphere_spline(_core)])
    program = scenes.diffuse(_core, color=(color, color, color))
    rises = rising(scene, **displacement)
    scene.add_instance(
        "ball",
        ball,
        scenes.matrix((place, 0, 0)),
        scene.add_material_list([scene.add_material("hills", program, displacement=rises)]),
    )
    scene.set_world(checkered(scene, 1), 64)
    scenes.look_down(scene, camera, 0.6)
    scenes.look_down(scene, 6.0, 1e-3, dicing=True)
    return scene


DISPLACED_EDITS = {
    "nothing": ({}, {}, 1),
    "the camera": ({}, {"camera": 5.0}, 1),
    "the camera, which it reads": ({"reads_camera": True}, {"camera": 5.0}, 0),
    "its colour": ({}, {"color": 0.9}, 1),
    "its displacement": ({}, {"height": 0.3}, 0),
    "its place": ({}, {"place": 0.1}, 0),  # programs may read it
    "the image that it reads": ({"image": 1}, {"image": 2}, 0),
    "nothing of an image": ({"image": 1}, {}, 1),
}


@pytest.mark.slow
@pytest.mark.parametrize("edit", DISPLACED_EDITS)
def test_a_displaced_surface_is_kept_until_something_changes_that_it_is_made_of(edit):
    before, change, kept = DISPLACED_EDITS[edit]
    parts = _core.SceneParts()
    render(hills(parts, **before))
    edited, found = render(hills(parts, **{**before, **change}))
    np.testing.assert_array_equal(edited, render(hills(**{**before, **change}))[0])
    assert found == kept


@pytest.mark.parametrize("described", [make, hills, strands])
def test_after_a_draft_the_picture_is_that_of_a_fresh_scene(described):
    parts = _core.SceneParts()
    draft, _ = render(described(parts), draft=True)
    assert np.isfinite(draft).all() and draft.any()
    np.testing.assert_array_equal(render(described(parts))[0], render(described())[0])


def facets(scene, **settings):
    """The bytes of all, and how high the ball is in the middle of the picture."""
    session = _core.Session(scene, _core.Settings(width=16, height=16, samples=1, passes=["position"], **settings))
    assert session.render()
    return session.statistics()["memory"]["facets"], session.pass_pixels("position")[8, 8, 2]


def test_a_draft_has_few_facets_and_displaces_nothing():
    fine, displaced = facets(hills(height=0.5))
    coarse, plain = facets(hills(height=0.5), draft=True)
    assert 0 < coarse < fine / 4
    assert displaced == pytest.approx(plain + 0.5, abs=0.05)


@pytest.mark.parametrize("described", [make, strands])
def test_what_is_not_diced_is_built_once_for_a_draft_and_the_picture(described):
    scene = described(_core.SceneParts())
    render(scene, draft=True)
    assert render(scene)[1] == 1


def copies(linked, parts=None, sizes=(1.0, 1.0, 1.0)):
    """Balls side by side, which are one shape or each one of its own."""
    scene = _core.SceneDescription(parts)
    shapes = [
        scene.add_surface("ball", [scenes.sphere_spline(_core, radius=size)]) for size in sizes[: 1 if linked else None]
    ]
    glossy = material(_core, scene, ("glossy", 1.0, 0.9, 0.2, "GGX"))
    for i in range(len(sizes)):
        scene.add_instance(f"ball {i}", shapes[0 if linked else i], scenes.matrix((2.2 * i - 2.2, 0, -i)), glossy)
    scene.set_world(checkered(scene, 1), 64)
    scenes.look_down(scene, 8.0, 0.6)
    return scene


def shapes_of(scene):
    session = _core.Session(scene, _core.Settings(width=16, height=16, samples=4))
    assert session.render()
    return session.pass_pixels("combined"), session.statistics()["geometry"]["shapes"]


def test_copies_are_traced_as_one_shape():
    picture, count = shapes_of(copies(linked=False))
    np.testing.assert_array_equal(picture, shapes_of(copies(linked=True))[0])
    assert count == 1


def test_a_copy_that_is_replaced_is_a_shape_of_its_own():
    parts = _core.SceneParts()
    scene = copies(linked=False, parts=parts)
    shapes_of(scene)
    other = copies(linked=False, sizes=(1.0, 0.5, 1.0))
    scene.replace_shape(1, other.shape(1))
    picture, count = shapes_of(scene)
    np.testing.assert_array_equal(picture, shapes_of(other)[0])
    assert count == 2
