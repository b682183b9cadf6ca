"""What threads do to a render: floating-point settings of the host, cancelling at any stage, many threads."""

import ctypes
import mmap
import platform
import threading
import time

import numpy as np
import pytest
from cached_scenes import ball, ball_scene, picture, render, world
from path_scenes import material
from scenes import CUBE_TRIANGLES, CUBE_VERTICES, background, look_down, matrix, quad, small_scene, sphere_spline
from scenes import render as passes_of

needs_sse = pytest.mark.skipif(platform.machine() != "x86_64", reason="the control word is x86's")

FLUSH_TO_ZERO, DENORMALS_ARE_ZERO, PLAIN = 0x8000, 0x40, 0x1F80


def set_control_word(value):
    """Of this thread's SSE unit."""
    code = mmap.mmap(-1, mmap.PAGESIZE, prot=mmap.PROT_READ | mmap.PROT_WRITE | mmap.PROT_EXEC)
    code.write(bytes((0x0F, 0xAE, 0x17, 0xC3)))  # ldmxcsr [rdi]; ret
    address = ctypes.addressof(ctypes.c_char.from_buffer(code))
    word = ctypes.c_uint32(value)
    ctypes.CFUNCTYPE(None, ctypes.POINTER(ctypes.c_uint32))(address)(ctypes.byref(word))


@needs_sse
@pytest.mark.parametrize("threads", [1, 3])
def test_a_host_that_flushes_denormal_numbers_to_zero_changes_no_bit(core, threads):
    """Light of 1e-39: shading, film and all between them compute with denormal numbers."""

    def shown(word):
        scene = core.SceneDescription()
        scene.add_instance("floor", quad(scene, "floor", 3.0), matrix(), material(core, scene, ("diffuse", 1.0, 0.5)))
        scene.set_world(background(core, (1.0, 0.7, 0.4), 1e-39))
        look_down(scene)
        session = core.Session(scene, core.Settings(width=8, height=8, samples=4, threads=threads))
        set_control_word(word)
        try:
            assert session.render()
        finally:
            set_control_word(PLAIN)
        return session.pass_pixels("combined")[..., :3]

    plain = shown(PLAIN)
    smallest_normal = float(np.finfo(np.float32).smallest_normal)
    assert 0.0 < plain.max() < smallest_normal
    np.testing.assert_array_equal(shown(PLAIN | FLUSH_TO_ZERO | DENORMALS_ARE_ZERO), plain)


def test_two_hundred_threads_render_what_one_does(core):
    """More than had a place of their own in the caches once."""
    settings = dict(width=64, height=48, samples=2, tile_size=4)
    one = passes_of(core, small_scene(core), threads=1, **settings)["combined"]
    np.testing.assert_array_equal(passes_of(core, small_scene(core), threads=200, **settings)["combined"], one)
    crop = dict(crop_width=48, samples=1, tile_size=2)
    one = picture(render(core, ball_scene(core, "glass"), threads=1, **crop))
    np.testing.assert_array_equal(picture(render(core, ball_scene(core, "glass"), threads=200, **crop)), one)


@pytest.mark.parametrize("kinds", [("mirror",), ("glass", "mirror", "simple")])
def test_auto_decides_alike_by_any_number_of_threads(core, kinds):
    def reasons(threads):
        scene = core.SceneDescription()
        for i, kind in enumerate(kinds):
            ball(core, scene, kind, kind, (1.5 * (i - (len(kinds) - 1) / 2), 0, 0), 0.7)
        scene.set_world(world(core), 32)
        look_down(scene, 6.0, 0.3)
        # Rays to facets that stay in memory are traced faster than interpolated.
        frame = dict(width=1024, height=1024, samples=16, threads=threads, resident_megabytes=0.0)
        session = render(
            core, scene, "AUTO", **{**frame, "crop_x": 500, "crop_y": 500, "crop_width": 8, "crop_height": 8}
        )
        return [each["reason"] for each in session.statistics()["ray_caches"]]

    one = reasons(1)
    assert len(one) == len(kinds) and any("queries" in reason for reason in one), one
    assert reasons(2) == reasons(5) == one


