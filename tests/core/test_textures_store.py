"""Textures: decoding, filtering, borders, memory."""

import os
import struct
import subprocess
import sys
import zlib

import numpy as np
import pytest
from rayleaf import _core

tests = _core.shading
LINEAR, CLOSEST, CUBIC = tests.Interpolation.LINEAR, tests.Interpolation.CLOSEST, tests.Interpolation.CUBIC
REPEAT, EXTEND, CLIP, MIRROR = (getattr(tests.Extension, name) for name in ("REPEAT", "EXTEND", "CLIP", "MIRROR"))
HALF = 2.0**-11  # images of bytes are kept as half floats


@pytest.fixture
def store():
    """An empty store."""
    return tests.TextureStore(1 << 27)


def picture(height, width, channels, seed=0):
    """Numbers that half floats hold exactly."""
    return (np.random.default_rng(seed).integers(0, 256, (height, width, channels)) / 256).astype(np.float32)


def look(store, texture, uv, extension=REPEAT, interpolation=LINEAR, width=0.0):
    """Look up with a square footprint of `width` in uv."""
    uv = np.float32(uv).reshape(-1, 2)
    dx, dy = np.tile(np.float32((width, 0)), (len(uv), 1)), np.tile(np.float32((0, width)), (len(uv), 1))
    return store.lookup(texture, uv, dx, dy, extension, interpolation)


def linear_from_srgb(x):
    """IEC 61966-2-1."""
    return np.where(x <= 0.04045, x / 12.92, ((x + 0.055) / 1.055) ** 2.4)


