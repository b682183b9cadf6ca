"""Instances and cameras that move while the shutter is open: where they are, what rays meet, and what pictures show."""

import numpy as np
import pytest
from core import shapes
from path_scenes import material, picture, render
from scenes import background, emission, look_down, matrix, quad, sphere_spline

trace, EVERYTHING = shapes.trace, shapes.EVERYTHING


def turned(angle, axis=(0, 0, 1), place=(0, 0, 0), scale=(1, 1, 1)):
    """Scaled, then turned by Rodrigues' formula, then moved."""
    x, y, z = np.asarray(axis, float) / np.linalg.norm(axis)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    result = np.eye(4)
    result[:3, :3] = (np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross) @ np.diag(scale)
    result[:3, 3] = place
    return result


MOTIONS = {
    "along a line": [turned(0.3), turned(0.3, place=(1, 2, -0.5))],
    "half a turn": [turned(0), turned(3.1, (1, 2, 3), (0.5, 0, 0))],
    "two turns": [turned(a, (0, 1, 1)) for a in np.linspace(0, 4 * np.pi, 9)],
    "growing": [
        turned(0.2, scale=(0.5, 1, 1)),
        turned(1.2, (1, 0, 0), scale=(2, 0.3, 1)),
        turned(-0.7, place=(0, 1, 0)),
    ],
    "mirrored": [turned(0.4, scale=(-1, 1, 1)), turned(1.9, (0, 1, 0), (0, 0.4, 0), (-1.5, 1, 1))],
}


def test_rotations_turn_at_constant_speed_and_the_rest_goes_along_lines():
    axis = (1.0, -2.0, 0.5)
    for time in (0.0, 0.25, 0.6, 1.0):
        found = trace.moved(
            [turned(0.2, axis, scale=(1, 1, 1)), turned(2.8, axis, (1, 2, 3), (3, 3, 3))], np.float32(time)
        )
        share = float(np.float32(time))
        wanted = turned(0.2 + 2.6 * share, axis, np.array([1, 2, 3]) * share, [1 + 2 * share] * 3)
        np.testing.assert_allclose(found, wanted, atol=1e-14)


def test_outside_of_the_shutter_it_stands_where_it_begins_or_ends():
    places = [turned(0.3), turned(0.7, place=(1, 2, 3))]
    for time, wanted in ((-1.0, 0), (np.nan, 0), (2.0, 1), (np.inf, 1)):
        np.testing.assert_allclose(trace.moved(places, time), places[wanted], atol=1e-14)


def test_a_rotation_takes_the_short_way():
    halfway = trace.moved([turned(0), turned(np.radians(350))], 0.5)
    np.testing.assert_allclose(halfway, turned(np.radians(-5)), atol=1e-14)


@pytest.mark.parametrize("flat", [0, 1, 2])
def test_a_motion_through_a_flat_place_goes_along_lines(flat):
    places = [turned(0.1 * i, place=(i, 0, 0)) for i in range(3)]
    places[flat] = turned(0.3, scale=(1, 1, 0))
    np.testing.assert_allclose(trace.moved(places, 0.25), 0.5 * (places[0] + places[1]), atol=1e-15)


def many(shape, motion, at_rest, count):
    """A tracer of an instance that moves among others that do not; `at_rest`: where it is in place of moving."""
    placed = [(shape, np.asarray(motion[0] if at_rest is None else at_rest, float), EVERYTHING)]
    placed += [(shapes.cube(), shapes.moved(4.0 + i), EVERYTHING) for i in range(count - 1)]
    motions = {0: np.array(motion)} if at_rest is None else {}
    return trace.Tracer(placed, pixel_angle=1.0, motions=motions)  # facets as coarse as can be, wherever the eye is


def rays_around(count, seed):
    random = np.random.default_rng(seed)
    origins = 5 * shapes.random_directions(random, count)
    return origins, shapes.unit(1.2 * shapes.random_directions(random, count) - origins)


