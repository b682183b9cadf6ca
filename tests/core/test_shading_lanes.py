"""A program that runs for many points at once finds the bits that it finds point by point."""

from itertools import product

import numpy as np
import pytest
from rayleaf import _core

TOGETHER = (2, 3, 5, 16, 17, 32)
UP = np.float32((0, 0, 1))


@pytest.fixture(params=_core.trace.simd_targets())
def target(request, any_target):
    assert _core.trace.use_simd_target(request.param)
    return request.param


def scattered_points(seed=0, count=193):
    """Points of all sizes, some of them nasty."""
    random = np.random.default_rng(seed)
    positions = (random.normal(size=(count, 3)) * 10.0 ** random.uniform(-3, 3, size=(count, 1))).astype(np.float32)
    nasty = (0.0, -0.0, 1.0, -1.0, 0.5, np.inf, -np.inf, np.nan, 3e9, -3e9, 1e38, 1e-40)
    for i, number in enumerate(nasty):
        positions[7 * i, i % 3] = number
    normals = np.tile(UP, (count, 1))
    return _core.shading.surface_points(positions, normals, normals, uv=random.random((count, 2), np.float32))


def check_lanes(points, program, register):
    alone = points.values(program, register)
    assert len(np.unique(alone, axis=0)) > 3
    for together in TOGETHER:
        found = points.values(program, register, together=together)
        np.testing.assert_array_equal(found.view(np.uint32), alone.view(np.uint32), err_msg=f"{together} together")


def component(program, register, i):
    return program.operation("component", [register], [i])


@pytest.mark.parametrize("factor_alone", [False, True])
@pytest.mark.parametrize("dimensions", [1, 2, 3, 4])
@pytest.mark.parametrize(
    "detail, roughness, distortion",
    [(0.0, 0.5, 0.0), (2.0, 0.5, 0.0), (1.3, 0.8, 0.7), (None, None, None), (20.0, -1.0, 0.0), (-3.0, 2.0, 1e3)],
)
def test_noise_has_the_same_bits_in_lanes(target, dimensions, factor_alone, detail, roughness, distortion):
    """None: another one at each point."""
    program = _core.Program("Noise")
    position, uv = program.operation("position"), program.operation("uv")

    def number(value, axis, scale):
        if value is not None:
            return program.constant(value, value, value, value)
        factor = program.constant(scale, scale, scale, scale)
        return program.operation("math", [component(program, uv, axis), factor], text="MULTIPLY")

    scale = program.constant(1.7, 1.7, 1.7, 1.7)
    operands = [position, component(program, position, 1), scale]
    operands += [number(detail, 0, 4.0), number(roughness, 1, 1.2), number(distortion, 0, 1.0)]
    if detail is None:
        operands += [number(None, 1, 3.0), -1, -1]
    noise = program.operation("noise", operands, [dimensions])
    result = component(program, noise, 3) if factor_alone else noise
    check_lanes(scattered_points(dimensions), program, result)


@pytest.mark.parametrize("dimensions", [1, 2, 3, 4])
@pytest.mark.parametrize("detail", [3.0, 6.25, 15.0])
def test_octaves_of_a_point_have_the_bits_of_noise_octave_by_octave(target, dimensions, detail):
    program = _core.Program("Noise")
    position = program.operation("position")

    def noise(scale, detail):
        numbers = [program.constant(x, x, x, x) for x in (scale, detail, 0.6, 0.0)]
        return program.operation("noise", [position, component(program, position, 1), *numbers], [dimensions, 0, 0])

    octaves = int(detail) + 1
    one_by_one = [noise(2.0**i, 0.0) for i in range(octaves + 1)]
    together = noise(1.0, detail)
    points = scattered_points(dimensions)
    found = points.values(program, together)[:, 3]
    amplitude, value = np.float32(1), np.zeros(len(found), np.float32)
    for each in one_by_one[:octaves]:
        value += points.values(program, each)[:, 3] * amplitude
        amplitude *= np.float32(0.6)
    if detail > int(detail):
        value += np.float32(detail - int(detail)) * points.values(program, one_by_one[octaves])[:, 3] * amplitude
    np.testing.assert_array_equal(found.view(np.uint32), value.view(np.uint32))