def wrapped(place, size, extension):
    """The pixel that stands at any whole place along a side."""
    if extension == REPEAT:
        return place % size
    if extension == MIRROR:
        return np.where(place // size % 2 == 0, place % size, size - 1 - place % size)
    return place.clip(0, size - 1)


def bilinear(pixels, uv, extension):
    """Reference: pixel centres at half-integers, rows bottom to top."""
    height, width = pixels.shape[:2]
    x, y = uv[:, 0] * width - 0.5, uv[:, 1] * height - 0.5
    x0, y0 = np.floor(x).astype(int), np.floor(y).astype(int)
    result = 0
    for i, j in ((0, 0), (1, 0), (0, 1), (1, 1)):
        weight = (1 - abs(x - x0 - i)) * (1 - abs(y - y0 - j))
        column, row = wrapped(x0 + i, width, extension), wrapped(y0 + j, height, extension)
        result = result + weight[:, None] * pixels[row, column]
    return result


@pytest.mark.parametrize("channels", (1, 3, 4))
@pytest.mark.parametrize("extension", (REPEAT, EXTEND, MIRROR))
def test_a_lookup_without_footprint_is_bilinear(store, channels, extension):
    pixels = picture(5, 7, channels)
    texture = store.add_pixels("Image", pixels, tests.ColorSpace.NON_COLOR)
    uv = np.random.default_rng(1).uniform(-1.5, 2.5, (400, 2)).astype(np.float32)
    expected = bilinear(pixels, uv, extension)
    if channels == 1:
        expected = np.repeat(expected, 3, axis=1)
    if channels < 4:
        expected = np.column_stack([expected, np.ones(len(uv))])
    found = look(store, texture, uv, extension)
    np.testing.assert_allclose(found, expected, atol=2e-5)  # uv in single precision times 7 pixels


def test_closest_takes_the_pixel_under_the_point(store):
    pixels = picture(4, 8, 3)
    texture = store.add_pixels("Image", pixels, tests.ColorSpace.LINEAR)
    rows, columns = np.mgrid[0:4, 0:8]
    uv = np.stack([(columns.ravel() + 0.3) / 8, (rows.ravel() + 0.8) / 4], axis=1)
    np.testing.assert_array_equal(look(store, texture, uv, interpolation=CLOSEST)[:, :3], pixels.reshape(-1, 3))


def test_cubic_keeps_constants_and_is_smoother_than_linear(store):
    flat = store.add_pixels("Flat", np.full((8, 8, 3), 0.5, np.float32), tests.ColorSpace.LINEAR)
    uv = np.random.default_rng(2).random((50, 2))
    np.testing.assert_allclose(look(store, flat, uv, interpolation=CUBIC)[:, :3], 0.5, atol=1e-6)
    spike = np.zeros((8, 8, 3), np.float32)
    spike[4, 4] = 1
    texture = store.add_pixels("Spike", spike, tests.ColorSpace.LINEAR)
    at_spike = look(store, texture, [(4.5 / 8, 4.5 / 8)], interpolation=CUBIC)[0, 0]
    assert at_spike == pytest.approx(4 / 9, abs=1e-4)  # (2/3)², the B-spline's peak


@pytest.mark.parametrize("channels", (3, 4))
def test_nothing_lies_outside_a_clipped_image(store, channels):
    texture = store.add_pixels("Image", np.ones((4, 4, channels), np.float32), tests.ColorSpace.LINEAR)
    np.testing.assert_array_equal(look(store, texture, [(1.6, 0.5), (0.5, -0.7)], CLIP)[:, 3], 0)
    np.testing.assert_allclose(look(store, texture, [(0.5, 0.5)], CLIP), 1, atol=1e-6)


def test_srgb_is_decoded_before_it_is_filtered(store):
    codes = np.linspace(0, 1, 256, dtype=np.float32).reshape(1, 256, 1).repeat(3, axis=2)
    texture = store.add_pixels("Ramp", codes, tests.ColorSpace.SRGB)
    uv = np.stack([(np.arange(256) + 0.5) / 256, np.full(256, 0.5)], axis=1)
    found = look(store, texture, uv, EXTEND, CLOSEST)[:, 0]
    np.testing.assert_allclose(found, linear_from_srgb(codes[0, :, 0]), rtol=HALF, atol=1e-7)
    between = look(store, texture, [(128 / 256, 0.5)], EXTEND)[0, 0]
    expected = linear_from_srgb(codes[0, 127:129, 0]).mean()
    assert between == pytest.approx(expected, rel=2 * HALF)


def test_a_fine_checker_far_away_is_its_mean_in_linear_light(store):
    rows, columns = np.mgrid[0:64, 0:64]
    pixels = ((rows + columns) % 2).astype(np.float32)[..., None].repeat(3, axis=2)
    texture = store.add_pixels("Checker", pixels, tests.ColorSpace.SRGB)
    far = look(store, texture, np.random.default_rng(3).random((20, 2)), width=0.5)[:, :3]
    np.testing.assert_allclose(far, 0.5, atol=2e-3)  # a mean of codes would give 0.21


def test_a_long_footprint_is_blurred_as_far_as_it_is_narrow(store):
    """And no further: what lies along it is the mean of samples that are spread there."""
    pixels = np.zeros((64, 64, 1), np.float32)
    pixels[::2] = 1  # stripes along u
    texture = store.add_pixels("Stripes", pixels, tests.ColorSpace.NON_COLOR)
    long, narrow, count = 0.2, 0.2 / 16, 128
    uv = np.stack([np.full(count, 0.37), 10.5 / 64 + long * (np.arange(count) / count - 0.5)], axis=1)
    wide, high = (np.tile(np.float32(each), (count, 1)) for each in ((long, 0), (0, narrow)))
    along = store.lookup(texture, np.float32(uv), wide, high, REPEAT, LINEAR)[:, 0]
    wide, high = (np.tile(np.float32(each), (count, 1)) for each in ((narrow, 0), (0, long)))
    across = store.lookup(texture, np.float32(uv), wide, high, REPEAT, LINEAR)[:, 0]
    np.testing.assert_array_equal(along, across)
    assert np.ptp(across) > 0.3
    assert across.mean() == pytest.approx(0.5, abs=0.02)


def test_colours_do_not_bleed_out_of_transparent_pixels(store):
    pixels = np.zeros((8, 8, 4), np.float32)
    pixels[..., 0] = 1  # red everywhere, but half of it transparent green
    pixels[:, 4:] = (0, 1, 0, 0)
    texture = store.add_pixels("Cutout", pixels, tests.ColorSpace.LINEAR)
    pixels[:, :4, 3] = 1
    texture = store.add_pixels("Cutout", pixels, tests.ColorSpace.LINEAR)
    edge = look(store, texture, [(0.5, 0.5)], EXTEND)[0]
    np.testing.assert_allclose(edge, (1, 0, 0, 0.5), atol=1e-5)


def test_data_keeps_its_channels_where_alpha_is_zero(store):
    pixels = np.full((4, 4, 4), (0.25, 0.5, 0.75, 0.0), np.float32)
    texture = store.add_pixels("Packed", pixels, tests.ColorSpace.NON_COLOR)
    np.testing.assert_allclose(look(store, texture, [(0.5, 0.5)])[0], pixels[0, 0], atol=1e-6)


def test_bright_panoramas_keep_their_sun(store):
    pixels = np.zeros((4, 4, 3), np.float32)
    pixels[1, 2] = 250000.0
    texture = store.add_pixels("Sky", pixels, tests.ColorSpace.LINEAR)
    assert look(store, texture, [(2.5 / 4, 1.5 / 4)])[0, 0] == 250000.0


def test_numbers_that_are_not_finite_come_out_finite(store):
    pixels = np.full((4, 4, 3), np.nan, np.float32)
    pixels[0, 0] = np.inf
    texture = store.add_pixels("Broken", pixels, tests.ColorSpace.LINEAR)
    uv = [(0.5, 0.5), (np.nan, 0.2), (np.inf, -np.inf), (1e30, 0.1)]
    assert np.isfinite(look(store, texture, uv)).all()
    assert np.isfinite(look(store, texture, uv, width=np.nan)).all()


def test_a_missing_file_is_named(store):
    with pytest.raises(_core.InputError, match="Bricks.*no/such/bricks.png"):
        store.add_file("Bricks", "/no/such/bricks.png", tests.ColorSpace.SRGB)


def test_a_file_that_is_no_image_is_named(store, tmp_path):
    path = tmp_path / "words.png"
    path.write_text("not a picture")
    with pytest.raises(_core.InputError, match="Words.*words.png"):
        store.add_file("Words", str(path), tests.ColorSpace.SRGB)


@pytest.mark.parametrize("content", [b"", b"words", b"\x89PNG\r\n\x1a\n", b"BM", b"v/1\x01" + bytes(40)])
def test_packed_bytes_that_are_no_image_are_named(content):
    with pytest.raises(_core.InputError, match="Words.*packed image"):
        _core.SceneDescription().add_packed_image("Words", content, "SRGB")


def torn_png():
    """A header, and half of the pixels."""
    rows = np.random.default_rng(5).integers(0, 256, (64, 1 + 3 * 64), dtype=np.uint8)
    rows[:, 0] = 0  # the filter

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", 64, 64, 8, 2, 0, 0, 0)
    whole = b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows.tobytes()))
    return whole[: len(whole) // 2]


def test_an_image_that_is_torn_is_refused_unless_it_is_left_out():
    scene = _core.SceneDescription()
    scene.set_camera("PERSPECTIVE", np.eye(4), (-0.5, -0.5), (0.5, 0.5), 0.01, 1000.0)
    scene.add_packed_image("Torn", torn_png(), "SRGB")
    scene.add_image_pixels("Whole", picture(8, 8, 3), "SRGB")
    settings = _core.Settings(width=4, height=4, samples=1)
    with pytest.raises(_core.InputError, match="Torn.*packed image.*readable"):
        _core.Session(scene, settings).render()
    ((name, reason),) = scene.leave_out_unreadable_images()
    assert name == "Torn" and "packed image" in reason
    _core.Session(scene, settings).render()


def test_a_torn_image_is_pink_everywhere(store, tmp_path):
    path = tmp_path / "torn.png"
    path.write_bytes(torn_png())
    texture = store.add_file("Torn", str(path), tests.ColorSpace.SRGB)
    found = look(store, texture, [(0.5, 0.5), (7.0, -3.0)], extension=CLIP)
    np.testing.assert_array_equal(found, [(1, 0, 1, 1)] * 2)


@pytest.mark.parametrize("shape", [(0, 4, 3), (4, 4, 2), (4, 4)])
def test_pixels_of_a_wrong_shape_are_rejected(store, shape):
    with pytest.raises(_core.InputError, match="Odd"):
        store.add_pixels("Odd", np.zeros(shape, np.float32), tests.ColorSpace.SRGB)


def test_an_image_file_reads_as_its_pixels(store, tmp_path):
    """A portable pixmap, the simplest there is: rows top to bottom."""
    codes = np.random.default_rng(4).integers(0, 256, (3, 5, 3), dtype=np.uint8)
    path = tmp_path / "small.ppm"
    path.write_bytes(b"P6\n5 3\n255\n" + codes.tobytes())
    texture = store.add_file("Small", str(path), tests.ColorSpace.SRGB)
    rows, columns = np.mgrid[0:3, 0:5]
    uv = np.stack([(columns.ravel() + 0.5) / 5, (rows.ravel() + 0.5) / 3], axis=1)
    found = look(store, texture, uv, EXTEND, CLOSEST)[:, :3]
    expected = linear_from_srgb(codes[::-1].reshape(-1, 3) / 255)
    np.testing.assert_allclose(found, expected, rtol=HALF, atol=1e-7)


def test_the_cache_keeps_to_its_limit():
    limit = 12 << 20
    store = tests.TextureStore(limit)
    names = [store.add_pixels(str(i), picture(1024, 1024, 3, i), tests.ColorSpace.LINEAR) for i in range(3)]
    everywhere = (np.stack(np.meshgrid(np.arange(32), np.arange(32)), -1).reshape(-1, 2) + 0.5) / 32
    for texture in names:  # 3 textures of 6 MB at the finest level
        look(store, texture, everywhere)
    statistics = store.statistics()
    assert statistics["textures"] == 3
    assert statistics["file_reads"] > 3 * 200
    assert statistics["bytes"] <= limit + (1 << 20)  # a tile may come in before another goes


@pytest.mark.slow
def test_a_texture_larger_than_the_limit_reads_as_with_room_for_it():
    pixels = picture(2048, 1024, 4)
    least = 10 << 20
    assert pixels.size * 2 > least  # in half precision
    places = np.random.default_rng(3).uniform(size=(2000, 2))
    found = []
    for limit in (least, 20 * least):
        store = tests.TextureStore(limit)
        found.append(look(store, store.add_pixels("Large", pixels, tests.ColorSpace.LINEAR), places))
        assert store.statistics()["bytes"] <= limit + (1 << 20)
    np.testing.assert_array_equal(*found)


def test_a_store_takes_its_files_and_tiles_with_it(tmp_path, monkeypatch):
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    store = tests.TextureStore(1 << 27)
    texture = store.add_pixels("Image", picture(256, 256, 3), tests.ColorSpace.LINEAR)
    look(store, texture, [(0.5, 0.5)])
    assert len(list(tmp_path.iterdir())) == 1
    del store
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("size", ((5, 3), (7, 64), (1, 9), (129, 130)))
@pytest.mark.parametrize("channels", (1, 3, 4))
def test_an_image_of_any_size_is_its_mean_from_far_away(store, size, channels):
    pixels = picture(*size, channels, 7)
    pixels[..., 3:] = 1
    texture = store.add_pixels("Odd", pixels, tests.ColorSpace.LINEAR)
    found = look(store, texture, [(0.5, 0.5)], width=4.0)[0, : min(channels, 3)]
    levels = np.log2(max(size)) + 1  # each is rounded to half floats
    np.testing.assert_allclose(found, pixels.mean(axis=(0, 1))[:3], rtol=levels * HALF)


WITHOUT_ROOM = """
import resource
import numpy as np
from rayleaf import _core
resource.setrlimit(resource.RLIMIT_FSIZE, (1 << 16, 1 << 16))
scene = _core.SceneDescription()
scene.set_camera("PERSPECTIVE", np.eye(4), (-0.5, -0.5), (0.5, 0.5), 0.01, 1000.0)
for name in ("small", "large"):
    side = 16 if name == "small" else 512
    scene.add_image_pixels(name, np.ones((side, side, 3), np.float32), "LINEAR")
try:
    _core.Session(scene, _core.Settings(width=4, height=4, samples=1)).render()
except _core.InputError as error:
    print(error)
"""


def test_an_image_for_which_the_disk_has_no_room_is_named():
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)}
    found = subprocess.run([sys.executable, "-c", WITHOUT_ROOM], capture_output=True, text=True, env=environment)
    assert found.stdout.startswith("object 'large': image is not convertible"), found


