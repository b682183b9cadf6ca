"""Participating media: closed forms, both integrators, streams, and input that nobody wants."""

import numpy as np
import pytest
from path_scenes import ALL_PASSES, lit_plane, material, picture, render, varied_scene
from scenes import CUBE_TRIANGLES, CUBE_VERTICES, background, emission, look_down, matrix, sphere_spline

WHITE = (1.0, 1.0, 1.0)


def medium(core, *closures):
    """A program of the sum of (operation, arguments…); a string names an input operation, of which x counts."""
    program = core.Program("medium")

    def operand(value):
        if isinstance(value, str):
            return program.operation("component", [program.operation(value)], [0])
        return program.constant(*(value if isinstance(value, tuple) else (value,) * 3), 1.0)

    for operation, *arguments in closures:
        program.operation(operation, [operand(each) for each in arguments])
    return program


def absorbing(core, left=(0.2, 0.5, 0.9), density=1.0):
    return medium(core, ("volume_absorption", 1.0, left, density))


def scattering(core, color=(0.9, 0.6, 0.3), density=1.0, g=0.3):
    return medium(core, ("volume_scatter", 1.0, color, density, g))


def add_box(core, scene, program, place=(0, 0, 0), scale=1.0, surface=None, name="box"):
    """A cube of twice `scale` that holds a medium."""
    box = scene.add_mesh(name, CUBE_VERTICES, CUBE_TRIANGLES)
    materials = scene.add_material_list([scene.add_material(name, surface, medium=program)])
    scene.add_instance(name, box, matrix(place, scale), materials)


def in_front_of_the_world(core, *programs, world=WHITE):
    """Boxes of media two units deep, one behind the other, before a world."""
    scene = core.SceneDescription()
    for i, program in enumerate(programs):
        add_box(core, scene, program, (0, 0, -3.0 * i), name=f"box {i}")
    scene.set_world(background(core, world), 0)
    look_down(scene, half=0.05)
    return scene


INTEGRATORS = ["PATH", "DISTRIBUTION"]


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_absorption_is_beers_law(core, integrator):
    scene = in_front_of_the_world(core, absorbing(core, density=0.7), absorbing(core, (0.9, 0.9, 0.1), 0.2))
    expected = np.exp(-2.0 * (0.7 * np.array([0.8, 0.5, 0.1]) + 0.2 * np.array([0.1, 0.1, 0.9])))
    image = picture(core, scene, samples=2, integrator=integrator)
    np.testing.assert_allclose(image, np.broadcast_to(expected, image.shape), rtol=3e-3)  # rays slant


def uneven(core, kind, closure, color):
    """A medium whose density depends on the height above its box's bottom, 0 to 1, and the mean of that."""
    program = core.Program("medium")
    one, zero = program.constant(1, 1, 1, 1), program.constant(0, 0, 0, 0)
    amount = program.operation("component", [program.operation("generated")], [2])

    def math(name, value):
        return program.operation("math", [amount, program.constant(*[value] * 4)], [0], text=name)

    if kind == "layers":  # with nothing between them
        amount = math("MULTIPLY", 8 * np.pi)
        amount = math("SINE", 0)
        amount = math("MAXIMUM", 0)
        mean = 1 / np.pi
    if kind == "slots":  # narrower than whatever is looked up before the picture
        amount = math("MULTIPLY", 240)
        amount = math("FRACT", 0)
        amount = math("LESS_THAN", 0.5)
        amount = math("MULTIPLY", 0.5)
        mean = 0.25
    if kind == "slope":
        mean = 0.5
    program.operation(closure, [one, program.constant(*color, 1), amount, *[zero] * (closure == "volume_scatter")])
    return program, mean


KINDS = ["slope", "layers", "slots"]


@pytest.mark.parametrize("integrator", INTEGRATORS)
@pytest.mark.parametrize("kind", KINDS)
def test_an_uneven_medium_absorbs_by_its_integral(core, integrator, kind):
    program, mean = uneven(core, kind, "volume_absorption", (0.5, 0.0, 1.0))
    image = picture(core, in_front_of_the_world(core, program), samples=4000, size=2, integrator=integrator)
    np.testing.assert_allclose(image.mean((0, 1)), np.exp(-2 * mean * np.array([0.5, 1.0, 0.0])), rtol=0.02)


