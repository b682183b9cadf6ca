"""Panoramic cameras: where they look, nothing outside their circle, and bad numbers."""

import numpy as np
import pytest
from path_scenes import render
from scenes import background, matrix, quad

QUARTER = np.pi / 2


def around(core, **panorama):
    """A world whose colour is half the direction plus a half, seen from its middle along +y, z up."""
    scene = core.SceneDescription()
    program = core.Program("world")
    half, one = program.constant(0.5, 0.5, 0.5, 1), program.constant(1, 1, 1, 1)
    color = program.operation("vector_math", [program.operation("generated"), half, half, one], text="MULTIPLY_ADD")
    program.operation("background", [one, color, one])
    scene.set_world(program, 0)
    place = np.eye(4)
    place[:3, :3] = np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]])
    scene.set_camera("PANORAMIC", place, (0, 0), (1, 1), 0.1, 100.0, panorama=core.Panorama(**panorama))
    return scene


def directions(core, size=64, samples=4, **panorama):
    """(height, width, 3) and where there is none."""
    passes = ["combined", "environment", "depth"]
    session = render(core, around(core, **panorama), size=size, samples=samples, passes=passes)
    pixels = session.pass_pixels("combined")
    assert np.all(pixels[..., 3] == 1)
    return pixels[..., :3] * 2 - 1, np.all(pixels[..., :3] == 0, axis=-1)


def angles(size):
    """Of pixels' middles, from -1 to 1."""
    return (np.arange(size) + 0.5) / size * 2 - 1


def test_an_equirectangular_picture_has_longitude_across_and_latitude_up(core):
    found, empty = directions(core, kind="EQUIRECTANGULAR")
    longitude, latitude = angles(64)[None, :] * np.pi, angles(64)[:, None] * QUARTER
    wanted = np.stack(
        np.broadcast_arrays(
            np.cos(latitude) * np.sin(longitude), np.cos(latitude) * np.cos(longitude), np.sin(latitude)
        ),
        -1,
    )
    assert not empty.any()
    assert np.abs(found - wanted).max() < 0.06  # half a pixel is 0.05 across


@pytest.mark.parametrize("kind", ["FISHEYE_EQUIDISTANT", "FISHEYE_EQUISOLID"])
def test_fisheyes_show_a_circle_up_to_half_their_angle(core, kind):
    view = 2.8
    lens = 18.0 / (2 * np.sin(view / 4))  # the circle touches the picture's sides
    found, empty = directions(core, kind=kind, field_of_view=view, lens=lens, sensor=(36.0, 36.0))
    x, y = np.meshgrid(angles(64), angles(64))
    radius = np.hypot(x, y)
    assert np.all(empty[radius > 1.03]) and not empty[radius < 0.97].any()
    angle = (
        radius * view / 2 if kind == "FISHEYE_EQUIDISTANT" else 2 * np.arcsin(np.minimum(radius * 18 / (2 * lens), 1))
    )
    wanted = np.stack([np.sin(angle) * x / radius, np.cos(angle), np.sin(angle) * y / radius], -1)
    inside = radius < 0.95
    assert np.abs(found - wanted)[inside].max() < 0.06
    assert np.all(found[empty] == -1)  # black


def test_a_mirror_ball_shows_what_lies_behind_it_at_its_rim(core):
    found, empty = directions(core, kind="MIRRORBALL")
    x, y = np.meshgrid(angles(64), angles(64))
    square = x * x + y * y
    assert np.all(empty[square > 1.06]) and not empty[square < 0.94].any()
    inside = square < 0.8
    towards = np.sqrt(np.maximum(1 - square, 0))
    wanted = np.stack([2 * towards * x, 2 * towards * towards - 1, 2 * towards * y], -1)
    assert np.abs(found - wanted)[inside].max() < 0.12


