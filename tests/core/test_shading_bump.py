"""Bumped normals, UDIM tiles, and lobes of cloth and cones: by definition, and with absurd input."""

import numpy as np
import pytest
from rayleaf import _core
from shading_support import UP, closures, program_with, scalar

STEP = 1e-3


def floor(places, step=STEP, **more):
    """Points of a flat floor seen from above, a pixel as wide as the step."""
    count = len(places)
    rows = lambda v: np.tile(np.float32(v), (count, 1))  # noqa: E731
    steps = dict(dp_dx=rows((step, 0, 0)), dp_dy=rows((0, step, 0)))
    return _core.shading.surface_points(np.float32(places), rows(UP), rows(UP), **steps, **more)


def bumped(height, strength=1.0, distance=1.0, invert=0, step=STEP):
    """The normals at the origin and beside it; `height` writes the operations from the position's register."""
    program = _core.Program("Bump")
    register = height(program, program.operation("position"))
    numbers = [scalar(program, strength), scalar(program, distance)]
    result = program.operation("bump", [register, *numbers], [invert])
    return floor([(0, 0, 0), (0.25, -0.5, 0)], step).values(program, result)[:, :3]


def slope(program, position):
    """0.3 x - 0.2 y."""
    factors = program.constant(0.3, -0.2, 0.0, 1.0)
    return program.operation("vector_math", [position, factors], text="DOT_PRODUCT")


def unit(*v):
    return np.array(v) / np.linalg.norm(v)


@pytest.mark.parametrize(
    "arguments, expected",
    [
        (dict(), unit(-0.3, 0.2, 1)),
        (dict(invert=1), unit(0.3, -0.2, 1)),
        (dict(distance=2.0), unit(-0.6, 0.4, 1)),
        (dict(distance=-1.0), unit(0.3, -0.2, 1)),
        (dict(strength=0.0), UP),
        (dict(strength=-3.0), UP),
        (dict(strength=0.5), unit(*(unit(-0.3, 0.2, 1) + UP))),
    ],
)
def test_a_slope_bends_the_normal_by_its_gradient(arguments, expected):
    np.testing.assert_allclose(bumped(slope, **arguments), np.tile(expected, (2, 1)), atol=2e-4)


@pytest.mark.parametrize("width", [1.0, 0.3, 0.1])
def test_heights_are_compared_over_the_width_that_is_set(width):
    """Ridges of a radian a pixel: the difference of heights over a step, not their derivative."""
    program = _core.Program("Ridges")
    program.bump_width = width
    along = program.operation("component", [program.operation("position")], [0])
    phase = program.operation("math", [along, scalar(program, 1.0 / STEP)], [0], text="MULTIPLY")
    height = program.operation("math", [phase], [0], text="SINE")
    numbers = [scalar(program, 1.0), scalar(program, 0.5 * STEP)]
    normals = floor([(0, 0, 0)]).values(program, program.operation("bump", [height, *numbers], [0]))[0, :3]
    # Steps lie at right angles to the diagonal of the axes: (-1, 1, 0) and (-1, -1, 0) here, over the root of 2.
    difference = 0.5 * np.sin(-np.sqrt(0.5) * width) / width
    gradient = -np.sqrt(0.5) * difference * np.array([1, -1, 0]) - np.sqrt(0.5) * difference * np.array([1, 1, 0])
    np.testing.assert_allclose(normals, unit(*(UP - gradient)), atol=2e-4)


@pytest.mark.parametrize("width", [0.0, -1.0, float("nan"), float("inf")])
def test_a_width_that_compares_nothing_is_named(width):
    with pytest.raises(_core.InputError, match="'Ridges': bump_width is .*, expected a positive number"):
        _core.Program("Ridges").bump_width = width