def test_an_image_is_converted_once_for_scenes_that_are_made_at_the_same_time(tmp_path, monkeypatch):
    """Of twenty images, looked up at once: while they are converted by other threads."""
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    store = tests.TextureStore(1 << 27)
    pictures = [picture(300, 200, 3, i) for i in range(20)]
    textures = [store.add_pixels(str(i), pixels, tests.ColorSpace.LINEAR) for i, pixels in enumerate(pictures)]
    again = [store.add_pixels(str(i), pixels, tests.ColorSpace.LINEAR) for i, pixels in enumerate(pictures)]
    for pixels, *same in zip(pictures, textures, again, strict=True):
        for texture in same:
            np.testing.assert_array_equal(
                look(store, texture, [(0.1025, 0.105)], interpolation=CLOSEST)[0, :3], pixels[31, 20]
            )
    (folder,) = tmp_path.iterdir()
    assert len(list(folder.iterdir())) == len(pictures)


@pytest.mark.parametrize("width", [0.0, 0.1])
@pytest.mark.parametrize("channels", [1, 3])
def test_clipped_borders_fade_with_and_without_alpha_alike(store, channels, width):
    """A white picture: where half of a footprint is outside, alpha is a half, and the colour is white still."""
    plain = store.add_pixels("plain", np.ones((8, 8, channels), np.float32), tests.ColorSpace.LINEAR)
    opaque = store.add_pixels("opaque", np.ones((8, 8, 4), np.float32), tests.ColorSpace.LINEAR)
    places = np.float32([[u, 0.5] for u in (-0.5, -0.04, 0.0, 0.001, 0.03, 0.3, 0.5, 0.99, 1.03, 1.5)])
    found, expected = (look(store, each, places, CLIP, width=width) for each in (plain, opaque))
    inside = expected[:, 3] > 0.02
    np.testing.assert_allclose(found[inside, :3], 1.0, atol=1e-3)
    # Footprints are filtered by Gaussian weights there, and by even ones here.
    np.testing.assert_allclose(found[:, 3], expected[:, 3], atol=0.01 if width == 0.0 else 0.15)
    assert np.all(found[expected[:, 3] == 0.0] == 0.0)


@pytest.mark.parametrize("extension", [EXTEND, CLIP])
@pytest.mark.parametrize("u", [1e7, 2.0**31, 1e38, -1e38])
def test_far_outside_is_as_a_little_outside(store, extension, u):
    texture = store.add_pixels("image", picture(4, 8, 4), tests.ColorSpace.LINEAR)
    near = look(store, texture, [(1.9 if u > 0 else -0.9, 0.3)], extension)
    np.testing.assert_array_equal(look(store, texture, [(u, 0.3)], extension), near)