@pytest.mark.parametrize("integrator", ["PATH", "DISTRIBUTION"])
def test_panoramas_measure_depth_from_the_eye_and_have_the_same_bits_for_any_threads(core, integrator):
    def pictures(**settings):
        scene = around(core, kind="FISHEYE_EQUIDISTANT", field_of_view=3.0)
        upright = np.array([[1, 0, 0, 0], [0, 0, -1, 5], [0, 1, 0, 0], [0, 0, 0, 1.0]])
        scene.add_instance("wall", quad(scene, "wall", 2.0), upright)
        passes = ["combined", "depth", "mist", "slot0", "crypto_object_00", "denoising_albedo"]
        session = render(core, scene, size=24, samples=3, integrator=integrator, passes=passes, **settings)
        return [session.pass_pixels(name) for name in passes]

    first = pictures(threads=1)
    for other in (pictures(threads=6, tile_size=8), pictures(stream_paths=0)):
        assert all(np.array_equal(one, two) for one, two in zip(first, other, strict=True))
    depth = first[1][..., 0]
    assert depth[12, 12] == pytest.approx(5.0, rel=0.02)
    assert depth[12, 14] > depth[12, 12] and depth[0, 0] == np.float32(1e10)
    assert np.all(np.isfinite(np.concatenate([each.ravel() for each in first])))


def test_numbers_that_show_nothing_are_rejected(core):
    for arguments in (
        dict(kind="CYLINDER"),
        dict(kind="EQUIRECTANGULAR", longitudes=(0.0, 9.0)),
        dict(kind="EQUIRECTANGULAR", latitudes=(-2.0, 1.0)),
        dict(kind="FISHEYE_EQUISOLID", lens=0.0),
        dict(kind="FISHEYE_EQUIDISTANT", field_of_view=np.nan),
    ):
        with pytest.raises(core.InputError, match="camera"):
            core.Panorama(**arguments)


def test_an_open_lens_blurs_what_is_out_of_focus(core):
    def edge(radius):
        scene = core.SceneDescription()
        upright = np.array([[1, 0, 0, 1.0], [0, 0, -1, 5], [0, 1, 0, 0], [0, 0, 0, 1.0]])
        scene.add_instance("wall", quad(scene, "wall", 1.0), upright)
        scene.set_world(background(core), 0)
        place = matrix()
        place[:3, :3] = np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]])
        panorama = core.Panorama("FISHEYE_EQUIDISTANT", field_of_view=1.0)
        scene.set_camera("PANORAMIC", place, (0, 0), (1, 1), 0.1, 100.0, aperture_radius=radius, focus_distance=1.0,
                         panorama=panorama)  # fmt: skip
        depth = render(core, scene, size=33, samples=64, passes=["combined", "mist"], mist_start=0.0, mist_depth=50.0)
        return np.abs(np.diff(depth.pass_pixels("mist")[16, :, 0])).max()

    assert edge(0.3) < 0.7 * edge(0.0)


def seen_by_eye(core, **stereo):
    """What an eye sees of the world: where it looks."""
    scene = around(core, kind="EQUIRECTANGULAR", **stereo)
    return render(core, scene, size=32, samples=1, passes=["combined"]).pass_pixels("combined")[..., :3]


def test_eyes_in_parallel_see_what_is_far_as_one_eye_does(core):
    middle = seen_by_eye(core)
    assert np.array_equal(seen_by_eye(core, eye_offset=0.4), middle)
    assert np.abs(seen_by_eye(core, eye_offset=0.4, convergence=1.0) - middle).max() > 0.1
    merged = seen_by_eye(core, eye_offset=0.4, convergence=1.0, pole_merge=(0.2, 0.5))
    assert np.array_equal(merged[[0, -1]], middle[[0, -1]]) and not np.array_equal(merged[16], middle[16])


@pytest.mark.parametrize("bad", [dict(eye_offset=np.nan), dict(convergence=0.0), dict(pole_merge=(0.1, 2.0))])
def test_bad_numbers_of_eyes_are_named(core, bad):
    with pytest.raises(ValueError, match="eye|convergence|pole"):
        core.Panorama("EQUIRECTANGULAR", **bad)
