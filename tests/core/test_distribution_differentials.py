"""The differentials of scattered and shadow rays against finite differences of neighbouring rays, and their numbers."""

import numpy as np
import pytest
from path_scenes import lit_plane, material, render
from rayleaf import _core
from scenes import look_down, matrix, quad
from shading_support import closures, principled, program_with
from test_ray_differentials import CENTRE, RADIUS, camera_direction, difference, reflect, refract, sphere_hit, unit

distribution = _core.distribution
UP = np.array([0.0, 0, 1])


def area(rows):
    """Of the parallelogram of the two direction vectors, steradians."""
    return np.linalg.norm(np.cross(rows[2], rows[3]))


def sampled_area(direction, random, h=1e-3):
    """Steradians that a unit square of random numbers makes around `random`, by central differences."""
    x, y = np.array([h, 0]), np.array([0, h])
    along = [(direction(random + step) - direction(random - step)) / (2 * h) for step in (x, y)]
    return np.linalg.norm(np.cross(*along))


NARROW = [[1e-4, 0, 0], [0, 1e-4, 0], [1e-5, 0, 0], [0, 1e-5, 0]]


def cosine_direction(random):
    sine, angle = np.sqrt(random[0]), 2 * np.pi * random[1]
    return np.array([sine * np.cos(angle), sine * np.sin(angle), np.sqrt(1 - random[0])])


@pytest.mark.parametrize("random", [(0.1, 0.2), (0.5, 0.6), (0.9, 0.8)])
@pytest.mark.parametrize("rays", [16, 256])
def test_a_hemisphere_ray_has_its_share_of_what_the_random_numbers_are_mapped_to(random, rays):
    random = np.array(random)
    direction = cosine_direction(random)
    rows = distribution.hemisphere_differential(NARROW, direction, direction[2], rays)
    assert area(rows) == pytest.approx(sampled_area(cosine_direction, random) / rays, rel=1e-3)
    # Square, and at right angles to the ray: rays near the pole are narrower than those near the horizon.
    assert np.linalg.norm(rows[2]) == pytest.approx(np.sqrt(np.pi / (rays * direction[2])), rel=1e-4)
    assert np.abs(np.array(rows[2:]) @ direction).max() < 1e-6
    np.testing.assert_allclose(rows[:2], NARROW[:2])


@pytest.mark.parametrize("roughness", [0.3, 0.6, 0.9])
def test_a_glossy_ray_has_its_share_of_the_lobe(roughness):
    outgoing = unit(np.array([0.3, 0.1, 1.0]))
    lobe = closures(program_with("glossy", [1.0, 1.0, roughness], "GGX"), outgoing)

    def at(random):
        sample = lobe.sample(outgoing, UP, np.float32([[*random, 0.5]]))
        return np.float64(sample["direction"][0]), float(sample["density"][0])

    for random in ((0.1, 0.3), (0.3, 0.7), (0.4, 0.1)):
        direction, density = at(random)
        measured = sampled_area(lambda r: at(r)[0], np.array(random), h=4e-3)
        # Sampling is in single precision.
        assert 1 / density == pytest.approx(measured, rel=0.05)
        surface = [UP, [1, 0, 0], [0, 1, 0], [0, 0, 0], [0, 0, 0]]
        rows = distribution.glossy_differential(NARROW, -outgoing, surface, direction, density, 1.0, 64)
        assert area(rows) == pytest.approx(measured / 64, rel=0.05)


