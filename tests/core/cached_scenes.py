"""What the tests of cached paths share: scenes of mirrors, glass and volumes, and renders with the cache's statistics."""

import numpy as np
from path_scenes import material
from scenes import look_down, matrix, quad, sphere_spline

CLOSURES = {
    "mirror": ("glossy", 1.0, 0.9, 0.0, "SHARP"),
    "glass": ("glass", 1.0, (0.9, 1.0, 0.9), 0.0, 1.45, "SHARP"),
    "simple": ("diffuse", 1.0, (0.8, 0.6, 0.4)),
}
# Codes of the pass Rayleaf Mask.
NOT_ASKED, TRACED, INTERPOLATED, TWO_CLASS, MISSED = range(5)
PASSES = ["combined", "mask", "interpolation_error"]
# From the middle of the picture to the right, past the rim of a ball_scene's ball, which is 142 pixels from the middle.
SIZE = 513
STRIP = dict(crop_x=248, crop_y=252, crop_width=176, crop_height=9)
# The pixel of a strip that shows the picture's middle.
MIDDLE = (4, 8)
# Without random numbers: one ray through the middle of every pixel.
STILL = dict(samples=1, filter="BOX", filter_width=0.0)


def world(core):
    """A smooth world: brighter towards +x, so that radiance shows directions, without any edge."""
    program = core.Program("world")
    one = program.constant(1, 1, 1, 1)
    direction = program.operation("generated")
    scaled = program.operation("vector_math", [direction, program.constant(0.4, 0.2, 0.1, 0)], text="MULTIPLY")
    color = program.operation("vector_math", [scaled, program.constant(0.5, 0.5, 0.5, 0)], text="ADD")
    program.operation("background", [one, color, one])
    return program


def ball(core, scene, name, kind, place=(0, 0, 0), size=1.0, **more):
    """A spline sphere of a kind of material."""
    shape = scene.add_surface(name, [sphere_spline(core)])
    return scene.add_instance(
        name, shape, matrix(place, size), material(core, scene, CLOSURES[kind], name=kind), **more
    )


def ball_scene(core, kind, floor=True):
    scene = core.SceneDescription()
    ball(core, scene, "ball", kind)
    if floor:
        ground = material(core, scene, ("diffuse", 1.0, (0.3, 0.5, 0.8)), name="ground")
        scene.add_instance("floor", quad(scene, "floor", 6.0, -1.5), matrix(), ground)
    scene.set_world(world(core), 32)
    look_down(scene, 6.0, 0.3)
    return scene


def render(core, scene, mode="ON", caches=None, error=0.005, cache_bytes=None, **settings):
    """A finished session: a strip of a large picture, whose rays are close enough together to share samples."""
    interpolation = core.RayInterpolation(mode=mode, error=error, cache_bytes=cache_bytes)
    values = dict(width=SIZE, height=SIZE, samples=4, threads=2, clamp_indirect=0.0, passes=PASSES, **STRIP)
    values.update(settings)
    session = core.Session(scene, core.Settings(**values, ray_interpolation=interpolation), caches)
    assert session.render()
    return session


def picture(session):
    return session.pass_pixels("combined")[..., :3]


def used(session):
    """Statistics of the caches that exist."""
    return [each for each in session.statistics()["ray_caches"] if each["used"]]


def share_of(session, *codes):
    return float(np.isin(session.pass_pixels("mask"), codes).mean())
