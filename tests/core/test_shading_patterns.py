"""Procedural textures: no operand, however absurd, makes a number that is not one; what they are by definition."""

from itertools import product

import numpy as np
import pytest
from rayleaf import _core
from shading_support import UP, scalar

EXTREMES = (0.0, 1e30, -1e30, -1e-30, 3e38, -7.5, 0.3)
FRACTALS = ("FBM", "MULTIFRACTAL", "HYBRID_MULTIFRACTAL", "RIDGED_MULTIFRACTAL", "HETERO_TERRAIN")
FEATURES = ("F1", "F2", "SMOOTH_F1", "DISTANCE_TO_EDGE", "N_SPHERE_RADIUS")
GRADIENTS = ("LINEAR", "QUADRATIC", "EASING", "DIAGONAL", "SPHERICAL", "QUADRATIC_SPHERE", "RADIAL")

# Operation, count of operands, texts, integers.
OPERATIONS = [
    *(("noise", 9, "", [n, normal, kind]) for n, normal, kind in product((1, 2, 3, 4), (0, 1), range(5))),
    *(("musgrave", 8, kind, [n]) for kind, n in product(FRACTALS, (1, 2, 3, 4))),
    *(("voronoi", 9, kind, [n, m, r, 0, r]) for kind, n, m, r in product(FEATURES, (1, 2, 3, 4), range(4), (0, 1))),
    *(("voronoi", 9, kind, [n, 0, r, 1, 0]) for kind, n, r in product(FEATURES, (1, 2, 3, 4), (0, 1))),
    *(("white_noise", 2, "", [n]) for n in (1, 2, 3, 4)),
    *(("gradient", 1, kind, []) for kind in GRADIENTS),
    *(("wave", 7, kind, [s, axis]) for kind, s, axis in product(("SIN", "SAW", "TRI"), (0, 1), range(4))),
    *(("magic", 3, "", [depth]) for depth in (0, 5, 10)),
    *(("gabor", 6, "", [n]) for n in (2, 3)),
    *(("brick", 12, "", [every, squash]) for every, squash in ((0, 0), (2, 3), (99, 1))),
]


def extreme_program(identifier, count, text, ints):
    """A program of one operation with many operands that are too large, too small, or not finite."""
    program = _core.Program("Extreme")
    # What folds to a constant is made finite: these read the point.
    zero = program.operation("component", [program.operation("position")], [0])
    big = program.operation("math", [zero, scalar(program, 3e38)], [0], text="ADD")
    infinite = program.operation("math", [big, big], [0], text="ADD")
    numbers = [scalar(program, x) for x in EXTREMES]
    numbers += [infinite, program.operation("math", [infinite, infinite], [0], text="SUBTRACT")]
    chosen = np.random.default_rng(5).choice(len(numbers), (24, count))
    results = [program.operation(identifier, [numbers[i] for i in row], ints, text=text) for row in chosen]
    return program, results


@pytest.mark.parametrize("identifier, count, text, ints", OPERATIONS)
def test_operands_that_are_no_numbers_end_as_a_picture_of_numbers(identifier, count, text, ints):
    program, results = extreme_program(identifier, count, text, ints)
    one = scalar(program, 1.0)
    for result in results:
        program.operation("emission", [one, result, one])
    point = _core.shading.surface_points(np.zeros((1, 3), np.float32), UP[None], UP[None])
    assert np.isfinite(point.results(program)["emission"]).all()


# Operands beside the coordinate, as Blender has them.
DEFAULTS = {
    "noise": (0.3, 5.0, 2.0, 0.5, 0.1, 2.0, 0.0, 1.0),
    "musgrave": (0.3, 5.0, 2.5, 2.0, 2.0, 0.0, 1.0),
    "voronoi": (0.3, 5.0, 1.0, 0.5, 1.0, 2.6, 0.6, 2.1),
    "white_noise": (0.3,),
    "gradient": (),
    "wave": (5.0, 1.0, 2.0, 1.0, 0.5, 0.0),
    "magic": (5.0, 1.0),
    "gabor": (5.0, 2.0, 1.0, 0.7, 0.3),
    "brick": (0.8, 0.2, 0.0, 5.0, 0.02, 0.1, 0.0, 0.5, 0.25, 0.5, 1.0),
}


@pytest.mark.parametrize("identifier, count, text, ints", OPERATIONS)
def test_any_coordinate_gives_a_number(identifier, count, text, ints):
    program = _core.Program("Far")
    zero = program.operation("component", [program.operation("position")], [0])
    big = program.operation("math", [zero, scalar(program, 3e38)], [0], text="ADD")
    infinite = program.operation("math", [big, big], [0], text="ADD")
    nothing = program.operation("math", [infinite, infinite], [0], text="SUBTRACT")
    others = [scalar(program, x) for x in DEFAULTS[identifier]]
    assert len(others) == count - 1
    point = _core.shading.surface_points(np.zeros((1, 3), np.float32), UP[None], UP[None])
    for place in (infinite, nothing, big, *(scalar(program, x) for x in EXTREMES)):
        result = program.operation(identifier, [place, *others], ints, text=text)
        assert np.isfinite(point.values(program, result)).all()


def values(identifier, positions, operands, text="", ints=()):
    program = _core.Program("Texture")
    place = program.operation("position")
    result = program.operation(identifier, [place, *(scalar(program, x) for x in operands)], ints, text=text)
    up = np.tile(UP, (len(positions), 1))
    return _core.shading.surface_points(np.float32(positions), up, up).values(program, result)