@pytest.mark.parametrize("count", [1, 6])
@pytest.mark.parametrize("name", ["cube", "nurbs_sphere", "lumpy_torus"])
@pytest.mark.parametrize("motion", MOTIONS)
def test_what_moves_is_met_as_if_it_stood_there(motion, name, count, any_target):
    shape, places = getattr(shapes, name)(), MOTIONS[motion]
    origins, directions = rays_around(400, 5)
    moving = many(shape, places, None, count)
    of_all = []
    for time in (0.0, 0.3125, 0.5, 0.875, 1.0):
        times = np.full(400, time, np.float32)
        still = many(shape, places, trace.moved(places, time), count)
        wanted = still.closest_hits(origins, directions)
        assert (wanted["instance"] == 0).any()
        for together in (1, 64):
            found = moving.closest_hits(origins, directions, times=times, together=together)
            for key in wanted:
                np.testing.assert_array_equal(found[key], wanted[key], err_msg=f"{key} at {time}")
        np.testing.assert_array_equal(
            moving.occluded(origins, directions, times=times), still.occluded(origins, directions)
        )
        of_all.append(wanted["t"])
    assert not np.array_equal(of_all[0], of_all[1])


@pytest.mark.parametrize("count", [1, 6])
def test_rays_of_a_packet_meet_each_its_own_time(count, any_target):
    times = np.random.default_rng(7).random(800).astype(np.float32)
    origins, directions = rays_around(800, 8)
    for name in ("cube", "nurbs_sphere"):
        moving = many(getattr(shapes, name)(), MOTIONS["growing"], None, count)
        alone = moving.closest_hits(origins, directions, times=times)
        for coherent in (False, True):
            found = trace.closest_in_packets(moving, origins, directions, coherent, times)
            for key in ("t", "instance", "primitive", "position"):
                hit = alone["instance"] >= 0
                np.testing.assert_array_equal(found[key][hit], alone[key][hit])
            np.testing.assert_array_equal(found["instance"], alone["instance"])
            hidden = trace.occluded_in_packets(moving, origins, directions, coherent=coherent, times=times)
            np.testing.assert_array_equal(hidden, alone["instance"] >= 0)


@pytest.mark.parametrize("name", ["cube", "nurbs_sphere"])
def test_nothing_leaks_out_of_a_closed_shape_that_moves(name):
    count = 20_000
    random = np.random.default_rng(9)
    times = random.random(count).astype(np.float32)
    for places in MOTIONS.values():
        inside = 0.3 * shapes.random_directions(random, count)
        maps = np.array([trace.moved(places, time) for time in times[:2000]])
        origins = np.einsum("nij,nj->ni", maps[:, :3, :3], inside[:2000]) + maps[:, :3, 3]
        hits = many(getattr(shapes, name)(), places, None, 5).closest_hits(
            origins, shapes.random_directions(random, 2000), times=times[:2000]
        )
        assert (hits["instance"] == 0).all()


@pytest.mark.parametrize("motion", MOTIONS)
def test_bounds_hold_all_places(motion):
    low, high = many(shapes.cube(), MOTIONS[motion], None, 1).bounds()
    for time in np.linspace(0, 1, 101):
        corners = shapes.CUBE_VERTICES @ trace.moved(MOTIONS[motion], time)[:3, :3].T
        corners = corners + trace.moved(MOTIONS[motion], time)[:3, 3]
        assert (corners >= np.array(low)).all() and (corners <= np.array(high)).all()
    reach = max(np.abs(corners).max() for corners in (np.array(low), np.array(high)))
    assert reach < 8  # not just large


def scene_of(core, of_ball=None, place=None, **camera):
    """A dark ball above a bright floor under a bright sky."""
    scene = core.SceneDescription()
    dark, bright = (material(core, scene, ("diffuse", 1.0, albedo)) for albedo in (0.05, 0.9))
    scene.add_instance("floor", quad(scene, "floor", 4.0), matrix((0, 0, -1)), bright)
    ball = scene.add_surface("ball", [sphere_spline(core)])
    scene.add_instance("ball", ball, matrix() if place is None else place, dark, motion=of_ball)
    scene.set_world(background(core, (0.5, 0.7, 1.0)), 0)
    look_down(scene, height=6.0, half=0.5, **camera)
    return scene


SWING = np.array([turned(0.0, place=(-1, 0, 0)), turned(1.5, place=(0, 0.5, 0)), turned(2.5, (1, 0, 1), (1, 0, 0.5))])


def sub_frames(picture_at, count=16):
    """The mean of pictures in the middle of even parts of the shutter's time."""
    return np.mean([picture_at((i + 0.5) / count) for i in range(count)], 0)