@pytest.mark.parametrize("width", [1.0, 0.1])
def test_images_keep_their_footprints_whatever_the_width_of_bumps(width):
    """Stripes of a texel: a step of eight shows their mean, though heights are compared over less."""
    store = _core.shading.TextureStore(1 << 27)
    stripes = np.zeros((128, 128, 1), np.float32)
    stripes[:, ::2] = 1
    texture = store.add_pixels("Stripes", stripes, _core.shading.ColorSpace.NON_COLOR)
    program = _core.Program("Both")
    program.bump_width = width
    place = program.operation("position")
    texel = program.operation("image", [place], [texture, 0, 0])
    program.operation("bump", [slope(program, place), scalar(program, 1.0), scalar(program, 1.0)], [0])
    sharp, wide = (
        floor([(64.5 / 128, 0.5, 0)], step / 128, textures=store).values(program, texel)[0, 0] for step in (0.5, 8)
    )
    assert abs(sharp - 0.5) > 0.4
    assert abs(wide - 0.5) < 0.05


@pytest.mark.parametrize("step", [0.0, 1e-30, 1e30, float("inf"), float("nan")])
@pytest.mark.parametrize("distance", [0.0, 1e30, -3e38])
def test_absurd_footprints_and_distances_give_unit_normals(step, distance):
    found = bumped(slope, distance=distance, step=step)
    np.testing.assert_allclose(np.linalg.norm(found, axis=1), 1.0, atol=1e-5)


def test_a_height_that_is_no_number_leaves_the_normal_alone():
    def nothing(program, position):
        big = program.operation("vector_math", [position, program.constant(3e38, 3e38, 3e38, 1)], text="ADD")
        infinite = program.operation("vector_math", [big, big], text="ADD")
        return program.operation("vector_math", [infinite, infinite], text="SUBTRACT")

    np.testing.assert_array_equal(bumped(nothing), np.tile(UP, (2, 1)))


def test_a_udim_coordinate_finds_its_tile_and_a_missing_one_is_pink():
    store = _core.shading.TextureStore(1 << 24)
    space = _core.shading.ColorSpace.LINEAR
    tiles = {}
    for number, value in ((1001, 0.25), (1002, 0.5), (1011, 0.75)):
        tiles[number] = store.add_pixels(f"tile {number}", np.full((2, 2, 4), value, np.float32), space)
    program = _core.Program("Tiles")
    pairs = [number for pair in tiles.items() for number in pair]
    result = program.operation("image", [program.operation("position")], [tiles[1001], 0, 0, 0, *pairs])
    places = [(0.5, 0.5, 0), (1.5, 0.5, 0), (0.5, 1.5, 0), (1.5, 1.5, 0), (-0.5, 0.5, 0), (1e30, 0.5, 0)]
    found = floor(places, textures=store).values(program, result)
    np.testing.assert_allclose(found[:3, 0], (0.25, 0.5, 0.75), atol=1e-3)
    np.testing.assert_array_equal(found[3:], np.tile(np.float32((1, 0, 1, 1)), (3, 1)))


LOBES = [
    ("velvet", (1.0, (0.8, 0.5, 0.3), 0.4, None), ""),
    ("toon", (1.0, (0.8, 0.5, 0.3), 0.5, 0.0, None), "DIFFUSE"),
    ("toon", (1.0, (0.8, 0.5, 0.3), 0.3, 0.2, None), "GLOSSY"),
]


