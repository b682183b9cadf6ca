"""Distribution ray tracing estimates what path tracing does with at most one diffuse bounce."""

import numpy as np
import pytest
from path_scenes import ALL_PASSES, lit_plane, material, render, uneven_world, varied_scene, veil
from scenes import background, emission, look_down, matrix, quad, sphere_spline

MANY = dict(integrator="DISTRIBUTION", samples=16, glossy_rays=8, light_rays=4, hemisphere_rays=16)
ONE_BOUNCE = dict(diffuse_bounces=1, max_bounces=8)


def direct(core):
    scene = lit_plane(core)
    scene.add_lamp("lamp", "RECTANGLE", matrix((0.5, 0.3, 2)), (50, 40, 30), size_x=3.0, size_y=2.0)
    return scene


def soft_shadow(core):
    scene = lit_plane(core)
    scene.add_instance("shade", quad(scene, "shade", 0.6), matrix((0.4, 0, 1)), visibility=30)
    scene.add_lamp("lamp", "POINT", matrix((0.5, 0.3, 2)), (50,) * 3, radius=0.5, visibility=30)
    scene.add_lamp("sun", "SUN", matrix((0, 0, 1)), (1, 0.5, 0.2), angle=0.5)
    scene.set_world(background(core, strength=0.3))
    look_down(scene, half=0.15)
    return scene


def mirrors(core):
    scene = core.SceneDescription()
    mirror = material(core, scene, ("glossy", 1.0, (0.9, 0.8, 0.7), 0.0, "SHARP"), ("diffuse", 0.3, 0.5))
    scene.add_instance("floor", quad(scene, "floor", 3), matrix(), mirror)
    scene.add_instance("ball", scene.add_surface("ball", [sphere_spline(core)]), matrix((0.3, 0, 1.2), 0.6), mirror)
    scene.add_lamp("lamp", "RECTANGLE", matrix((0.5, 0.3, 3)), (100,) * 3)
    scene.set_world(uneven_world(core), 32)
    look_down(scene, half=0.3)
    return scene


def glass(core):
    scene = core.SceneDescription()
    clear = material(core, scene, ("glass", 1.0, (0.9, 1.0, 0.9), 0.0, 1.5, "SHARP"), name="glass")
    rough = material(core, scene, ("glass", 1.0, 1.0, 0.3, 1.3, "GGX"), name="rough")
    grey = material(core, scene, ("diffuse", 1.0, 0.6), name="grey")
    scene.add_instance("floor", quad(scene, "floor", 5), matrix(), grey)
    ball = scene.add_surface("ball", [sphere_spline(core)])
    scene.add_instance("clear", ball, matrix((0.5, 0, 1), 0.5), clear)
    scene.add_instance("rough", ball, matrix((-0.5, 0, 1), 0.5), rough)
    scene.set_world(background(core, (0.5, 0.7, 1.0), 1.0))
    look_down(scene, half=0.25)
    return scene


def glossy(core):
    scene = core.SceneDescription()
    plate = material(core, scene, ("glossy", 0.8, 1.0, 0.4, "GGX"), ("diffuse", 0.2, 0.5))
    scene.add_instance("plate", quad(scene, "plate", 4), matrix(), plate)
    glow = scene.add_material_list([scene.add_material("glow", emission(core, color=(1, 0.6, 0.3), strength=8.0))])
    scene.add_instance("glow", quad(scene, "glow", 0.3), matrix((0.5, 0, 1)) @ np.diag([1.0, -1, -1, 1]), glow)
    scene.add_lamp("lamp", "POINT", matrix((-0.5, 0, 2)), (30,) * 3, radius=0.4)
    look_down(scene, half=0.15)
    return scene


def bleeding(core):
    scene = core.SceneDescription()
    white = material(core, scene, ("diffuse", 1.0, 0.8), name="white")
    red = material(core, scene, ("diffuse", 1.0, (0.8, 0.1, 0.05)), name="red")
    scene.add_instance("floor", quad(scene, "floor", 5), matrix(), white)
    wall = matrix((0.5, 0, 0)) @ np.array([[0, 0, -1.0, 0], [0, 1, 0, 0], [1, 0, 0, 0], [0, 0, 0, 1]])
    scene.add_instance("wall", quad(scene, "wall", 2), wall, red)
    scene.add_lamp(
        "sun", "SUN", matrix() @ np.array([[1, 0, 0, 0], [0, 0.6, -0.8, 0], [0, 0.8, 0.6, 0], [0, 0, 0, 1.0]]), (3,) * 3
    )
    scene.add_lamp("lamp", "RECTANGLE", matrix((-1, 0, 2)), (60,) * 3)
    scene.set_world(background(core, (0.2, 0.3, 0.5), 1.0))
    look_down(scene, half=0.1)
    return scene


def veils(core):
    scene = lit_plane(core, 0.7)
    for i in range(3):
        half = veil(core, scene, (0.6, 0.5, 0.4), ("diffuse", 0.4, (0.2, 0.4, 0.8)), ("translucent", 0.2, 0.5))
        scene.add_instance(f"veil {i}", quad(scene, "veil", 2), matrix((0, 0, 0.5 + 0.2 * i)), half)
    scene.add_lamp("lamp", "POINT", matrix((1, 0, 3)), (100,) * 3, radius=0.2)
    scene.set_world(background(core, strength=0.5))
    return scene


