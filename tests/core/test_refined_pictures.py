"""Pictures that are looked at while they get better: blocks, then sample after sample."""

import threading
import time

import numpy as np
import pytest
import scenes
from path_scenes import material, varied_scene

PASSES = ["combined", "normal", "object_index"]


def session_of(core, width=17, height=13, **settings):
    session = core.Session(varied_scene(core), core.Settings(width=width, height=height, passes=PASSES, **settings))
    assert session.build()
    return session


@pytest.mark.parametrize("rounds", [(8,), (1, 7), (3, 1, 4), (1,) * 8])
def test_samples_in_rounds_are_those_of_a_render(core, rounds):
    whole = core.Session(varied_scene(core), core.Settings(width=17, height=13, samples=8, passes=PASSES))
    assert whole.render()
    session = session_of(core)
    for count in rounds:
        assert session.render_more(count)
    for name in PASSES:
        expected, found = whole.pass_pixels(name), session.pass_pixels(name)
        # A mean of means rounds each time; of one round it is that of the render.
        tolerance = 0 if len(rounds) == 1 else 1e-5
        np.testing.assert_allclose(found, expected, rtol=tolerance, atol=tolerance)


@pytest.mark.parametrize("size", [1, 2, 4, 8, 64])
def test_a_block_shows_the_pixel_in_its_middle(core, size):
    session = session_of(core)
    assert session.render_blocks(size)
    found = session.pass_pixels("combined")
    single = session_of(core)
    assert single.render_more(1)
    pixels = single.pass_pixels("combined")
    height, width = found.shape[:2]
    y, x = np.mgrid[:height, :width]
    middle = [np.minimum(at // size * size + size // 2, most - 1) for at, most in ((y, height), (x, width))]
    np.testing.assert_array_equal(found, pixels[middle[0], middle[1]])


def test_samples_after_blocks_take_their_place(core):
    session, plain = session_of(core), session_of(core)
    for size in (8, 4, 2):
        assert session.render_blocks(size)
    for each in (session, plain):
        assert each.render_more(2) and each.render_more(1)
    np.testing.assert_array_equal(session.pass_pixels("combined"), plain.pass_pixels("combined"))


@pytest.mark.parametrize("threads", [1, 5])
@pytest.mark.parametrize("stream", [0, 7, 512])
def test_rounds_are_the_same_for_any_thread_count_and_stream(core, threads, stream):
    session = session_of(core, threads=threads, stream_paths=stream, tile_size=5)
    plain = session_of(core, threads=1)
    for each in (session, plain):
        assert each.render_blocks(4) and each.render_more(1) and each.render_more(3)
    np.testing.assert_array_equal(session.pass_pixels("combined"), plain.pass_pixels("combined"))


def test_facets_may_be_those_of_another_camera(core):
    """A dicing camera of a hundred times the focal length wants finer facets than the picture's own."""

    def pixels(half):
        scene = core.SceneDescription()
        ball = scene.add_surface("ball", [scenes.sphere_spline(core)])
        scene.add_instance("ball", ball, scenes.matrix())
        scene.set_world(scenes.background(core))
        scenes.look_down(scene, 4.0, 0.2)
        if half is not None:
            window = (-half, -half), (half, half)
            scene.set_camera("PERSPECTIVE", scenes.matrix((0, 0, 4.0)), *window, 0.1, 1e6, dicing=True)
        session = core.Session(scene, core.Settings(width=64, height=64, samples=1))
        assert session.render()
        return session.pass_pixels("combined"), session.statistics()["memory"]["facets"]

    plain, same, fine = pixels(None), pixels(0.2), pixels(0.002)
    np.testing.assert_array_equal(plain[0], same[0])
    assert fine[1] > 2 * plain[1]
    assert np.isfinite(fine[0]).all()


def test_a_cancelled_round_says_so(core):
    session = session_of(core)
    session.cancel()
    assert not session.render_more(1) and not session.render_blocks(2)


LIGHT = ["combined", "diffuse_direct", "diffuse_color"]


def lit_edge(core):
    """A matte square that covers a part of its border's pixels, under a lamp."""
    scene = core.SceneDescription()
    square = scenes.quad(scene, "square", 0.5)
    scene.add_instance("square", square, scenes.matrix(), material(core, scene, ("diffuse", 1.0, 0.25)))
    scene.add_lamp("lamp", "POINT", scenes.matrix((0, 0, 3)), strength=(100,) * 3, radius=0.5, visibility=62)
    scenes.look_down(scene, half=0.7)
    return scene


@pytest.mark.parametrize("count", [1, 4, 64])
def test_light_without_colour_is_a_quotient_of_means(core, count):
    """However many samples a round has: also of pixels that a surface covers in part."""
    session = core.Session(lit_edge(core), core.Settings(width=9, height=9, passes=LIGHT))
    for _ in range(64 // count):
        assert session.render_more(count)
    combined, light, color = (session.pass_pixels(name)[..., :3] for name in LIGHT)
    assert 0.0 < color.mean() < 0.2
    np.testing.assert_allclose(light * color, combined, rtol=1e-5, atol=1e-7)


@pytest.mark.parametrize("limit", [{"time_limit": 100.0}, {"noise_threshold": 1e-4}])
def test_a_cancelled_picture_in_rounds_has_finished_passes(core, limit):
    scene = lit_edge(core)
    session = core.Session(scene, core.Settings(width=32, height=32, samples=1 << 20, passes=LIGHT, **limit))
    thread = threading.Thread(target=session.render)
    thread.start()
    deadline = time.monotonic() + 20.0
    while not session.pass_pixels("combined").all() and time.monotonic() < deadline:
        time.sleep(0.05)
        if session.pass_pixels("diffuse_color").max() > 0.0:
            break
    session.cancel()
    thread.join()
    combined, light, color = (session.pass_pixels(name)[..., :3] for name in LIGHT)
    assert color.max() > 0.0
    np.testing.assert_allclose(light * color, combined, rtol=1e-4, atol=1e-6)


@pytest.mark.parametrize("rounds", [(64,), (1,) * 64, (8,) * 8])
def test_alpha_is_limited_as_a_mean(core, rounds):
    """Of a surface that lets all light through and scatters more: samples of alpha lie beyond 0 and 1."""
    scene = core.SceneDescription()
    surface = material(core, scene, ("transparent", 1.0, 1.0), ("diffuse", 1.0, 0.8))
    scene.add_instance("veil", scenes.quad(scene, "veil", 20), scenes.matrix(), surface)
    scenes.look_down(scene, half=0.05)
    session = core.Session(scene, core.Settings(width=16, height=16, film_transparent=True))
    for count in rounds:
        assert session.render_more(count)
    assert session.pass_pixels("combined")[..., 3].mean() < 0.03


@pytest.mark.parametrize("target", [1e-7, 1e-9])
def test_a_view_that_never_reaches_its_error_goes_on(core, target):
    """However small the target: it may take more samples than integers hold."""

    def samples(error):
        settings = core.Settings(width=16, height=16, target_error=error, passes=["combined", "sample_count"])
        session = core.Session(varied_scene(core), settings)
        for _ in range(4):
            assert session.render_more(8)
        return session.pass_pixels("sample_count")

    np.testing.assert_array_equal(samples(target), samples(1e-5))
