"""Programs: what is rejected, what operations compute, what a program says of itself."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rayleaf import _core
from shading_support import UP, direction, principled, program_with, scalar

tests = _core.shading


def points(count=1, position=None, **more):
    """Points of a flat floor seen from above."""
    position = np.zeros((count, 3), np.float32) if position is None else np.float32(position).reshape(-1, 3)
    up = np.tile(UP, (len(position), 1))
    return tests.surface_points(position, more.pop("normal", up), more.pop("outgoing", up), **more)


def value(identifier, operands, text="", ints=(), floats=(), at=None):
    """What an operation on constants and on registers gives; both must agree."""
    program = _core.Program("Test")
    constants = [program.constant(*o, 1.0) if isinstance(o, tuple) else scalar(program, o) for o in operands]
    folded = program.operation(identifier, constants, ints, floats, text)
    # The same through registers that are not constant: position is zero at the origin.
    zero = program.operation("position")
    moved = [program.operation("vector_math", [c, zero], text="ADD") for c in constants]
    run = program.operation(identifier, moved, ints, floats, text)
    place = points() if at is None else at
    found = place.values(program, folded)[0], place.values(program, run)[0]
    np.testing.assert_array_equal(found[0][:3], found[1][:3])
    return found[0]


@pytest.mark.parametrize(
    "call, words",
    [
        (dict(identifier="nonsense"), "nonsense"),
        (dict(identifier="math", operands=[], text="ADD"), "operands.*0.*1 to 3"),
        (dict(identifier="math", operands=[0, 0, 0, 0], text="ADD"), "operands.*4.*1 to 3"),
        (dict(identifier="math", operands=[7], text="ADD"), "operand.*7"),
        (dict(identifier="math", operands=[-2], text="ADD"), "operand.*-2"),
        (dict(identifier="math", operands=[0], text="PLUS"), "PLUS.*ADD"),
        (dict(identifier="math", operands=[0]), "text"),
        (dict(identifier="math", operands=[0], text="ADD", ints=[1, 2]), "integers.*2"),
        (dict(identifier="math", operands=[0], text="ADD", floats=[1.0]), "floats"),
        (dict(identifier="position", text="WORLD"), "WORLD"),
        (dict(identifier="component", operands=[0], ints=[4]), "4.*0 to 3"),
        (dict(identifier="component", operands=[0]), "integers"),
        (dict(identifier="noise", operands=[0] * 6, ints=[5]), "5.*1 to 4"),
        (dict(identifier="table", operands=[0], ints=[1]), "floats.*multiple of 4"),
        (dict(identifier="table", operands=[0], ints=[1], floats=[1.0, 2.0, 3.0]), "floats.*multiple of 4"),
        (dict(identifier="table", operands=[0], ints=[1], floats=[float("nan")] * 4), "not finite"),
        (dict(identifier="image", operands=[0], ints=[0, 4]), "4.*0 to 3"),
        (dict(identifier="principled", operands=[0]), "operands.*1.*21"),
    ],
)
def test_a_wrong_operation_is_rejected_with_the_materials_name(call, words):
    program = _core.Program("Copper")
    scalar(program, 1.0)
    with pytest.raises(_core.InputError, match=f"'Copper'.*{words}"):
        program.operation(**call)


def test_a_constant_that_is_not_finite_is_rejected():
    with pytest.raises(_core.InputError, match="Copper.*finite"):
        _core.Program("Copper").constant(0, float("nan"), 0, 0)


@pytest.mark.parametrize(
    "name, arguments, expected",
    [
        ("POWER", (-2.0, 3.0), -8.0),
        ("POWER", (-2.0, 0.5), 0.0),
        ("LOGARITHM", (8.0, 2.0), 3.0),
        ("LOGARITHM", (-1.0, 2.0), 0.0),
        ("LOGARITHM", (8.0, 1.0), 0.0),
        ("DIVIDE", (1.0, 0.0), 0.0),
        ("MODULO", (-7.0, 3.0), -1.0),
        ("FLOORED_MODULO", (-7.0, 3.0), 2.0),
        ("MODULO", (-7.0, 0.0), 0.0),
        ("WRAP", (2.7, 1.0, -1.0), 0.7),
        ("PINGPONG", (2.3, 1.0), 0.3),
        ("SNAP", (2.7, 0.5), 2.5),
        ("SQRT", (-4.0,), 0.0),
        ("INVERSE_SQRT", (0.0,), 0.0),
        ("ARCSINE", (2.0,), np.pi / 2),
        ("COMPARE", (1.0, 1.2, 0.3), 1.0),
        ("COMPARE", (1.0, 1.4, 0.3), 0.0),
        ("SMOOTH_MIN", (1.0, 1.0, 0.6), 0.9),
        ("SMOOTH_MAX", (1.0, 1.0, 0.6), 1.1),
        ("ROUND", (-1.5,), -1.0),
        ("TRUNC", (-1.7,), -1.0),
        ("ARCTAN2", (1.0, -1.0), 3 * np.pi / 4),
    ],
)
def test_math_is_blenders(name, arguments, expected):
    np.testing.assert_allclose(value("math", arguments, name), expected, atol=1e-6)


def test_exclusion_blends_as_its_formula_says():
    a, b, t = np.array((0.9, 0.2, 0.5)), np.array((0.3, 0.8, 0.5)), 0.7
    expected = a + t * (a + b - 2 * a * b - a)
    found = value("mix", [t, tuple(a), tuple(b)], "EXCLUSION", [1, 0])
    np.testing.assert_allclose(found[:3], expected, atol=1e-6)


def test_a_mix_factor_counts_per_channel():
    found = value("mix", [(0.0, 0.5, 2.0), (1.0, 1.0, 1.0), (3.0, 3.0, 3.0)], "MIX", [0, 0])
    np.testing.assert_allclose(found[:3], (1, 2, 5))
    clamped = value("mix", [(0.0, 0.5, 2.0), (1.0, 1.0, 1.0), (3.0, 3.0, 3.0)], "MIX", [1, 0])
    np.testing.assert_allclose(clamped[:3], (1, 2, 3))


@given(st.tuples(*[st.floats(0, 1, width=32)] * 3))
def test_colour_models_invert(rgb):
    for model in ("hsv", "hsl"):
        there = value(f"rgb_to_{model}", [rgb])
        back = value(f"{model}_to_rgb", [tuple(float(x) for x in there[:3])])
        np.testing.assert_allclose(back[:3], rgb, atol=2e-6, err_msg=model)


def test_tables_interpolate_or_step():
    entries = [0, 0, 0, 1, 1, 2, 3, 0.5, 5, 5, 5, 0]
    np.testing.assert_allclose(value("table", [0.25], ints=[1], floats=entries), (0.5, 1, 1.5, 0.75))
    np.testing.assert_allclose(value("table", [0.49], ints=[0], floats=entries), (0, 0, 0, 1))
    for x, expected in ((-1.0, entries[:4]), (2.0, entries[8:])):
        np.testing.assert_allclose(value("table", [x], ints=[1], floats=entries), expected)


def test_noise_lies_in_the_unit_interval_and_is_smooth():
    program = _core.Program("Noise")
    position = program.operation("position")
    numbers = [scalar(program, x) for x in (0.0, 4.0, 3.0, 0.5, 0.0)]
    result = program.operation("noise", [position, *numbers], [3])
    random = np.random.default_rng(0).uniform(-20, 20, (4000, 3)).astype(np.float32)
    found = points(position=random).values(program, result)
    assert 0 <= found.min() and found.max() <= 1 and found[:, :3].std(axis=0).min() > 0.05
    assert abs(found[:, :3].mean() - 0.5) < 0.02
    near = points(position=random + np.float32(1e-3)).values(program, result)
    assert abs(near - found).max() < 0.2
    np.testing.assert_array_equal(found[:, 0], found[:, 3])


def test_a_noise_read_by_its_factor_alone_gives_the_same_factor():
    found = []
    for both in (False, True):
        program = _core.Program("Noise")
        numbers = [scalar(program, x) for x in (0.0, 4.0, 2.5, 0.5, 0.7)]
        noise = program.operation("noise", [program.operation("position"), *numbers], [3])
        factor = program.operation("component", [noise], [3])
        if both:
            program.operation("emission", [scalar(program, 1), noise, scalar(program, 1)])
        found.append(points(position=[(0.3, 1.7, -2.2)]).values(program, factor)[0, 0])
    assert found[0] == found[1] != 0


def test_noise_at_absurd_coordinates_is_finite():
    for far in (1e20, -3e38):
        assert np.isfinite(value("noise", [(far, 0.0, far), far, 3.0, 15.0, 1.0, 3.0], ints=[4])).all()


def test_the_back_of_a_surface_shows_its_normals_turned():
    program = _core.Program("Sides")
    registers = [program.operation(name) for name in ("normal", "true_normal", "backfacing", "incoming")]
    below = tests.surface_points(np.zeros((1, 3), np.float32), UP[None], -direction(0.5)[None])
    normal, true_normal, backfacing, incoming = (below.values(program, r)[0] for r in registers)
    np.testing.assert_array_equal(normal[:3], -UP)
    np.testing.assert_array_equal(true_normal[:3], -UP)
    assert backfacing[0] == 1
    np.testing.assert_array_equal(incoming[:3], -direction(0.5))


def test_object_coordinates_undo_the_objects_matrix():
    matrix = np.eye(4)
    matrix[:3, :3] = [[0, -2, 0], [2, 0, 0], [0, 0, 3]]
    matrix[:3, 3] = (5, 6, 7)
    program = _core.Program("Object")
    local, location = program.operation("object_coordinates"), program.operation("object_location")
    place = points(position=(matrix @ (1, 2, 3, 1))[:3], object_to_world=matrix)
    np.testing.assert_allclose(place.values(program, local)[0, :3], (1, 2, 3), atol=1e-6)
    np.testing.assert_allclose(place.values(program, location)[0, :3], (5, 6, 7))


def test_the_objects_normal_undoes_a_stretched_and_turned_matrix():
    matrix = np.eye(4)
    matrix[:3, :3] = [[0, -2, 0], [2, 0, 0], [0, 0, 3]]
    in_object = np.array([0.6, 0.0, 0.8])
    in_world = np.linalg.inv(matrix[:3, :3]).T @ in_object
    in_world /= np.linalg.norm(in_world)
    program = _core.Program("Normal")
    local = program.operation("object_normal")
    at = np.float32(in_world)[None]
    place = points(normal=at, outgoing=at, object_to_world=matrix)
    np.testing.assert_allclose(place.values(program, local)[0, :3], in_object, atol=1e-6)


def test_a_vector_in_tangent_space_stands_on_the_objects_own_axes():
    matrix = np.eye(4)
    matrix[:3, :3] = [[0, -2, 0], [2, 0, 0], [0, 0, 3]]
    along = lambda *v: np.float32(matrix[:3, :3] @ np.array(v, float))[None]  # noqa: E731
    up = np.float32([[0, 0, 1]])
    program = _core.Program("Tangent")
    moved = program.operation("from_tangent_space", [program.constant(2, 3, 5, 1)])
    for dp_dv, bitangent in (((0, 1, 0), 1), ((0, -1, 0), -1)):  # mirrored texture coordinates turn it
        place = points(normal=up, outgoing=up, dp_du=along(4, 0, 0.5), dp_dv=along(*dp_dv), object_to_world=matrix)
        np.testing.assert_allclose(place.values(program, moved)[0, :3], (2, 5 * bitangent, 3), atol=1e-6)


def test_a_program_says_what_it_may_do():
    plain = program_with("diffuse", [1.0, 1.0])
    assert not plain.emits and not plain.may_be_transparent and not plain.is_constant
    lamp = program_with("emission", [1.0, (1, 0.5, 0.2), 3.0])
    assert lamp.emits and lamp.is_constant
    assert not program_with("emission", [1.0, (1, 0.5, 0.2), 0.0]).emits
    assert program_with("transparent", [1.0, 1.0]).may_be_transparent
    assert not principled().emits and not principled().may_be_transparent
    assert principled(emission_color=(1, 0, 0)).emits and principled(alpha=0.5).may_be_transparent
    sky = _core.Program("Sky")
    sky.operation("background", [scalar(sky, 1), sky.operation("position"), scalar(sky, 1)])
    assert sky.emits and not sky.is_constant


def test_the_worlds_coordinates_are_directions():
    sky = _core.Program("Sky")
    register = sky.operation("generated")
    sky.operation("background", [scalar(sky, 1), register, scalar(sky, 2)])
    sky.operation("diffuse", [scalar(sky, 1), scalar(sky, 1)])
    along = direction(0.3)[None]
    result = tests.world_directions(along).results(sky)
    np.testing.assert_allclose(result["emission"], 2 * np.maximum(along, 0), atol=1e-6)
    assert result["lobes"][0] == 0


def test_alpha_lets_light_through_and_dims_the_rest():
    result = points().results(principled(alpha=0.25, emission_color=(1, 2, 3), emission_strength=2.0))
    np.testing.assert_allclose(result["transparency"][0], 0.75)
    np.testing.assert_allclose(result["emission"][0], (0.5, 1, 1.5))


def test_many_closures_merge_instead_of_running_over():
    program = _core.Program("Many")
    for i in range(40):  # of one direction at normal incidence, but of 40 tilts
        tilted = program.constant(1e-4 * i, 0, 1, 0)
        program.operation("diffuse", [scalar(program, 1 / 40), scalar(program, 1.0), scalar(program, 0.0), tilted])
    lobes = points().closures(program, 0)
    assert len(lobes) == 16
    value_up = lobes.evaluate(UP, UP[None], UP)[0]
    np.testing.assert_allclose(value_up, 1 / np.pi, rtol=1e-5)


def test_a_program_of_a_thousand_registers_runs():
    program = _core.Program("Long")
    register = program.operation("position")
    for _ in range(1000):
        register = program.operation("vector_math", [register, program.constant(1, 0, 0, 0)], text="ADD")
    np.testing.assert_allclose(points().values(program, register)[0, :3], (1000, 0, 0))


def image_program(store, texture, build):
    """A program that looks `texture` up at the register that `build` makes."""
    program = _core.Program("Image")
    return program, program.operation("image", [build(program)], [texture, 0, 0])


@pytest.mark.parametrize("scale", (1.0, 5.0))
def test_an_image_is_filtered_by_the_footprint_of_its_mapped_coordinate(scale):
    """Stripes one pixel wide: their contrast tells the width of the footprint, whatever scaled the coordinate."""
    store = tests.TextureStore(1 << 27)
    pixels = np.zeros((128, 128, 1), np.float32)
    pixels[:, ::2] = 1
    texture = store.add_pixels("Stripes", pixels, tests.ColorSpace.NON_COLOR)

    def scaled(program):
        return program.operation("vector_math", [program.operation("uv"), scalar(program, scale)], text="MULTIPLY")

    program, result = image_program(store, texture, scaled)
    uv = np.float32([[(64 + 0.5) / 128 / scale, 0.5]])
    frame = dict(dp_du=np.float32([[1, 0, 0]]), dp_dv=np.float32([[0, 1, 0]]), uv=uv, textures=store)

    def contrast(step):
        steps = dict(dp_dx=np.float32([[step, 0, 0]]), dp_dy=np.float32([[0, step, 0]]))
        return abs(points(**frame, **steps).values(program, result)[0, 0] - 0.5)

    one_pixel = 1 / 128 / scale
    assert contrast(0.5 * one_pixel) > 0.4
    assert contrast(8 * one_pixel) < 0.05


def test_a_panorama_has_no_seam():
    """Each way the seam lies, the footprint is small: the picture's fine detail must not vanish there."""
    store = tests.TextureStore(1 << 27)
    pixels = np.zeros((64, 128, 1), np.float32)
    pixels[::2] = 1  # rings of latitude
    texture = store.add_pixels("Rings", pixels, tests.ColorSpace.NON_COLOR)
    program = _core.Program("Sky")
    result = program.operation("environment", [program.operation("position")], [texture, 0, 0])
    angles = np.pi + np.linspace(-0.02, 0.02, 41)
    latitude = (32.5 / 64 - 0.5) * np.pi
    directions = np.stack([np.cos(angles), np.sin(angles), np.full(41, np.tan(latitude))], axis=1)
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    step = np.stack([-np.sin(angles), np.cos(angles), np.zeros(41)], axis=1) * 0.004
    sky = tests.world_directions(np.float32(directions), np.float32(step), np.float32(step), store)
    found = sky.values(program, result)[:, 0]
    np.testing.assert_allclose(found, found[0], atol=1e-3)
    assert abs(found[0] - 0.5) > 0.4