def bodies(core):
    """Light goes through a ball, below a matte share and a mirror, and is seen in a floor of its kind."""
    scene = core.SceneDescription()
    slots = []
    for name, scale, ints, share in (("skin", 0.3, [1, 1], 0.7), ("wax", 0.1, [0], 1.0)):
        program = core.Program(name)
        values = [share, (0.8, 0.5, 0.3), scale, (1.0, 0.4, 0.2), 1.4, 0.3]
        operands = [program.constant(*(v if isinstance(v, tuple) else (v,) * 3), 1) for v in values]
        program.operation("subsurface", operands, ints=ints)
        if share < 1:
            rest, white, clear = (program.constant(*(v,) * 4) for v in (0.15, 0.9, 0.0))
            program.operation("diffuse", [rest, white])
            program.operation("glossy", [rest, white, clear], text="SHARP")
        slots.append(scene.add_material_list([scene.add_material(name, program)]))
    ball = scene.add_surface("ball", [sphere_spline(core)])
    scene.add_instance("skin", ball, matrix((0, 0, 0.6), 0.5), slots[0])
    scene.add_instance("wax", ball, matrix((0.6, 0, 0.2), 0.4), slots[1])
    scene.add_lamp("lamp", "RECTANGLE", matrix((0.5, 0.3, 2)), (50, 40, 30))
    scene.add_lamp("back", "POINT", matrix((-0.5, 0, -1)), (30, 40, 50), radius=0.2)
    scene.set_world(uneven_world(core), 32)
    look_down(scene, half=0.2)
    return scene


SCENES = dict(
    bodies=bodies,
    direct=direct,
    soft_shadow=soft_shadow,
    mirrors=mirrors,
    glass=glass,
    glossy=glossy,
    bleeding=bleeding,
    veils=veils,
    varied=varied_scene,
)


def light(session, name):
    """A pass with the colour in it that the film divided it by, so that its mean is that of all samples."""
    kind, _, part = name.partition("_")
    pixels = session.pass_pixels(name)[..., :3]
    return pixels * session.pass_pixels(f"{kind}_color") if part in ("direct", "indirect") else pixels


def means(core, scene, **settings):
    """Mean of every pass over renders of several seeds, with the error of that mean."""
    values = []
    for seed in range(8):
        session = render(core, scene, seed=seed, passes=ALL_PASSES, **{**ONE_BOUNCE, **settings})
        values.append([light(session, name).mean() for name in ALL_PASSES])
    values = np.array(values)
    return values.mean(0), values.std(0, ddof=1) / np.sqrt(8)


@pytest.mark.slow
@pytest.mark.parametrize("name", SCENES)
def test_the_mean_of_every_pass_is_that_of_path_tracing(core, name):
    scene = SCENES[name](core)
    path, path_error = means(core, scene, samples=256)
    many, many_error = means(core, scene, **MANY)
    wrong = {}
    for i, pass_name in enumerate(ALL_PASSES):
        allowed = 6 * np.hypot(path_error[i], many_error[i]) + 2e-3 * abs(path[i]) + 1e-6
        if abs(path[i] - many[i]) > allowed:
            wrong[pass_name] = (path[i], many[i], allowed)
    assert not wrong, wrong


@pytest.mark.slow
@pytest.mark.parametrize("name", ["direct", "soft_shadow", "mirrors", "glossy", "bodies"])
def test_without_indirect_light_the_mean_is_that_of_no_diffuse_bounce(core, name):
    scene = SCENES[name](core)
    path, path_error = means(core, scene, samples=256, diffuse_bounces=0)
    many, many_error = means(core, scene, **MANY, indirect="NONE")
    assert abs(path[0] - many[0]) < 6 * np.hypot(path_error[0], many_error[0]) + 2e-3 * path[0]


@pytest.mark.parametrize("veiled", [False, True])
@pytest.mark.parametrize("rays", [1, 15, 16, 17, 37])
def test_any_number_of_rays_adds_up_to_the_whole(core, rays, veiled):
    """Rays to the sky and to lamps are traced in packets; the last is seldom full."""
    scene = core.SceneDescription()
    grey = material(core, scene, ("diffuse", 1.0, 0.5))
    scene.add_instance("plane", quad(scene, "plane", 20), matrix(), grey)
    scene.set_world(background(core, strength=1.0))
    share = 1.0
    if veiled:
        share = 0.5
        pane = veil(core, scene, (share,) * 3)
        scene.add_instance("pane", quad(scene, "pane", 1000), matrix((0, 0, 2)), pane, visibility=30)
    scene.add_lamp("sun", "SUN", matrix((0, 0, 5)), (1, 1, 1), angle=0.0)
    look_down(scene, half=0.1)
    counts = dict(integrator="DISTRIBUTION", indirect="AMBIENT_OCCLUSION", hemisphere_rays=rays, light_rays=rays)
    session = render(core, scene, samples=1, size=4, passes=["combined", "ambient_occlusion"], **counts)
    np.testing.assert_allclose(session.pass_pixels("ambient_occlusion"), share, rtol=1e-5)
    values = session.pass_pixels("combined")[..., :3]
    np.testing.assert_allclose(values, share * 0.5 * (1.0 + 1.0 / np.pi), rtol=1e-4)