@pytest.mark.parametrize("kind", ["mirror", "glass"])
@pytest.mark.parametrize("x,y", [(0.0, 0.0), (0.1, 0.2), (-0.25, 0.1)])
def test_singular_rays_from_a_sphere_match_neighbouring_rays_and_gloss_is_never_narrower(x, y, kind):
    d = camera_direction(x, y)
    normal = sphere_hit(d)[2]
    dp = [difference(lambda a, b: sphere_hit(camera_direction(a, b))[1], x, y, axis) for axis in (0, 1)]
    dd = [difference(camera_direction, x, y, axis) for axis in (0, 1)]
    # Any parametrization of the sphere will do: its derivatives span the tangent plane.
    tangent = unit(np.cross(normal, [0.3, 1, 0.2]))
    u, v = tangent * 2.0, np.cross(normal, tangent) * 0.5 + tangent * 0.3
    surface = [normal, u, v, u / RADIUS, v / RADIUS]
    bend = reflect if kind == "mirror" else refract
    eta = 1.0 if kind == "mirror" else 1 / 1.45

    def after(a, b):
        incoming = camera_direction(a, b)
        return bend(incoming, sphere_hit(incoming)[2])

    rows = distribution.glossy_differential([*dp, *dd], d, surface, after(x, y), 0.0, eta, 1)
    expected = [difference(after, x, y, axis) for axis in (0, 1)]
    # Single precision; central differences of step 1e-5.
    np.testing.assert_allclose(rows[2:], expected, rtol=5e-3, atol=5e-3)
    widest = max(np.linalg.norm(row) for row in expected)
    for density in (0.1, 10.0, 1e6):
        rows = distribution.glossy_differential([*dp, *dd], d, surface, after(x, y), density, eta, 16)
        wanted = max(widest, min(1.0, (16 * density) ** -0.5))
        assert max(np.linalg.norm(row) for row in rows[2:]) == pytest.approx(wanted, rel=5e-3)


def test_a_path_s_rays_open_by_a_global_value_and_mirrors_as_their_curvature_says():
    d, surface = unit(np.array([0.3, 0.1, -1.0])), [UP, [1, 0, 0], [0, 1, 0], [0.4, 0, 0], [0, 0.4, 0]]
    incoming = [[1e-3, 0, 0], [0, 1e-3, 0], [2e-3, 0, 0], [0, 2e-3, 0]]
    mirrored = reflect(d, UP)

    def opening(roughness, diffuse):
        rows = distribution.path_differential(incoming, d, surface, mirrored, roughness, diffuse)
        np.testing.assert_array_equal(rows[:2], np.float32(incoming[:2]))
        return max(np.linalg.norm(row) for row in rows[2:])

    # A sixteenth of a cosine-weighted hemisphere, at its pole; a rough lobe's share grows with its roughness.
    widest = opening(1.0, True)
    assert widest == pytest.approx(np.sqrt(np.pi / 16), rel=0.15)
    assert [opening(r, False) for r in (0.5, 1.0)] == pytest.approx([0.5 * widest, widest], rel=1e-5)
    as_traced = distribution.glossy_differential(incoming, d, surface, mirrored, 0.0, 1.0, 1)
    np.testing.assert_array_equal(distribution.path_differential(incoming, d, surface, mirrored, 0.0, False), as_traced)
    assert opening(0.0, False) < opening(0.01, False) + 1e-6 < widest


def test_rays_to_a_point_light_draw_together_there():
    lamp = np.array([0.3, -0.2, 2.0])
    dp = [np.array([1e-3, 2e-4, 0]), np.array([0, 1e-3, 0])]
    rows = distribution.shadow_differential([*dp, [1, 0, 0], [0, 1, 0]], unit(lamp), np.linalg.norm(lamp), 1.0, True, 4)
    for axis in (0, 1):
        # Quadratic terms are a thousandth here.
        np.testing.assert_allclose(rows[2 + axis], unit(lamp - dp[axis]) - unit(lamp), rtol=5e-3, atol=2e-7)
    ends = np.array(rows[:2]) + np.array(rows[2:]) * np.linalg.norm(lamp)
    along = np.outer(np.array(dp) @ unit(lamp), unit(lamp))
    np.testing.assert_allclose(ends, along, atol=1e-6)  # nothing left across the ray


@pytest.mark.parametrize("kind", ["RECTANGLE", "DISK", "POINT"])
def test_rays_to_a_light_with_a_size_share_what_it_covers(core, kind):
    scene = lit_plane(core)
    size = dict(radius=0.5) if kind == "POINT" else dict(size_x=1.0, size_y=0.8)
    scene.add_lamp("lamp", kind, matrix((0.5, 0.3, 2)), (50,) * 3, **size)
    probe = core.LightProbe(scene)

    def at(random):
        sample = probe.sample(np.zeros(3), np.float32([random]))
        return np.float64(sample["direction"][0]), float(sample["density"][0])

    random = np.array([0.4, 0.6])
    direction, density = at(random)
    measured = sampled_area(lambda r: at(r)[0], random, h=1e-2)
    rows = distribution.shadow_differential(NARROW, direction, 2.0, density, False, 16)
    # Directions are in single precision; the maps bend within a step.
    assert area(rows) == pytest.approx(measured / 16, rel=0.05)


