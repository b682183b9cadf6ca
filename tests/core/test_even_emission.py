"""Light whose emission is the same everywhere is sampled and seen without running its program, to the same bits."""

from typing import Any

import numpy as np
import pytest
import scenes
import shapes
import strand_shapes
import subdivision_cages
import swept_support

POSITION = np.array([0.3, 0.2, -0.4])
COLOR, STRENGTH = (0.3, 0.7, 0.11), 5.3


def alike(core, operation: str, from_hit: bool) -> Any:
    """A program that emits one colour; `from_hit`: as far as anybody can tell, it might not."""
    program = core.Program(operation)
    strength = program.constant(*[STRENGTH] * 4)
    if from_hit:
        zero = program.constant(0, 0, 0, 0)
        nothing = program.operation("vector_math", [program.operation("position"), zero], text="DOT_PRODUCT")
        strength = program.operation("math", [nothing, strength], ints=[0], text="ADD")
    program.operation(operation, [program.constant(1, 1, 1, 1), program.constant(*COLOR, 1), strength])
    return program


def scattering_emitter(core, from_hit: bool) -> Any:
    """The same light on a surface that scatters as well."""
    program = alike(core, "emission", from_hit)
    white, zero = program.constant(1, 1, 1, 1), program.constant(0, 0, 0, 0)
    program.operation("diffuse", [white, white, zero])
    return program


@pytest.mark.parametrize("make", [lambda core, hit: alike(core, "emission", hit), scattering_emitter])
def test_a_program_tells_whether_it_emits_the_same_everywhere(core, make):
    assert make(core, False).even_emission == pytest.approx([STRENGTH * x for x in COLOR])
    assert make(core, True).even_emission is None


SHAPES = {
    "a mesh": lambda: shapes.cube(),
    "a spline surface": lambda: shapes.nurbs_torus(),
    "a flat spline surface": lambda: shapes.nurbs_sphere(smooth=False),
    "a bevelled curve": lambda: swept_support.bend(bevel_depth=0.2, fill_caps=True),
    "a strand": lambda: strand_shapes.strand(strand_shapes.S_CURVE, 0.1, basis="BEZIER"),
    "a subdivision surface": lambda: subdivision_cages.cube().surface(),
}


def scene_of(core, shape: Any, from_hit: bool, moves: bool = False) -> Any:
    """The shape shines on a floor; `moves`: while the shutter is open."""
    scene = core.SceneDescription()
    scenes.look_down(scene, height=6, half=0.6)
    glow = scene.add_material("glow", alike(core, "emission", from_hit))
    place = scenes.matrix((0.1, 0.05, 1.5), 0.7)
    motion = np.array([place, scenes.matrix((-0.6, 0.2, 1.1), 0.9)]) if moves else None
    scene.add_instance("emitter", scene.add_shape(shape), place, scene.add_material_list([glow]), motion=motion)
    floor = scene.add_material("floor", scenes.diffuse(core))
    scene.add_instance("floor", scenes.quad(scene, "floor", 4.0), scenes.matrix(), scene.add_material_list([floor]))
    return scene


# Light that is the same everywhere is sampled on these without looking for the facet, so shadow rays end farther from the
# surface: one that grazes the shape may be blocked where the other is not. In a picture of so few pixels facets lie up to
# a thousandth of the shape's size beside it, and one direction in a hundred comes that near.
KEEPS_FROM_FACETS = {"a spline surface", "a flat spline surface"}


def picture(core, scene: Any) -> Any:
    """What it looks like."""
    return scenes.render(core, scene, width=32, height=32, samples=1)["combined"]


def assert_same(pictures: list[Any], shape: str) -> None:
    """To the bit, but for few that graze the shape."""
    differs = (pictures[0] != pictures[1]).any(-1).mean()
    assert differs <= (0.015 if shape in KEEPS_FROM_FACETS else 0.0)


@pytest.mark.parametrize("name", SHAPES)
def test_an_even_emitter_is_sampled_as_one_whose_program_runs(core, name):
    shape = SHAPES[name]()
    plain, slow = (scene_of(core, shape, from_hit) for from_hit in (False, True))
    random = np.random.default_rng(1).random((5000, 2)).astype(np.float32).clip(0, np.float32(1 - 2**-24))
    samples, expected = (core.LightProbe(scene).sample(POSITION, random) for scene in (plain, slow))
    assert (expected["density"] > 0).mean() > 0.3
    for key, values in expected.items():
        np.testing.assert_array_equal(samples[key], values, err_msg=key)
    pictures = [picture(core, scene) for scene in (plain, slow)]
    assert pictures[1].max() > 0
    assert_same(pictures, name)


@pytest.mark.parametrize("name", SHAPES)
def test_an_even_emitter_that_moves_looks_as_one_whose_program_runs(core, name):
    shape = SHAPES[name]()
    moving = [picture(core, scene_of(core, shape, from_hit, moves=True)) for from_hit in (False, True)]
    assert_same(moving, name)
    assert not np.array_equal(moving[0], picture(core, scene_of(core, shape, from_hit=False)))


def test_an_even_world_looks_as_one_whose_program_runs(core):
    pictures = []
    for from_hit in (False, True):
        scene = scene_of(core, shapes.cube(), from_hit=False)
        scene.set_world(alike(core, "background", from_hit), 0)
        pictures.append(picture(core, scene))
    np.testing.assert_array_equal(*pictures)