def assert_like(blurred, mean, sharp):
    """Equal up to noise, and another picture than that of the middle."""
    apart, blur = np.abs(blurred - mean).mean(), np.abs(sharp - mean).mean()
    assert apart < 0.01 * mean.mean() + 0.25 * blur  # few samples, and few sub-frames
    assert abs(blurred.mean() / mean.mean() - 1) < 0.01
    assert blur > 0.03 * mean.mean()


SMALL = dict(size=12, max_bounces=2)


def test_a_blurred_object_is_the_mean_of_sub_frames(core):
    mean = sub_frames(lambda t: picture(core, scene_of(core, place=trace.moved(SWING, t)), samples=32, **SMALL))
    sharp = picture(core, scene_of(core, place=trace.moved(SWING, 0.5)), samples=256, **SMALL)
    assert_like(picture(core, scene_of(core, SWING), samples=512, **SMALL), mean, sharp)


@pytest.mark.slow
def test_a_moving_light_lights_as_the_mean_of_sub_frames(core):
    def lit(motion=None, place=None):
        scene = core.SceneDescription()
        grey = material(core, scene, ("diffuse", 1.0, 0.6))
        scene.add_instance("floor", quad(scene, "floor", 4.0), matrix((0, 0, -1)), grey)
        glow = scene.add_material_list([scene.add_material("glow", emission(core, strength=20.0))])
        scene.add_instance("lamp", quad(scene, "lamp", 0.3), matrix() if place is None else place, glow, motion=motion)
        look_down(scene, height=6.0, half=0.5)
        return scene

    swing = SWING + matrix((0, 0, 1)) - np.eye(4)
    mean = sub_frames(lambda t: picture(core, lit(place=trace.moved(swing, t)), samples=128, **SMALL))
    sharp = picture(core, lit(place=trace.moved(swing, 0.5)), samples=128, **SMALL)
    assert_like(picture(core, lit(swing), samples=4096, **SMALL), mean, sharp)


CAMERA = np.array([turned(0, place=(-0.5, 0, 6)), turned(0.4, place=(0, 0.3, 6)), turned(0.2, (1, 0, 1), (0.5, 0, 5))])


@pytest.mark.parametrize("kind", ["PERSPECTIVE", "ORTHOGRAPHIC", "PANORAMIC"])
def test_a_moving_camera_shows_the_mean_of_sub_frames(core, kind):
    half = 2.5 if kind == "ORTHOGRAPHIC" else 0.5

    def seen(place, **more):
        scene = scene_of(core)
        if kind == "PANORAMIC":
            more["panorama"] = core.Panorama("FISHEYE_EQUIDISTANT", field_of_view=1.2)
        scene.set_camera(kind, place, (-half, -half), (half, half), 0.01, 1000.0, **more)
        return scene

    mean = sub_frames(lambda t: picture(core, seen(trace.moved(CAMERA, t)), samples=32, **SMALL))
    sharp = picture(core, seen(trace.moved(CAMERA, 0.5)), samples=256, **SMALL)
    assert_like(picture(core, seen(CAMERA[1], motion=CAMERA), samples=512, **SMALL), mean, sharp)


def test_a_zooming_camera_shows_the_mean_of_sub_frames(core):
    def corners(half):
        return [-half, -half, half, half]

    mean = sub_frames(
        lambda t: picture(core, scene_of_window(core, 0.2 + 0.6 * t), samples=32, **SMALL),
    )
    zoomed = scene_of(core, windows=np.array([corners(0.2), corners(0.5), corners(0.8)]))
    assert_like(picture(core, zoomed, samples=512, **SMALL), mean, picture(core, scene_of(core), samples=256, **SMALL))


def scene_of_window(core, half):
    scene = scene_of(core)
    look_down(scene, height=6.0, half=half)
    return scene


@pytest.mark.slow
def test_the_shutters_curve_weighs_times(core):
    line = np.array([matrix((-1.5, 0, 0)), matrix((1.5, 0, 0))])
    curve = np.array([0, 0, 0, 1, 1], np.float32)  # rises from a half to three quarters of the time
    weights = np.interp((np.arange(64) + 0.5) / 64, np.linspace(0, 1, 5), curve)
    at = [
        picture(core, scene_of(core, place=trace.moved(line, (i + 0.5) / 64)), samples=16, **SMALL) for i in range(64)
    ]
    mean = np.average(at, axis=0, weights=weights)
    blurred = picture(core, scene_of(core, line, shutter_curve=curve), samples=512, **SMALL)
    # Between two numbers of the curve all times count alike: so much the means may differ.
    assert np.abs(blurred - mean).mean() < 0.02
    assert np.abs(np.mean(at, 0) - mean).mean() > 0.04


