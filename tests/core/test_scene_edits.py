"""Edits of a scene: what an edited copy shows is what a scene made anew shows."""

import numpy as np
import pytest
import scenes
from hypothesis import given, settings, strategies
from rayleaf import _core

PLACES = 6  # instances: enough for a tree above them
MATERIALS = 3
SHAPES = 2


def program(color, glow):
    made = scenes.diffuse(_core, "material", (color, 0.5, 0.2))
    if glow > 0:
        one = made.constant(1, 1, 1, 1)
        made.operation("emission", [one, one, made.constant(*[glow] * 4)])
    return made


def ball(radius):
    return [scenes.sphere_spline(_core, radius=radius)]


class Model:
    """All that an edit may change."""

    def __init__(self):
        self.radius = [1.0] * SHAPES
        self.colors = [0.2, 0.5, 0.8]
        self.glow = [0.0] * MATERIALS
        self.places = [(2.0 * i - 5.0, 0.0, 0.0) for i in range(PLACES)]
        self.power, self.sky, self.height = 300.0, 0.3, 12.0

    def fresh(self, parts=None):
        scene = _core.SceneDescription(parts)
        shapes = [scene.add_surface(f"ball {i}", ball(radius)) for i, radius in enumerate(self.radius)]
        lists = []
        for color, glow in zip(self.colors, self.glow, strict=True):
            lists.append(scene.add_material_list([scene.add_material("material", program(color, glow))]))
        for i, place in enumerate(self.places):
            scene.add_instance(f"object {i}", shapes[i % SHAPES], scenes.matrix(place), lists[i % MATERIALS])
        self.light(scene)
        return scene

    def light(self, scene):
        scene.clear_lamps()
        scene.add_lamp("lamp", "POINT", scenes.matrix((2, -3, 6)), [self.power] * 3, radius=0.3)
        scene.set_world(scenes.background(_core, (self.sky, 0.3, 0.4)))
        scenes.look_down(scene, self.height, 0.6)


def move(model, scene, i, value):
    model.places[i % PLACES] = (model.places[i % PLACES][0], 3.0 * value, value)
    scene.place_instances(np.int32([i % PLACES]), scenes.matrix(model.places[i % PLACES])[None])


def reshape(model, scene, i, value):
    model.radius[i % SHAPES] = 0.5 + abs(value)
    other = _core.SceneDescription()
    other.add_surface("ball", ball(model.radius[i % SHAPES]))
    scene.replace_shape(i % SHAPES, other.shape(0))


def recolor(model, scene, i, value):
    model.colors[i % MATERIALS] = abs(value)
    scene.replace_material(i % MATERIALS, "material", program(abs(value), model.glow[i % MATERIALS]))


def glow(model, scene, i, value):
    model.glow[i % MATERIALS] = max(value, 0.0)
    scene.replace_material(i % MATERIALS, "material", program(model.colors[i % MATERIALS], max(value, 0.0)))


def light(model, scene, i, value):
    model.power, model.sky = 300.0 * abs(value), abs(value)
    model.light(scene)


def look(model, scene, i, value):
    model.height = 8.0 + 6.0 * value
    model.light(scene)


EDITS = [move, reshape, recolor, glow, light, look]
STEPS = strategies.lists(
    strategies.tuples(strategies.sampled_from(EDITS), strategies.integers(0, 5), strategies.floats(-1, 1, width=16)),
    min_size=1,
    max_size=8,
)


def rendered(scene, **more):
    session = _core.Session(scene, _core.Settings(**{"width": 12, "height": 8, "samples": 1, **more}))
    assert session.render()
    return session.pass_pixels("combined"), session.statistics()["geometry"]


@settings(max_examples=12, deadline=None)
@given(steps=STEPS, megabytes=strategies.sampled_from([-1.0, 0.0]))
def test_any_sequence_of_edits_shows_what_a_scene_made_anew_shows(steps, megabytes):
    model = Model()
    scene = model.fresh(_core.SceneParts())
    rendered(scene, resident_megabytes=megabytes)
    for edit, i, value in steps:
        scene = scene.copy()
        edit(model, scene, i, value)
        picture, _ = rendered(scene, resident_megabytes=megabytes)
        np.testing.assert_array_equal(picture, rendered(model.fresh(), resident_megabytes=megabytes)[0])


CENTRE = 315