def test_the_distance_of_a_cell_is_that_to_its_point():
    places = np.random.default_rng(1).uniform(-9, 9, (500, 3)).astype(np.float32)
    for feature in ("F1", "F2"):
        distance = values("voronoi", places, (0, 1, 0, 1, 1), feature, [3, 0, 0])[:, 3]
        point = values("voronoi", places, (0, 1, 0, 1, 1), feature, [3, 0, 1])[:, :3]
        np.testing.assert_allclose(distance, np.linalg.norm(places - point, axis=1), atol=2e-6)


def test_a_cells_border_lies_between_its_two_nearest_points():
    places = np.random.default_rng(2).uniform(-9, 9, (500, 3)).astype(np.float32)
    first, second = (values("voronoi", places, (0, 1, 0, 1, 1), f, [3, 0, 1])[:, :3] for f in ("F1", "F2"))
    border = values("voronoi", places, (0, 1, 0, 1, 1), "DISTANCE_TO_EDGE", [3, 0, 0])[:, 3]
    apart = second - first
    to_plane = np.einsum("ij,ij->i", (first + second) / 2 - places, apart) / np.linalg.norm(apart, axis=1)
    assert (border <= to_plane + 1e-5).all()
    assert np.isclose(border, to_plane, atol=1e-5).mean() > 0.6


def test_octaves_of_cells_add_up_and_the_last_may_be_a_fraction():
    places = np.random.default_rng(4).uniform(-9, 9, (200, 3)).astype(np.float32)
    octaves = [values("voronoi", places, (0, scale, 0, 1, 1), "F1", [3, 0, 0]) for scale in (1.0, 2.0, 4.0)]
    found = values("voronoi", places, (0, 1, 0, 1, 1, 1.25, 0.5, 2.0), "F1", [3, 0, 0])
    np.testing.assert_allclose(found, octaves[0] + 0.5 * octaves[1] + 0.25 * 0.25 * octaves[2], atol=2e-5)


@pytest.mark.parametrize("hash_function", (0, 1))
@pytest.mark.parametrize("feature", FEATURES[:4])
def test_normalized_cells_lie_in_the_unit_interval_and_reach_far_into_it(feature, hash_function):
    places = np.random.default_rng(5).uniform(-9, 9, (2000, 3)).astype(np.float32)
    ints = [3, 0, 0, 1, hash_function]
    distance = values("voronoi", places, (0, 1, 0.5, 1, 1, 2.5, 0.5, 2.0), feature, ints)[:, 3]
    assert -0.1 < distance.min() and 0.25 < distance.max() <= 1.0


def test_noise_of_later_blenders_is_musgraves_with_one_octave_more():
    places = np.random.default_rng(3).uniform(-9, 9, (200, 3)).astype(np.float32)
    for index, kind in enumerate(FRACTALS):
        noise = values("noise", places, (0, 1.5, 2.5, 0.5, 0, 2.0, 0.7, 1.3), "", [3, 0, index])[:, 3]
        musgrave = values("musgrave", places, (0, 1.5, 3.5, 1.0, 2.0, 0.7, 1.3), kind, [3])[:, 0]
        np.testing.assert_allclose(noise, musgrave, atol=1e-5, err_msg=kind)


def test_a_normalized_noise_is_its_sum_brought_to_the_unit_interval():
    places = np.random.default_rng(4).uniform(-9, 9, (200, 3)).astype(np.float32)
    plain, normal = (values("noise", places, (0, 1.5, 2, 0.5, 0, 2.3), "", [3, n, 0])[:, 3] for n in (0, 1))
    np.testing.assert_allclose(normal, 0.5 + 0.5 * plain / 1.75, atol=1e-6)


@pytest.mark.parametrize("dimensions", (2, 3))
def test_gabor_noise_is_a_wave_of_its_intensity_and_phase_and_stays_within_its_range(dimensions):
    places = np.random.default_rng(6).uniform(-90, 90, (20000, 3)).astype(np.float32)
    found = values("gabor", places, (1.0, 2.0, 0.0, 0.7, 0.3), ints=[dimensions])
    value, phase, intensity = found[:, 0], found[:, 1], found[:, 2]
    np.testing.assert_allclose(value, 0.5 - 0.5 * intensity * np.sin(2 * np.pi * phase), atol=2e-6)
    assert phase.min() >= 0 and phase.max() <= 1 and phase.std() == pytest.approx(12**-0.5, rel=0.02)
    # Half of the range 0..1 is six deviations, which Blender's constants estimate a fifth too small.
    assert value.mean() == pytest.approx(0.5, abs=0.003)
    assert value.std() * 12 == pytest.approx(1.2, abs=0.15)


def test_gabor_waves_run_along_their_orientation_with_their_frequency():
    start = np.random.default_rng(7).uniform(-9, 9, (2000, 3)).astype(np.float32)
    step, angle, frequency = 0.02, 0.7, 4.0
    flat = (1.0, frequency, 1.0, angle, 0.0)
    ways = {
        "along": (np.cos(angle), np.sin(angle), 0),
        "across": (-np.sin(angle), np.cos(angle), 0),
        "above": (0, 0, 1),
    }
    turns = {}
    for name, way in ways.items():
        ends = [values("gabor", start + k * step * np.float32(way), flat, ints=[2])[:, 1] for k in (0, 1)]
        turns[name] = np.median((ends[1] - ends[0] + 0.5) % 1 - 0.5) / step
    assert turns["along"] == pytest.approx(frequency, rel=0.05)
    assert abs(turns["across"]) < 0.2
    assert turns["above"] == 0