def test_glass_is_skipped_alike_however_many_objects_there_are(core):
    def shown(cubes):
        scene = ball_scene(core, "glass", floor=False)
        dark = material(core, scene, ("diffuse", 1.0, 0.1), name="dark")
        cube = scene.add_mesh("cube", CUBE_VERTICES, CUBE_TRIANGLES)
        for i in range(cubes):
            scene.add_instance(f"cube {i}", cube, matrix((2.0, 0, 0), 0.1), dark)
        return picture(render(core, scene, "AUTO", samples=1))

    np.testing.assert_array_equal(shown(10_001), shown(2))


def test_of_many_bodies_of_glass_those_that_hold_something_show_it(core):
    """25 balls within a hollow cube; in some of them there is a red cube."""
    random = np.random.default_rng(3)
    full = random.random((5, 5)) < 0.4
    scene = core.SceneDescription()
    red = material(core, scene, ("diffuse", 1.0, (1.0, 0.0, 0.0)), name="red")
    glass = material(core, scene, ("glass", 1.0, 1.0, 0.0, 1.45, "SHARP"), name="glass")
    shape = scene.add_surface("ball", [sphere_spline(core)])
    cube = scene.add_mesh("cube", CUBE_VERTICES, CUBE_TRIANGLES)
    for y, x in np.ndindex(5, 5):
        place = (x - 2.0, y - 2.0, 0.0)
        scene.add_instance(f"ball {x} {y}", shape, matrix(place, 0.4), glass)
        if full[y, x]:
            scene.add_instance(f"cube {x} {y}", cube, matrix(place, 0.15), red)
    scene.set_world(background(core))
    look_down(scene, 30.0, 2.5 / 30.0)
    interpolation = core.RayInterpolation(mode="AUTO")
    settings = core.Settings(
        width=55, height=55, samples=16, filter="BOX", filter_width=0.0, ray_interpolation=interpolation
    )
    session = core.Session(scene, settings)
    assert session.render()
    middles = picture(session)[5::11, 5::11]
    np.testing.assert_array_equal(middles[..., 1] < 0.5 * middles[..., 0], full)


def test_a_render_is_cancelled_while_it_looks_at_glass(core):
    """Twenty thousand bodies within a fine shell: their boxes lie in its box, and none of its triangles in theirs."""
    scene = core.SceneDescription()
    glass = material(core, scene, ("glass", 1.0, 1.0, 0.0, 1.45, "SHARP"), name="glass")
    height, angle = np.meshgrid(np.linspace(-1, 1, 301), np.linspace(0, 2 * np.pi, 301))
    ring = 10 * np.sqrt(np.maximum(1 - height**2, 0))
    vertices = np.stack([ring * np.cos(angle), ring * np.sin(angle), 10 * height], -1).reshape(-1, 3).astype(np.float32)
    corner = (np.arange(300)[:, None] * 301 + np.arange(300)).ravel()
    quads = np.stack([corner, corner + 1, corner + 302, corner, corner + 302, corner + 301], -1)
    shell = scene.add_mesh("shell", vertices, quads.reshape(-1, 3).astype(np.int32))
    scene.add_instance("shell", shell, matrix(), material(core, scene, ("diffuse", 1.0, 0.5)))
    shape = scene.add_surface("ball", [sphere_spline(core)])
    for i, place in enumerate(np.random.default_rng(1).uniform(-4, 4, (20_000, 3))):
        scene.add_instance(f"ball {i}", shape, matrix(place, 0.01), glass)
    scene.set_world(background(core))
    look_down(scene, 8.0)
    interpolation = core.RayInterpolation(mode="AUTO")
    session = core.Session(scene, core.Settings(width=1000, height=1000, samples=1000, ray_interpolation=interpolation))
    running = threading.Thread(target=session.render)
    running.start()
    time.sleep(0.1)  # shapes are made in less, and looking at glass takes as long again
    session.cancel()
    running.join(2.0)  # a tenth of a second, but for a machine that has other things to do
    slow = running.is_alive()
    running.join()
    assert not slow and session.progress()[0] == "cancelled"