def test_a_rolling_shutter_shows_each_row_at_its_time(core):
    line = np.array([matrix((-1.5, 0, 0)), matrix((1.5, 0, 0))])
    size = 12
    rolled = picture(core, scene_of(core, line, rolling_shutter=0.0), samples=256, size=size, max_bounces=2)
    for row in range(size):
        time = 1 - (row + 0.5) / size
        wanted = picture(core, scene_of(core, place=trace.moved(line, time)), samples=256, size=size, max_bounces=2)
        assert np.abs(rolled[row] - wanted[row]).mean() < 0.03


def test_blurred_pictures_have_the_same_bits_for_threads_tiles_streams_and_caches(core):
    camera = dict(motion=CAMERA, shutter_curve=np.array([0.2, 1.0, 0.1], np.float32))
    made = scene_of(core, SWING, **camera)
    pictures = [
        picture(core, made, size=12, samples=16, **more)
        for more in (
            dict(threads=1),
            dict(threads=3, tile_size=5),
            dict(stream_paths=0),
            dict(stream_paths=100),
            dict(resident_megabytes=0.0),
        )
    ]
    for other in pictures[1:4]:
        np.testing.assert_array_equal(other, pictures[0])
    assert np.abs(pictures[4] - pictures[0]).mean() < 0.02  # facets of other sizes


def test_a_ray_cache_answers_for_an_object_that_moves(core):
    def mirrored(mode):
        scene = core.SceneDescription()
        mirror = material(core, scene, ("glossy", 1.0, 0.9, 0.0, "SHARP"))
        scene.add_instance("ball", scene.add_surface("ball", [sphere_spline(core)]), matrix(), mirror, motion=SWING)
        scene.set_world(background(core, (0.5, 0.7, 1.0)), 0)
        look_down(scene, height=6.0, half=0.5)
        return render(
            core, scene, size=16, samples=64, max_bounces=2, ray_interpolation=core.RayInterpolation(mode=mode)
        )

    traced, cached = (mirrored(mode).pass_pixels("combined") for mode in ("OFF", "ON"))
    assert np.abs(traced - cached).mean() < 0.01


def test_scenes_without_motion_ask_for_no_times(core):
    """A motion that stands still is none, to the bit."""
    still = scene_of(core, np.array([matrix(), matrix(), matrix()]))
    np.testing.assert_array_equal(picture(core, still), picture(core, scene_of(core)))


@pytest.mark.parametrize(
    "motion,words",
    [
        (np.array([np.eye(4)]), "two matrices"),
        (np.full((3, 4, 4), np.nan), "matrix"),
        (np.array([np.eye(4), matrix((1e200, 0, 0))]), "motion"),
        (np.eye(4), "motion"),
    ],
)
def test_motions_that_are_none_are_refused_by_name(core, motion, words):
    for add in (
        lambda: scene_of(core, motion),
        lambda: scene_of(core).set_camera("PERSPECTIVE", np.eye(4), (-1, -1), (1, 1), 0.1, 9.0, motion=motion),
    ):
        with pytest.raises((core.InputError, ValueError), match="motion|matrix|location"):
            add()
    with pytest.raises(core.InputError, match=words):
        scene_of(core, motion)


@pytest.mark.parametrize(
    "arguments",
    [
        dict(windows=np.array([[-1.0, -1, 1, 1]])),
        dict(windows=np.array([[-1.0, -1, 1, 1], [1, 1, -1, -1]])),
        dict(shutter_curve=np.array([np.nan, 1], np.float32)),
        dict(shutter_curve=np.array([1], np.float32)),
        dict(rolling_shutter=1.5),
        dict(rolling_shutter=float("nan")),
    ],
)
def test_shutters_that_are_none_are_refused(core, arguments):
    with pytest.raises(core.InputError, match="camera"):
        scene_of(core, **arguments)