class Crowd(Model):
    """So many instances that edits leave some of their tables as they are."""

    def __init__(self):
        super().__init__()
        self.places = [(0.5 * (i % 30) - 7.0, 0.5 * (i // 30) - 5.0, 0.0) for i in range(600)]
        self.radius = [0.3, 1.0]  # that in the middle is large


def move_some(model, scene, i, value):
    """One, or so many that the tree is built anew; some far away, which changes the space of the tree."""
    moved = range(i, len(model.places), 600 if value > 0 else 4 + i)
    for each in moved:
        x, y, _ = model.places[each]
        model.places[each] = (x, y, 3.0 * value * (30.0 if i == 5 else 1.0))
    scene.place_instances(np.int32(moved), np.stack([scenes.matrix(model.places[each]) for each in moved]))


def push(model, scene, i, value):
    """The object in the middle, which the camera sees best, from where it was."""
    model.places[CENTRE] = (0.3 * i, value, 4.0 + value)
    scene.place_instances(np.int32([CENTRE]), scenes.matrix(model.places[CENTRE])[None])


def hide_and_show(model, scene, i, value):
    """An object scaled to as good as nothing, and back with the next edit of this kind."""
    x, y, z = model.places[i]
    model.places[i] = (x, y, z + 1e-3)
    scene.place_instances(np.int32([i]), scenes.matrix((x, y, z), scale=1e-6)[None])
    rendered(scene)
    scene.place_instances(np.int32([i]), scenes.matrix(model.places[i])[None])


CROWD_STEPS = strategies.lists(
    strategies.tuples(
        strategies.sampled_from([push, push, move_some, reshape, recolor, light, look, hide_and_show]),
        strategies.integers(0, 5),
        strategies.floats(-1, 1, width=16),
    ),
    min_size=2,
    max_size=6,
)


@settings(max_examples=12, deadline=None)
@given(steps=CROWD_STEPS, megabytes=strategies.sampled_from([-1.0, 0.0]), interpolation=strategies.booleans())
def test_edits_among_many_instances_show_what_a_scene_made_anew_shows(steps, megabytes, interpolation):
    model = Crowd()
    more = {"resident_megabytes": megabytes}
    if interpolation:
        more["ray_interpolation"] = _core.RayInterpolation("ON", 0.01)
    scene = model.fresh(_core.SceneParts())
    rendered(scene, **more)
    for edit, i, value in steps:
        scene = scene.copy()
        edit(model, scene, i, value)
        np.testing.assert_array_equal(rendered(scene, **more)[0], rendered(model.fresh(), **more)[0])


def test_two_views_of_one_scene_are_edited_apart():
    models, parts = [Crowd(), Crowd()], _core.SceneParts()
    views = [models[0].fresh(parts)] * 2
    for value in (0.25, -0.5, 0.75):
        sessions = []
        for k, model in enumerate(models):
            views[k] = views[k].copy()
            move_some(model, views[k], 3 * k, value)
            sessions.append(_core.Session(views[k], _core.Settings(width=12, height=8, samples=1)))
            assert sessions[k].build()
        for session, model in zip(sessions, models, strict=True):
            assert session.render_more(1)
            np.testing.assert_array_equal(session.pass_pixels("combined"), rendered(model.fresh())[0])


def test_a_render_under_way_keeps_the_scene_that_it_was_given():
    model = Model()
    parts = _core.SceneParts()
    scene = model.fresh(parts)
    before = rendered(model.fresh())[0]
    first = _core.Session(scene, _core.Settings(width=12, height=8, samples=1))
    assert first.build()
    edited = scene.copy()
    move(model, edited, 0, 0.5)
    after = rendered(edited)[0]
    assert first.render_more(1)
    np.testing.assert_array_equal(first.pass_pixels("combined"), before)
    np.testing.assert_array_equal(after, rendered(model.fresh())[0])


@pytest.mark.parametrize(
    "edit, message",
    [
        (lambda scene: scene.place_instances(np.int32([9]), np.eye(4)[None]), "scene.*instance.*9.*0 to 5"),
        (lambda scene: scene.place_instances(np.int32([2]), scenes.matrix(scale=0)[None]), "object 2.*scale"),
        (lambda scene: scene.replace_material(3, "gone", None), "gone.*material.*3.*0 to 2"),
        (lambda scene: scene.replace_shape(5, Model().fresh().shape(0)), "ball 0.*shape.*5.*0 to 1"),
        (lambda scene: scene.shape(-1), "shape.*-1"),
    ],
)
def test_an_edit_that_cannot_be_is_named_and_leaves_the_scene_as_it_was(edit, message):
    scene = Model().fresh()
    before = scene.copy()
    with pytest.raises(_core.InputError, match=message):
        edit(scene)
    assert scene.shows_same_as(before)


def test_one_wrong_place_moves_nothing():
    scene = Model().fresh()
    before = scene.copy()
    with pytest.raises(_core.InputError, match="object 1"):
        scene.place_instances(np.int32([0, 1]), np.array([scenes.matrix((9, 9, 9)), scenes.matrix(scale=0)]))
    assert scene.shows_same_as(before)


@pytest.mark.parametrize("edit", [recolor, glow, light, move, reshape])
def test_scenes_that_differ_are_told_apart(edit):
    model = Model()
    scene = model.fresh()
    other = scene.copy()
    assert scene.shows_same_as(other)
    edit(model, other, 1, 0.3)
    assert not scene.shows_same_as(other) and not other.shows_same_as(scene)


def test_an_emptied_scene_keeps_ids_of_names_and_textures():
    scene = _core.SceneDescription()
    scene.attribute("a")
    name = scene.attribute("b")
    texture = scene.add_image_pixels("image", np.ones((4, 4, 3), np.float32), "LINEAR")
    emptied = scene.emptied()
    assert emptied.attribute("b") == name
    assert emptied.add_image_pixels("image", np.zeros((4, 4, 3), np.float32), "LINEAR") == texture + 1