def test_a_glossy_principled_surface_gives_wider_rays_the_rougher_it_is():
    outgoing = unit(np.array([0.3, 0.1, 1.0]))
    widths = []
    for roughness in (0.2, 0.4, 0.8):
        lobe = closures(principled(metallic=1.0, roughness=roughness), outgoing)
        random = np.random.default_rng(1).random((64, 3)).astype(np.float32) * np.float32(0.999)
        sample = lobe.sample(outgoing, UP, random)
        surface = [UP, [1, 0, 0], [0, 1, 0], [0, 0, 0], [0, 0, 0]]
        rows = [
            distribution.glossy_differential(NARROW, -outgoing, surface, d, p, 1.0, 16)
            for d, p in zip(sample["direction"], sample["density"], strict=True)
            if p > 0
        ]
        widths.append(np.median([np.sqrt(area(r)) for r in rows]))
    assert widths[0] < widths[1] < widths[2]


def test_sub_rays_of_all_samples_of_a_pixel_are_stratified_together():
    pairs = distribution.branch_pairs(17, 16, 16, 5, 9).reshape(256, 2)
    # A (0, 2)-sequence: 256 points put one into each of 256 boxes of every shape of equal area.
    for columns in (1, 4, 16, 64, 256):
        boxes = (pairs * [columns, 256 // columns]).astype(int)
        assert len({tuple(box) for box in boxes}) == 256, columns
    own = distribution.branch_pairs(17, 16, 16, 5, 9)[3]
    boxes = (own * 4).astype(int)
    assert len({tuple(box) for box in boxes}) == 16  # those of one sample among themselves, too


def textured_floor(core, kind):
    """A white roof that faces the camera, above a floor of fine black and white squares: an image, or computed."""
    scene = core.SceneDescription()
    program = core.Program("squares")
    one, zero, scale = program.constant(1, 1, 1, 1), program.constant(0, 0, 0, 1), program.constant(*[0.5] * 4)
    place = program.operation("position")
    if kind == "image":
        squares = np.repeat((np.indices((64, 64)).sum(0) % 2)[..., None], 3, 2).astype(np.float32)
        texture = scene.add_image_pixels("squares", squares, "LINEAR")
        place = program.operation("vector_math", [place, scale], text="MULTIPLY")
        color = program.operation("image", [place], [texture, 0, 0])
    else:
        color = program.operation("checker", [place, one, zero, program.constant(*[32.0] * 4)])
    program.operation("diffuse", [one, color])
    floor = scene.add_material_list([scene.add_material("squares", program)])
    facing_down = np.diag([1.0, -1, -1, 1])
    scene.add_instance("floor", quad(scene, "floor", 50), matrix((0, 0, 8)) @ facing_down, floor, visibility=30)
    scene.add_instance("roof", quad(scene, "roof", 50), matrix(), material(core, scene, ("diffuse", 1.0, 1.0)))
    scene.add_lamp("lamp", "RECTANGLE", matrix((0, 0, 4)) @ facing_down, (1e3,) * 3, size_x=90.0, size_y=90.0)
    look_down(scene, height=3, half=0.001)
    return scene


def test_wide_rays_see_a_texture_filtered_as_wide(core):
    """Hemisphere rays find black or white squares where nothing filters them; images are filtered by their width."""
    noise, mean = {}, {}
    for kind in ("image", "computed"):
        settings = dict(integrator="DISTRIBUTION", samples=1, size=16, hemisphere_rays=16, light_rays=1)
        session = render(core, textured_floor(core, kind), passes=["diffuse_indirect"], **settings)
        image = session.pass_pixels("diffuse_indirect")
        noise[kind], mean[kind] = image.std() / image.mean(), image.mean()
    # Sixteen rays that find 0 or 1 leave a quarter; what is left with the image is the lamp's.
    assert noise["computed"] > 0.15 and noise["image"] < noise["computed"] / 4, noise
    assert mean["image"] == pytest.approx(mean["computed"], rel=0.05)