@pytest.mark.parametrize(
    "scales", [[(0, 0, 0), (1, 1, 1)], [(1, 1, 1), (-1, -1, -1)], [(1, 1, 0), (0, 1, 1)], [(1e-30,) * 3, (1, 1, 1)]]
)
def test_an_object_that_is_flat_for_a_while_spoils_no_pixel(core, scales):
    motion = np.array([turned(0.3 * i, scale=scale) for i, scale in enumerate(scales)])
    found = picture(core, scene_of(core, motion), size=12, samples=16)
    assert np.isfinite(found).all() and found.max() <= 1.5


def vectors_of(core, scene):
    return render(core, scene, size=8, samples=4, passes=["combined", "vector"])


def test_vectors_say_where_a_point_was_and_will_be(core):
    scene = core.SceneDescription()
    places = np.array([matrix((-0.5, 0, 0)), matrix(), matrix((1.0, 0.25, 0))])
    scene.add_instance("card", quad(scene, "card", 0.5), matrix(), motion=places)
    scene.set_camera("ORTHOGRAPHIC", matrix((0, 0, 5)), (-1, -1), (1, 1), 0.1, 9.0)
    found = vectors_of(core, scene).pass_pixels("vector")
    wanted = np.zeros((8, 8, 4))
    wanted[2:6, 2:6] = (-2, 0, -4, -1)  # a pixel is a quarter wide
    np.testing.assert_allclose(found, wanted, atol=1e-5)


def test_vectors_of_a_camera_are_those_of_a_world_that_moves_the_other_way(core):
    places = np.array([matrix((-0.5, 0, 5)), matrix((0, 0, 5)), matrix((1.0, 0.25, 5))])
    for kind, half in (("PERSPECTIVE", 0.2), ("ORTHOGRAPHIC", 1.0)):
        scene = core.SceneDescription()
        scene.add_instance("card", quad(scene, "card", 0.5), matrix())
        scene.set_camera(kind, places[1], (-half, -half), (half, half), 0.1, 9.0, motion=places)
        found = vectors_of(core, scene).pass_pixels("vector")[4, 4]
        np.testing.assert_allclose(found, (2, 0, 4, 1), atol=1e-5)


@pytest.mark.parametrize("kind", ["EQUIRECTANGULAR", "FISHEYE_EQUIDISTANT", "FISHEYE_EQUISOLID", "MIRRORBALL"])
def test_vectors_of_panoramas_are_measured_by_where_their_rays_go(core, kind):
    """A wall all around turns by as much as the camera: what a pixel shows is found where the vector says."""
    scene = core.SceneDescription()
    scene.add_instance("room", scene.add_surface("room", [sphere_spline(core, radius=9.0)]), matrix())
    tip = turned(-np.pi / 2, (-1, 0, 0))
    places = np.array([tip @ turned(angle, (0, 1, 0)) for angle in (-0.1, 0.0, 0.2)])
    panorama = core.Panorama(kind, field_of_view=2.0, lens=12.0, sensor=(30.0, 30.0))
    pixels = {}
    for name, place, motion in (("now", places[1], places), ("next", places[2], None)):
        scene.set_camera("PANORAMIC", place, (0, 0), (1, 1), 0.1, 99.0, panorama=panorama, motion=motion)
        session = render(core, scene, size=32, samples=1, passes=["combined", "vector", "position"])
        pixels[name] = {each: session.pass_pixels(each) for each in ("vector", "position")}
    tried = 0
    for row, column in ((16, 16), (12, 18), (20, 11), (16, 22)):
        step = pixels["now"]["vector"][row, column, 2:]
        there = np.round(np.array([column, row]) - step).astype(int)
        if (there < 0).any() or (there > 31).any():
            continue
        apart = pixels["next"]["position"][there[1], there[0]] - pixels["now"]["position"][row, column]
        assert np.linalg.norm(step) > 0.5
        # Of one sample in a pixel each, and rounded to whole pixels; the way of the wall is 1.8.
        assert np.linalg.norm(apart) < 1.3 * 9.0 * 2 * np.pi / 32
        tried += 1
    assert tried > 1


def test_pictures_with_vectors_are_sharp(core):
    moving, still = scene_of(core, SWING, motion=CAMERA), scene_of(core)
    np.testing.assert_array_equal(
        vectors_of(core, moving).pass_pixels("combined"), vectors_of(core, still).pass_pixels("combined")
    )