@pytest.mark.slow
@pytest.mark.parametrize("integrator", INTEGRATORS)
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("color", [WHITE, (1.0, 0.6, 0.2)], ids=["grey", "coloured"])
def test_an_uneven_medium_that_loses_nothing_is_invisible_in_even_light(core, integrator, kind, color):
    program, _ = uneven(core, kind, "volume_scatter", color)
    settings = dict(samples=4096, size=4, max_bounces=200, volume_bounces=200, roulette_start=200)
    image = picture(core, in_front_of_the_world(core, program), integrator=integrator, **settings)
    np.testing.assert_allclose(image.mean((0, 1)), 1.0, atol=1e-2)


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_a_medium_that_loses_nothing_is_invisible_in_even_light(core, integrator):
    """Whatever is scattered away from a ray is scattered into it."""
    program = scattering(core, WHITE, 0.8, 0.5)
    settings = dict(samples=1024, size=4, max_bounces=200, volume_bounces=200, roulette_start=200)
    image = picture(core, in_front_of_the_world(core, program), integrator=integrator, **settings)
    np.testing.assert_allclose(image.mean(), 1.0, atol=5e-3)


def test_emission_grows_with_the_way_and_dims_by_absorption(core):
    program = medium(core, ("emission", 1.0, (0.5, 0.2, 0.1), 1.0), ("volume_absorption", 1.0, (0.0, 0.5, 1.0), 1.0))
    image = picture(core, in_front_of_the_world(core, program, world=(0, 0, 0)), samples=2)
    extinction = np.array([1.0, 0.5, 1e-9])
    expected = np.array([0.5, 0.2, 0.1]) * -np.expm1(-2.0 * extinction) / extinction
    np.testing.assert_allclose(image, np.broadcast_to(expected, image.shape), rtol=2e-3)


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_shadows_are_as_dark_as_the_medium(core, integrator):
    lit, dimmed = lit_plane(core), lit_plane(core)
    for scene in (lit, dimmed):
        scene.add_lamp("sun", "SUN", matrix(), WHITE)
    add_box(core, dimmed, absorbing(core, (0.5, 0.5, 0.5), 1.0), (0, 0, 20), 8.0)
    images = [picture(core, scene, samples=2, integrator=integrator) for scene in (lit, dimmed)]
    np.testing.assert_allclose(images[1], images[0] * np.exp(-0.5 * 16.0), rtol=5e-3)


# Beside the camera's ray, which goes down the z axis from 1 to -1; with the irradiance at points below on that axis.
BESIDE = np.array([0.5, 0.0, 0.2])


def of_points(intensity):
    """The irradiance of a lamp of `intensity`, W/sr, by the direction from it."""

    def at(points):
        way = points - BESIDE
        distance = np.linalg.norm(way, axis=1)
        return intensity(way / distance[:, None]) / distance**2

    return at


def within_spot(direction):
    cosine = -direction[:, 0]
    return np.where(cosine > np.cos(0.4), cosine, 0.0) / (4 * np.pi)