def test_noise_without_operands_has_the_same_bits_in_lanes(target):
    program = _core.Program("Noise")
    uv = program.operation("uv")
    noise = program.operation("noise", [-1, -1, -1, -1, -1, component(program, uv, 0)], [3])
    check_lanes(scattered_points(), program, noise)


def test_the_number_of_points_that_run_together_is_checked():
    program = _core.Program("Short")
    position = program.operation("position")
    for together in (0, 33):
        with pytest.raises(_core.InputError, match=f"'Short': together is {together}, expected 1 to 32"):
            scattered_points().values(program, position, together=together)


def test_images_have_the_same_bits_whatever_else_is_looked_up_with_them(target):
    """Half of the points have no footprint; a second image is looked up where the first one says."""
    random = np.random.default_rng(3)
    count = 97
    store = _core.shading.TextureStore(1 << 27)
    first, second = (
        store.add_pixels(name, random.random((64, 64, 4)).astype(np.float32), _core.shading.ColorSpace.LINEAR)
        for name in ("first", "second")
    )
    steps = random.normal(size=(2, count, 3)).astype(np.float32) * np.float32(0.05)
    steps[:, ::2] = 0
    normals = np.tile(UP, (count, 1))
    points = _core.shading.surface_points(
        random.random((count, 3), np.float32),
        normals,
        normals,
        uv=random.random((count, 2), np.float32),
        dp_du=np.tile(np.float32((1, 0, 0)), (count, 1)),
        dp_dv=np.tile(np.float32((0, 1, 0)), (count, 1)),
        dp_dx=steps[0],
        dp_dy=steps[1],
        textures=store,
    )
    program = _core.Program("Images")
    scale, none = program.constant(3, 2, 1, 1), program.constant(0, 0, 0, 0)
    place = program.operation("mapping", [program.operation("uv"), none, none, scale], text="POINT")
    found = program.operation("image", [place], [first, 0, 0])
    check_lanes(points, program, program.operation("image", [found], [second, 0, 0]))


RAMP = [0.1, 0.2, 0.3, 1.0, 0.9, 0.5, 0.1, 0.5, 0.4, 0.4, 1.0, 0.0]


def rows_of(program, place):
    """Registers of what is computed for all points together, from places in a register or a constant."""
    number = [program.constant(x, x, x, x) for x in (0.3, 1.7)]
    turn, shift = program.constant(0.3, -1.0, 2.0, 1), program.constant(1.0, -2.0, 0.5, 1)
    red = program.constant(0.9, 0.3, 0.1, 1)
    axis = [component(program, place, i) for i in range(3)]
    found = [*axis, program.operation("checker", [place, red, shift, number[1]])]
    found += [program.operation("checker", [place, place, red, axis[1]])]
    for variant in ("POINT", "TEXTURE", "VECTOR", "NORMAL"):
        found.append(program.operation("mapping", [place, shift, turn, turn], text=variant))
        found.append(program.operation("mapping", [shift, place, turn, red], text=variant))
    for variant in ("MIX", "MULTIPLY", "SCREEN", "DIVIDE", "HUE", "VALUE"):
        found.append(program.operation("mix", [number[0], place, red], [1, 0], text=variant))
        found.append(program.operation("mix", [place, red, shift], [1, 1], text=variant))
        found.append(program.operation("mix", [place, place, axis[0]], [0, 0], text=variant))
    found += [program.operation("table", [axis[i]], [i % 2], RAMP) for i in range(3)]
    return found


def test_rows_of_points_have_the_same_bits_as_points():
    points = scattered_points()
    program = _core.Program("Rows")
    for register in rows_of(program, program.operation("position")):
        alone = points.values(program, register)
        for together in TOGETHER:
            found = points.values(program, register, together=together)
            np.testing.assert_array_equal(found.view(np.uint32), alone.view(np.uint32), err_msg=f"{register}")


def test_rows_of_points_have_the_bits_of_constants():
    """Operations of constants are computed when they are added, one by one."""
    places = (np.random.default_rng(3).normal(size=(9, 3)) * np.float32((0.1, 1, 10))).astype(np.float32)
    places[0], places[1], places[2] = (0, -1, 1), (0.5, -0.0, 2), (3e7, -2e9, 4e6)
    up = np.tile(UP, (len(places), 1))
    points = _core.shading.surface_points(places, up, up)
    program = _core.Program("Rows")
    registers = rows_of(program, program.operation("position"))
    rows = [points.values(program, register, together=len(places)) for register in registers]
    for i, place in enumerate(places):
        folded = _core.Program("Constants")
        constants = rows_of(folded, folded.constant(*map(float, place), 1.0))
        for row, register in zip(rows, constants, strict=True):
            np.testing.assert_array_equal(row[i], points.values(folded, register)[0], err_msg=f"{register} at {place}")