@pytest.mark.parametrize("identifier, operands, text", LOBES)
def test_what_a_lobe_samples_adds_up_to_what_it_evaluates(identifier, operands, text):
    """The mean of weights is the integral of the value over the hemisphere."""
    program = program_with(identifier, operands, text)
    out = np.float32([[0.6, 0.0, 0.8]])
    closures = _core.shading.surface_points(np.zeros((1, 3), np.float32), UP[None], out).closures(program, 0)
    random = np.random.default_rng(2).random((40000, 3)).astype(np.float32)
    sampled = closures.sample(outgoing=out[0], facet_normal=UP, random=random)
    weights = np.where(sampled["valid"][:, None], sampled["weight"], 0.0).mean(0)
    cosine, azimuth = (np.mgrid[:400, :400] + 0.5) / 400
    sine, angle = np.sqrt(1 - cosine**2), 2 * np.pi * azimuth
    incoming = np.stack([sine * np.cos(angle), sine * np.sin(angle), cosine], -1).reshape(-1, 3).astype(np.float32)
    value = np.asarray(closures.evaluate(outgoing=out[0], incoming=incoming, facet_normal=UP))
    np.testing.assert_allclose(weights, value.reshape(-1, 3).mean(0) * 2 * np.pi, rtol=0.02)


@pytest.mark.parametrize("number", [0.0, 1e30, -1e30, 3e38])
def test_lobes_of_absurd_numbers_are_finite(number):
    for identifier, operands, text in LOBES:
        absurd = [operands[0], operands[1], *(number for _ in operands[2:-1]), None]
        program = program_with(identifier, absurd, text)
        closures = _core.shading.surface_points(np.zeros((1, 3), np.float32), UP[None], UP[None]).closures(program, 0)
        random = np.random.default_rng(3).random((200, 3)).astype(np.float32)
        sampled = closures.sample(outgoing=UP, facet_normal=UP, random=random)
        assert np.isfinite(np.asarray(sampled["weight"])[np.asarray(sampled["valid"])]).all()


@pytest.mark.parametrize("tilt", (0.2, 0.5, 0.75))
def test_a_bump_is_in_the_shadow_of_the_smooth_surface(tilt):
    """Chiang, Li, Burley (2019): Lambert's law of the bumped normal, times -g^3 + g^2 + g, where g compares the cosines."""
    bent, outgoing = np.float32((np.sin(tilt), 0, np.cos(tilt))), np.float32((0, 0, 1))
    lobes = closures(program_with("diffuse", [1.0, (1.0, 1.0, 1.0), 0.0, tuple(map(float, bent))]), outgoing)
    angles = np.linspace(-1.5, 1.5, 61)
    incoming = np.stack([np.sin(angles), 0 * angles, np.cos(angles)], 1).astype(np.float32)
    lambert = np.maximum(incoming @ bent, 0.0)
    with np.errstate(divide="ignore"):
        g = np.clip(np.where(lambert > 0, incoming[:, 2] / (lambert * bent[2]), 0.0), 0.0, 1.0)
    expected = lambert / np.pi * (g + g**2 - g**3)
    assert (g < 0.5).any() and (g == 1.0).any()
    np.testing.assert_allclose(lobes.evaluate(outgoing, incoming, UP)[:, 0], expected, rtol=1e-4, atol=1e-6)


@pytest.mark.parametrize("tilt", (0.2, 0.5, 0.75))
def test_a_bump_is_in_the_shadow_of_facets_as_rough_as_it_leans(tilt):
    """Conty Estevez, Lecocq, Stein (2019): Lambert's law of the bumped normal, times Smith's term of GGX for a roughness
    by the bump's lean; nothing where the smooth surface is not lit."""
    bent, outgoing = np.float32((np.sin(tilt), 0, np.cos(tilt))), np.float32((0, 0, 1))
    program = program_with("diffuse", [1.0, (1.0, 1.0, 1.0), 0.0, tuple(map(float, bent))], bump_shadow="FACETS")
    angles = np.linspace(-1.5, 1.5, 61)
    incoming = np.stack([np.sin(angles), 0 * angles, np.cos(angles)], 1).astype(np.float32)
    lambert = np.maximum(incoming @ bent, 0.0)
    alpha2 = np.tan(tilt) ** 2 / 8
    expected = lambert / np.pi * 2 / (1 + np.sqrt(1 + alpha2 * np.tan(angles) ** 2))
    found = closures(program, outgoing).evaluate(outgoing, incoming, UP)[:, 0]
    np.testing.assert_allclose(found, expected, rtol=1e-4, atol=1e-6)