TOWARDS_AXIS = np.array([[0, 0, 1, 0.5], [0, 1, 0, 0], [-1, 0, 0, 0.2], [0, 0, 0, 1.0]])  # lamps shine along -z
LIGHTS = {
    "point": (dict(kind="POINT"), of_points(lambda direction: 1 / (4 * np.pi))),
    "sphere": (dict(kind="POINT", radius=0.003), of_points(lambda direction: 1 / (4 * np.pi))),
    "spot": (dict(kind="SPOT", spot_size=0.8), of_points(within_spot)),
    "wide spot": (dict(kind="SPOT", spot_size=0.8, radius=0.003), of_points(within_spot)),
    "rectangle": (
        dict(kind="RECTANGLE", size_x=0.02, size_y=0.02),
        of_points(lambda direction: np.maximum(-direction[:, 0], 0.0) / 4),
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize("density", [0.2, 1.5])
@pytest.mark.parametrize("uneven", [False, True])
@pytest.mark.parametrize("names", [[name] for name in LIGHTS] + [list(LIGHTS), ["point"] * 12], ids="+".join)
def test_light_scattered_once_is_its_integral(core, names, uneven, density):
    """`uneven`: the same everywhere, but the medium's program does not know."""
    program = core.Program("medium")
    one, zero = program.constant(1, 1, 1, 1), program.constant(0, 0, 0, 0)
    amount = program.constant(*[density] * 4)
    if uneven:
        height = program.operation("component", [program.operation("generated")], [2])
        nothing = program.operation("math", [height, zero], [0], text="MULTIPLY")
        amount = program.operation("math", [amount, nothing], [0], text="ADD")
    program.operation("volume_scatter", [one, one, amount, zero])
    scene = core.SceneDescription()
    add_box(core, scene, program)
    look_down(scene, half=1e-4)
    z = (np.arange(20000) + 0.5) / 10000 - 1
    points = np.stack([0 * z, 0 * z, z], 1)
    way = np.linalg.norm(points - BESIDE, axis=1)
    expected = 0.0
    for i, name in enumerate(names):
        lamp, irradiance = LIGHTS[name]
        scene.add_lamp(name=str(i), matrix=TOWARDS_AXIS, strength=WHITE, **lamp)
        light = irradiance(points) * np.exp(-density * (way + 1 - z))
        expected += light.mean() * 2 * density / (4 * np.pi)
    image = picture(core, scene, samples=4096, size=4, volume_bounces=0)
    np.testing.assert_allclose(image.mean(), expected, rtol=0.03)  # noise


@pytest.mark.slow
@pytest.mark.parametrize("integrator", INTEGRATORS)
@pytest.mark.parametrize("kind", ["POINT", "SPOT"])
@pytest.mark.parametrize("density, g", [(0.3, 0.0), (0.8, 0.4)])
def test_a_lamp_lights_a_medium_as_many_that_share_its_power(core, integrator, kind, density, g):
    """Of many lamps none is known to a path while it is scattered."""
    means = []
    for count in (1, 12):
        scene = core.SceneDescription()
        add_box(core, scene, scattering(core, (0.9, 0.8, 0.5), density, g))
        look_down(scene, half=0.05)
        for i in range(count):
            scene.add_lamp(str(i), kind, TOWARDS_AXIS, (10.0 / count,) * 3, spot_size=0.8)
        settings = dict(samples=512, size=16, volume_bounces=3, integrator=integrator)
        means.append(picture(core, scene, **settings).mean((0, 1)))
    np.testing.assert_allclose(means[0], means[1], rtol=0.04)  # noise


@pytest.mark.slow
@pytest.mark.parametrize("integrator", INTEGRATORS)
@pytest.mark.parametrize("clear", ["medium", "surface"])
def test_borders_that_hold_nothing_back_leave_the_light_of_surfaces_as_it_is(core, integrator, clear):
    def lit(has_box):
        scene = lit_plane(core)
        glow = scene.add_material_list([scene.add_material("glow", emission(core, strength=20.0))])
        cube = scene.add_mesh("glow", CUBE_VERTICES, CUBE_TRIANGLES)
        scene.add_instance("glow", cube, matrix((0.6, 0.3, 1.5), 0.15), glow, visibility=62)
        if has_box and clear == "medium":
            add_box(core, scene, absorbing(core, density=1e-9), (0, 0, 1.4), 1.0)
        elif has_box:
            box = scene.add_mesh("box", CUBE_VERTICES, CUBE_TRIANGLES)
            scene.add_instance("box", box, matrix((0, 0, 1.4), 1.0), material(core, scene, ("transparent", 1.0, 1.0)))
        look_down(scene, height=5, half=0.4)
        return picture(core, scene, samples=256, integrator=integrator)

    np.testing.assert_allclose(lit(True).mean(), lit(False).mean(), rtol=0.03)  # noise


def test_media_that_overlap_add_up(core):
    once = in_front_of_the_world(core, medium(core, *[("volume_absorption", 1.0, 0.5, 1.0)] * 2))
    twice = in_front_of_the_world(core, absorbing(core, (0.5,) * 3))
    add_box(core, twice, absorbing(core, (0.5,) * 3), scale=1.0, place=(0.01, 0.02, 0.01), name="other")
    np.testing.assert_allclose(picture(core, twice, samples=2), picture(core, once, samples=2), rtol=1e-4)


def test_a_camera_inside_sees_the_medium_around_it(core):
    scene = in_front_of_the_world(core)
    add_box(core, scene, absorbing(core, (0.5,) * 3, 1.0), (0, 0, 5.0), 2.0)
    image = picture(core, scene, samples=2)
    np.testing.assert_allclose(image, np.exp(-0.5 * (2.0 - 0.01)), rtol=3e-3)  # seen from where clipping ends


@pytest.mark.parametrize("integrator", INTEGRATORS)
@pytest.mark.parametrize("clip_start, way", [(0.5, 1.5), (3.0, 0.0), (5.0, 1.0)])
def test_the_medium_nearer_than_where_clipping_ends_is_not_seen(core, integrator, clip_start, way):
    """The camera is in the first box, two units from its border; from 4 to 6 units away is another."""
    scene = in_front_of_the_world(core)
    for place in (5.0, 0.0):
        add_box(core, scene, absorbing(core, (0.5,) * 3), (0, 0, place), 2.0 if place else 1.0, name=str(place))
    scene.set_camera("PERSPECTIVE", matrix((0, 0, 5)), (-0.05,) * 2, (0.05,) * 2, clip_start, 1000.0)
    beyond = 0.0 if clip_start == 5.0 else 2.0
    image = picture(core, scene, samples=2, integrator=integrator)
    np.testing.assert_allclose(image, np.exp(-0.5 * (way + beyond)), rtol=5e-3)  # rays slant


def test_glass_tints_by_the_way_inside(core):
    """Straight through a slab, but for what its two sides mirror."""
    program = core.Program("glass")
    one = program.constant(1, 1, 1, 1)
    program.operation("glass", [one, one, program.constant(0, 0, 0, 1), program.constant(*[1.5] * 4)], text="SHARP")
    images = []
    for density in (0.0, 1.0):
        scene = core.SceneDescription()
        add_box(core, scene, absorbing(core, (0.5,) * 3, density), surface=program)
        scene.set_world(background(core, WHITE), 0)
        look_down(scene, half=0.01)
        images.append(picture(core, scene, samples=512, size=4, max_bounces=8).mean())
    mirrored, through = 0.04, np.exp(-1.0)  # the series of inner reflections
    expected = mirrored + 0.96**2 * through / (1 - 0.04**2 * through**2) * (1 + 0.04 * through)
    assert images[0] == pytest.approx(1.0, abs=2e-3)
    assert images[1] == pytest.approx(expected, abs=0.01)


def scenes_of_media(core):
    """The varied scene with media of every kind."""
    scene = varied_scene(core)
    add_box(core, scene, scattering(core, density=0.5), (0.2, 0.3, 0.5), 0.45, name="even")
    program = core.Program("uneven")
    one, position = program.constant(1, 1, 1, 1), program.operation("object_coordinates")
    numbers = [program.constant(*[x] * 4) for x in (0.0, 3.0, 2.0, 0.5, 0.0)]
    noise = program.operation("noise", [position, *numbers], [3])
    program.operation("volume_scatter", [one, noise, program.operation("component", [noise], [3]), numbers[0]])
    add_box(core, scene, program, (-0.3, 0.1, 0.6), 0.4, name="uneven")
    world = medium(core, ("volume_scatter", 1.0, (0.5, 0.7, 0.9), 0.02, -0.3))
    scene.set_world(background(core, (0.3, 0.4, 0.5)), 0, medium=world)
    return scene


@pytest.mark.parametrize("paths", [1, 17, 512])
def test_streams_through_media_give_the_bits_of_single_paths(core, paths):
    scene = scenes_of_media(core)
    settings = dict(size=10, samples=5, passes=ALL_PASSES, volume_bounces=3)
    alone, together = (render(core, scene, stream_paths=n, **settings) for n in (0, paths))
    for name in ALL_PASSES:
        np.testing.assert_array_equal(together.pass_pixels(name), alone.pass_pixels(name), err_msg=name)
    assert np.isfinite(alone.pass_pixels("combined")).all()
    assert alone.statistics()["rays"]["medium"] > 0


@pytest.mark.slow
def test_both_integrators_agree_on_media(core):
    """With so many samples that the noise of the mean is a quarter of what is allowed."""
    settings = dict(size=2, samples=12000, volume_bounces=2, diffuse_bounces=1, max_bounces=6)
    images = [picture(core, scenes_of_media(core), integrator=name, **settings).mean((0, 1)) for name in INTEGRATORS]
    np.testing.assert_allclose(images[0], images[1], rtol=0.03)


@pytest.mark.parametrize("density", [1e9, 3e38, 1e-30])
@pytest.mark.parametrize("uneven", [False, True])
def test_densities_beyond_all_measure_make_pictures_of_numbers(core, density, uneven):
    scene = varied_scene(core)
    program = core.Program("medium")
    one, amount = program.constant(1, 1, 1, 1), program.constant(*[density] * 4)
    if uneven:
        height = program.operation("component", [program.operation("generated")], [2])
        amount = program.operation("math", [amount, height], [0], text="MULTIPLY")
    program.operation("volume_scatter", [one, one, amount, program.constant(*[2.0] * 4)])
    add_box(core, scene, program, (0, 0, 0.5), 0.4)
    scene.set_world(background(core, (0.3, 0.4, 0.5)), 0, medium=program)
    image = picture(core, scene, samples=4, size=6, volume_bounces=4)
    assert np.isfinite(image).all() and image.min() >= 0.0


def test_a_body_that_holds_a_volume_is_not_interpolated_and_the_statistics_say_why(core):
    scene = in_front_of_the_world(core)
    materials = scene.add_material_list([scene.add_material("body", None, medium=absorbing(core))])
    scene.add_instance("body", scene.add_surface("ball", [sphere_spline(core)]), matrix(), materials)
    settings = core.Settings(width=4, height=4, samples=1, ray_interpolation=core.RayInterpolation(mode="ON"))
    session = core.Session(scene, settings)
    assert session.render()
    assert [each["reason"] for each in session.statistics()["ray_caches"]] == ["holds a volume"]