@pytest.mark.parametrize("dimensions", [1, 2, 3, 4])
@pytest.mark.parametrize("hashed", [0, 1])
def test_cells_have_the_same_bits_on_all_instruction_sets(any_target, dimensions, hashed):
    """Of each feature and metric."""

    def found():
        result = []
        for feature, metric in product(("F1", "F2", "SMOOTH_F1", "DISTANCE_TO_EDGE", "N_SPHERE_RADIUS"), range(4)):
            program = _core.Program("Cells")
            position = program.operation("position")
            numbers = [component(program, position, 0), *(program.constant(x, x, x, x) for x in (1.7, 0.6, 1.5, 0.8))]
            ints = [dimensions, metric, 0, 0, hashed]
            cells = program.operation("voronoi", [position, *numbers], ints, text=feature)
            result.append(scattered_points(dimensions, 99).values(program, cells))
        return np.concatenate(result)

    each = []
    for target in _core.trace.simd_targets():
        assert _core.trace.use_simd_target(target)
        each.append(found())
    assert len(np.unique(each[0])) > 300
    for other in each[1:]:
        np.testing.assert_array_equal(other.view(np.uint32), each[0].view(np.uint32))


def unit_hash(*key):
    """Bob Jenkins' lookup3 of the bits of three or four numbers, over its largest."""
    words = np.float32(key).view(np.uint32).tolist()
    v = [(0xDEADBEEF + 4 * len(words) + 13 + word) & 0xFFFFFFFF for word in words[:3]]

    def turned(x, turn):
        return (x << turn | x >> (32 - turn)) & 0xFFFFFFFF

    if len(words) == 4:
        for i, turn in enumerate((4, 6, 8, 16, 19, 4)):
            x, y, z = i % 3, (i + 1) % 3, (i + 2) % 3
            v[x] = ((v[x] - v[z]) & 0xFFFFFFFF) ^ turned(v[z], turn)
            v[z] = (v[z] + v[y]) & 0xFFFFFFFF
        v[0] = (v[0] + words[3]) & 0xFFFFFFFF
    for i, turn in enumerate((14, 11, 25, 16, 4, 14, 24)):
        x, y = ((2, 1), (0, 2), (1, 0))[i % 3]
        v[x] = ((v[x] ^ v[y]) - turned(v[y], turn)) & 0xFFFFFFFF
    return v[2] / 4294967295.0


def test_the_nearest_point_is_that_of_cells_looked_at_one_by_one(target):
    places = np.random.default_rng(4).uniform(-20, 20, (60, 3)).astype(np.float32)
    program = _core.Program("Cells")
    zero, one = (program.constant(x, x, x, x) for x in (0.0, 1.0))
    operands = [program.operation("position"), zero, one, zero, zero, one]
    cells = program.operation("voronoi", operands, [3, 0, 0], text="F1")
    points = program.operation("voronoi", operands, [3, 0, 1], text="F1")
    up = np.tile(UP, (len(places), 1))
    at = _core.shading.surface_points(places, up, up)
    found, nearest = at.values(program, cells), at.values(program, points)
    for place, result, point in zip(places, found, nearest, strict=True):
        around = [np.floor(place) + step for step in product((-1, 0, 1), repeat=3)]
        chances = [[unit_hash(*cell), unit_hash(*cell, 1.0), unit_hash(*cell, 2.0)] for cell in around]
        distances = [np.linalg.norm(cell + chance - place) for cell, chance in zip(around, chances, strict=True)]
        best = int(np.argmin(distances))
        assert result[3] == pytest.approx(distances[best], rel=1e-5, abs=1e-5)
        np.testing.assert_allclose(result[:3], chances[best], rtol=1e-5)
        np.testing.assert_allclose(point[:3], around[best] + chances[best], rtol=1e-5, atol=1e-5)