def test_without_bump_shadow_a_bump_follows_lamberts_law():
    bent, outgoing = np.float32((0.6, 0, 0.8)), np.float32((0, 0, 1))
    program = program_with("diffuse", [1.0, (1.0, 1.0, 1.0), 0.0, (0.6, 0.0, 0.8)], bump_shadow="NONE")
    incoming = np.float32([(np.sin(angle), 0, np.cos(angle)) for angle in np.linspace(-1.5, 1.5, 31)])
    found = closures(program, outgoing).evaluate(outgoing, incoming, UP)[:, 0]
    np.testing.assert_allclose(found, np.maximum(incoming @ bent, 0.0) / np.pi, rtol=1e-5, atol=1e-7)


def tops_of(identifier, operands, clearing, outgoing, text=""):
    """The directions in which the lobes of bent normals are brightest, of many that lie in the plane of the bend."""
    program = program_with(identifier, operands, text, bump_shadow="NONE", clearing=clearing)
    angles = np.linspace(-1.57, 1.57, 4001)
    incoming = np.stack([np.sin(angles), 0 * angles, np.cos(angles)], 1).astype(np.float32)
    return angles[np.argmax(closures(program, outgoing).evaluate(outgoing, incoming, UP)[:, 0])]


def test_matte_normals_stay_where_mirrors_alone_must_clear_the_facet():
    """A normal that leans by 1.2 is seen from the other side at 0.6: N.V < 0, and its mirror would look into the surface."""
    lean, outgoing = 1.2, np.float32((-np.sin(0.6), 0, np.cos(0.6)))
    bent = (float(np.sin(lean)), 0.0, float(np.cos(lean)))
    diffuse, glossy = ("diffuse", [1.0, 1.0, 0.0, bent]), ("glossy", [1.0, 1.0, 0.3, bent])
    kept = {clearing: tops_of(*diffuse, clearing, outgoing) for clearing in ("ALL", "MIRRORS", "NONE")}
    assert kept["MIRRORS"] == kept["NONE"] == pytest.approx(lean, abs=1e-3)
    assert kept["ALL"] < 0.6
    # What mirrors is turned back until it is brightest just above the facet; as bent it shows nothing.
    assert tops_of(*glossy, "ALL", outgoing, "GGX") == tops_of(*glossy, "MIRRORS", outgoing, "GGX") > 1.3
    untouched = program_with(*glossy, "GGX", bump_shadow="NONE", clearing="NONE")
    incoming = np.float32([(np.sin(angle), 0, np.cos(angle)) for angle in np.linspace(-1.5, 1.5, 31)])
    assert not closures(untouched, outgoing).evaluate(outgoing, incoming, UP).any()


def test_a_bump_does_not_fade_where_the_surface_is_seen_at_grazing():
    """Its steps are as wide as the ray, not as its footprint, which is long there."""
    width, cosine = 0.5, 0.2
    program = _core.Program("Bump")
    height = program.operation(
        "math", [slope(program, program.operation("position")), scalar(program, 0.0)], text="SINE"
    )
    result = program.operation("bump", [height, scalar(program, 0.3), scalar(program, 1.0)], [0])

    def seen(outgoing, dp_dx):
        rows = [np.float32([row]) for row in ((0.4, 0.3, 0), UP, outgoing, dp_dx, (0, width, 0))]
        points = _core.shading.surface_points(rows[0], rows[1], rows[2], dp_dx=rows[3], dp_dy=rows[4])
        return points.values(program, result)[0, :3]

    from_above, aslant = seen(UP, (width, 0, 0)), seen((np.sqrt(1 - cosine**2), 0, cosine), (width / cosine, 0, 0))
    assert from_above[2] < 0.998
    np.testing.assert_allclose(aslant, from_above, atol=1e-5)
