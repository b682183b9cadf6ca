"""Shapes that deform while the shutter is open: what rays meet at each time, and what pictures show."""

import numpy as np
import pytest
from core import shapes
from path_scenes import material, picture, render
from scenes import background, emission, look_down, matrix, quad, sphere_points, sphere_spline

trace, EVERYTHING = shapes.trace, shapes.EVERYTHING
TIMES = (0.0, 0.3125, 0.5, 0.875, 1.0)


def mixed(steps, time):
    """Points at a time, where those at even steps are known."""
    place = time * (len(steps) - 1)
    first = min(int(place), len(steps) - 2)
    return steps[first] + (steps[first + 1] - steps[first]) * (place - first)


def twisted(points, angle, lift):
    """Points turned about z the more the higher they are, stretched and lifted."""
    turn = angle * points[:, 2]
    x, y = points[:, 0], points[:, 1]
    return np.stack(
        [np.cos(turn) * x - np.sin(turn) * y, np.sin(turn) * x + np.cos(turn) * y, points[:, 2] * (1 + lift) + lift], 1
    )


def cube_steps(count=3):
    return np.array([twisted(shapes.CUBE_VERTICES, 0.7 * i - 0.7, 0.2 * i) for i in range(count)], np.float32)


def mesh(core, vertices, moved=None):
    scene = core.SceneDescription()
    return scene.shape(
        scene.add_mesh("cube", np.array(vertices, np.float32), shapes.CUBE_TRIANGLES, moved_vertices=moved)
    )


def cube(core, steps=None, time=None):
    """A cube that deforms; with a time, one that rests as it is then."""
    steps = cube_steps() if steps is None else steps
    return mesh(core, mixed(steps, 0.5), steps) if time is None else mesh(core, mixed(steps, time))


def hair_steps(count=3):
    """Forty strands of six points that bend, from a floor: (steps, n, 4)."""
    random = np.random.default_rng(3)
    roots, lean = random.uniform(-1, 1, (40, 1, 2)), random.normal(0, 0.2, (40, 1, 2))
    along = np.linspace(0, 1, 6)[None, :, None]
    steps = []
    for i in range(count):
        wind = np.array([0.5 * i, -0.3 * i * i])
        flat = roots + lean * along + wind * along**2
        points = np.concatenate([flat, np.broadcast_to(1.5 * along - 0.7, (40, 6, 1))], 2)
        steps.append(np.concatenate([points, np.full((40, 6, 1), 0.05 + 0.01 * i)], 2).reshape(-1, 4))
    return np.array(steps)


def hair(core, form="ROUND", steps=None, time=None):
    steps = hair_steps() if steps is None else steps
    now = mixed(steps, 0.5 if time is None else time)
    return core.Strands(
        "hair",
        np.ascontiguousarray(now[:, :3]),
        now[:, 3].astype(np.float32),
        np.arange(0, 241, 6, dtype=np.int32),
        form=form,
        moved_points=steps if time is None else None,
    )


def ball_steps(count=3):
    """The control points of a NURBS sphere that is twisted and stretched: (steps, 5, 8, 4)."""
    rest = sphere_points(1.2)
    steps = [twisted(rest[..., :3].reshape(-1, 3), 0.5 * i - 0.5, 0.2 * i).reshape(5, 8, 3) for i in range(count)]
    return np.array([np.concatenate([points, rest[..., 3:]], 2) for points in steps])


def ball(core, steps=None, time=None):
    steps = ball_steps() if steps is None else steps
    scene = core.SceneDescription()
    now = [sphere_spline(core, points=np.array(mixed(steps, 0.5 if time is None else time)))]
    moved = [[sphere_spline(core, points=np.array(points))] for points in steps] if time is None else []
    return scene.shape(scene.add_surface("ball", now, moved))


def tube_steps():
    """The control points of a tube that is straight in the middle of the time, and wavy at both ends: (3, 9, 8, 4)."""
    around = -2 * np.pi * np.arange(8) / 8
    rest = np.ones((9, 8, 4))
    rest[..., 0], rest[..., 1], rest[..., 2] = np.cos(around), np.sin(around), np.linspace(-1, 1, 9)[:, None]
    steps = np.stack([rest] * 3)
    for step, wave in zip(steps, (-0.4, 0.0, 0.4), strict=True):
        step[..., :2] *= 1 + wave * (-1.0) ** np.arange(9)[:, None, None]
    return steps


def tube(core, time=None):
    scene = core.SceneDescription()

    def at(points):
        return [core.NurbsSpline(np.array(points), 4, 3, cyclic_u=True)]

    moved = [at(points) for points in tube_steps()] if time is None else []
    return scene.shape(scene.add_surface("tube", at(mixed(tube_steps(), 0.5 if time is None else time)), moved))


def cage(core, steps=None, time=None):
    """The limit of a cube's subdivision."""
    steps = 1.4 * cube_steps() if steps is None else steps
    return core.SubdivisionSurface(
        "cage",
        mixed(steps, 0.5 if time is None else time).astype(np.float32),
        np.full(6, 4, np.int32),
        np.array(shapes.CUBE_QUADS, np.int32).ravel(),
        moved_vertices=steps.astype(np.float32) if time is None else None,
    )


SHAPES = {
    "cube": cube,
    "NURBS ball": ball,
    "wavy tube": tube,
    "subdivided cube": cage,
    "round hair": hair,
    "ribbons": lambda core, **more: hair(core, "RIBBON", **more),
    "balls": lambda core, **more: hair(core, "SPHERES", **more),
    "Embree's curves": lambda core, **more: hair(core, "EMBREE_ROUND", **more),
}


def tracer(shape, count=1):
    placed = [(shape, np.eye(4), EVERYTHING)]
    placed += [(shapes.cube(), shapes.moved(5.0 + i), EVERYTHING) for i in range(count - 1)]
    return trace.Tracer(placed, pixel_angle=1e-4, eye=(0.0, 0.0, 6.0))  # fine: two dicings of a surface differ


def rays_around(count, seed):
    random = np.random.default_rng(seed)
    origins = 5 * shapes.random_directions(random, count)
    return origins, shapes.unit(random.uniform(-1.2, 1.2, (count, 3)) - origins)


@pytest.mark.parametrize("name", SHAPES)
def test_what_deforms_is_met_as_if_it_had_that_form(core, name):
    origins, directions = rays_around(1000, 5)
    moving = tracer(SHAPES[name](core))
    of_all = []
    for time in TIMES:
        wanted = tracer(SHAPES[name](core, time=time)).closest_hits(origins, directions)
        found = moving.closest_hits(origins, directions, times=np.full(1000, time, np.float32))
        both = (wanted["instance"] == 0) & (found["instance"] == 0)
        assert both.sum() > 100
        assert (wanted["instance"] == found["instance"]).mean() > 0.995  # but at outlines, by rounding
        # A ray along an outline may meet what is behind.
        close = np.isclose(found["t"][both], wanted["t"][both], atol=2e-4)
        assert close.mean() > 0.99, (name, time)
        of_all.append(wanted["t"])
    assert not np.array_equal(of_all[0], of_all[-1])


@pytest.mark.parametrize("count", [1, 6])
@pytest.mark.parametrize("name", SHAPES)
def test_rays_of_a_packet_meet_each_the_form_of_its_time(core, name, count, any_target):
    times = np.random.default_rng(7).random(800).astype(np.float32)
    origins, directions = rays_around(800, 8)
    moving = tracer(SHAPES[name](core), count)
    alone = moving.closest_hits(origins, directions, times=times)
    hit = alone["instance"] >= 0
    assert hit.sum() > 100
    for coherent in (False, True):
        found = trace.closest_in_packets(moving, origins, directions, coherent, times)
        np.testing.assert_array_equal(found["instance"], alone["instance"])
        for key in ("t", "primitive", "position"):
            np.testing.assert_array_equal(found[key][hit], alone[key][hit])
        hidden = trace.occluded_in_packets(moving, origins, directions, coherent=coherent, times=times)
        np.testing.assert_array_equal(hidden, hit)


@pytest.mark.parametrize("name", ["cube", "NURBS ball", "subdivided cube"])
def test_nothing_leaks_out_of_a_closed_shape_that_deforms(core, name):
    count = 20_000
    random = np.random.default_rng(9)
    times = random.random(count).astype(np.float32)
    bent = np.array([twisted(shapes.CUBE_VERTICES, 0.2 * i - 0.3, 0.2 * i) for i in range(4)])
    made = ball(core, ball_steps(4)) if name == "NURBS ball" else SHAPES[name](core, steps=bent.astype(np.float32))
    origins = 0.1 * shapes.random_directions(random, count) + np.array([0, 0, 0.4])
    hits = tracer(made, 5).closest_hits(origins, shapes.random_directions(random, count), times=times)
    assert (hits["instance"] == 0).all()


PIXEL = 4e-4  # as an angle


def half_width(shape, time, pixel_angle, heights, eye):
    """How far the outline of a shape reaches to the side, at heights where it passes the z axis."""
    seen = trace.Tracer([(shape, np.eye(4), EVERYTHING)], pixel_angle=pixel_angle, eye=tuple(eye))
    inside, outside = np.zeros_like(heights), np.full_like(heights, 3.0)
    origins, times = np.broadcast_to(eye, (len(heights), 3)).copy(), np.full(len(heights), time, np.float32)
    for _ in range(16):
        middle = (inside + outside) / 2
        towards = shapes.unit(np.stack([np.zeros_like(heights), middle, heights], 1) - origins)
        hit = seen.closest_hits(origins, towards, times=times)["instance"] == 0
        inside, outside = np.where(hit, middle, inside), np.where(hit, outside, middle)
    return inside


@pytest.mark.slow
@pytest.mark.parametrize("name", ["NURBS ball", "wavy tube", "subdivided cube"])
def test_outlines_lie_within_a_tenth_of_a_pixel_of_those_of_sub_frames(core, name):
    eye, heights = np.array([6.0, 0.0, 0.3]), np.linspace(-0.5, 0.6, 23)
    make = SHAPES[name]
    moving, widths = make(core), []
    for time in (np.arange(64) + 0.5) / 64:
        widths.append(half_width(make(core, time=time), 0.5, PIXEL / 2, heights, eye))
        found = half_width(moving, time, PIXEL, heights, eye)
        assert np.abs(found - widths[-1]).max() < 0.1 * PIXEL * eye[0], time
    assert np.ptp(widths, axis=0).max() > 20 * PIXEL * eye[0]


@pytest.mark.parametrize("time", [-1.0, np.nan, np.inf, 2.0])
def test_outside_of_the_shutter_it_has_the_first_or_the_last_form(core, time):
    origins, directions = rays_around(200, 4)
    for name in SHAPES:
        moving = tracer(SHAPES[name](core))
        wanted = moving.closest_hits(origins, directions, times=np.full(200, 1.0 if time > 0 else 0.0, np.float32))
        found = moving.closest_hits(origins, directions, times=np.full(200, time, np.float32))
        np.testing.assert_array_equal(found["t"], wanted["t"])


def scene_of(core, shape, glows=False, **camera):
    """A shape above a bright floor under a bright sky, or a glowing one under a dark sky."""
    scene = core.SceneDescription()
    bright = material(core, scene, ("diffuse", 1.0, 0.9))
    dark = material(core, scene, ("diffuse", 1.0, 0.05))
    if glows:
        dark = scene.add_material_list([scene.add_material("glow", emission(core, strength=5.0))])
    scene.add_instance("floor", quad(scene, "floor", 4.0), matrix((0, 0, -2)), bright)
    scene.add_instance("body", scene.add_shape(shape), matrix(), dark)
    scene.set_world(None if glows else background(core, (0.5, 0.7, 1.0)), 0)
    look_down(scene, height=4.0, half=0.5, **camera)
    return scene


SMALL = dict(size=12, max_bounces=2)


@pytest.mark.slow
@pytest.mark.parametrize("glows", [False, True])
@pytest.mark.parametrize("name", ["cube", "round hair", "NURBS ball", "subdivided cube"])
def test_a_blurred_shape_is_the_mean_of_sub_frames(core, name, glows):
    at = [
        picture(core, scene_of(core, SHAPES[name](core, time=(i + 0.5) / 16), glows), samples=32, seed=i, **SMALL)
        for i in range(16)
    ]
    mean = np.mean(at, 0)
    sharp = picture(core, scene_of(core, SHAPES[name](core, time=0.5), glows), samples=256, **SMALL)
    blurred = picture(core, scene_of(core, SHAPES[name](core), glows), samples=512, **SMALL)
    apart, blur = np.abs(blurred - mean).mean(), np.abs(sharp - mean).mean()
    assert apart < 0.01 * mean.mean() + 0.25 * blur  # few samples, and few sub-frames
    assert abs(blurred.mean() / mean.mean() - 1) < 0.012
    assert blur > 0.02 * mean.mean()


@pytest.mark.parametrize("name", ["cube", "round hair", "NURBS ball", "subdivided cube"])
def test_pictures_of_what_deforms_have_the_same_bits_for_threads_tiles_and_streams(core, name):
    made = scene_of(core, SHAPES[name](core))
    pictures = [
        picture(core, made, size=12, samples=16, **more)
        for more in (dict(threads=1), dict(threads=3, tile_size=5), dict(stream_paths=0), dict(stream_paths=100))
    ]
    for other in pictures[1:]:
        np.testing.assert_array_equal(other, pictures[0])


def test_smooth_normals_turn_with_the_form(core):
    """A mirror that tips while it stays where it is, by its normals alone."""
    flat = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], np.float32)
    triangles = np.array([[0, 1, 2], [0, 2, 3]], np.int32)
    tips = np.array([[0.4, 0, 1], [0, 0, 1], [-0.4, 0, 1]], np.float32)
    normals = np.broadcast_to(tips[:, None, None], (3, 2, 3, 3))

    def scene(index=None):
        made = core.SceneDescription()
        more = dict(moved_vertices=np.stack([flat] * 3), moved_normals=np.array(normals)) if index is None else {}
        card = made.add_mesh(
            "card", flat, triangles, corner_normals=np.array(normals[1 if index is None else index]), **more
        )
        made.add_instance("card", card, matrix(), material(core, made, ("diffuse", 1.0, 0.9)))
        made.add_lamp(
            "sun",
            "SUN",
            matrix((0, 0, 5)) @ np.array([[0.8, 0, 0.6, 0], [0, 1, 0, 0], [-0.6, 0, 0.8, 0], [0, 0, 0, 1.0]]),
            (1, 1, 1),
        )
        look_down(made, height=4.0, half=0.2)
        return made

    one, middle, other = (picture(core, scene(i), size=4, samples=4).mean() for i in range(3))
    blurred = picture(core, scene(), size=4, samples=256).mean()
    assert abs(one - other) > 0.1 * middle
    assert abs(blurred / np.mean([one, middle, middle, other]) - 1) < 0.02  # the cosine is nearly linear between steps


def test_vectors_follow_points_that_deform(core):
    card = np.array([[-0.5, -0.5, 0], [0.5, -0.5, 0], [0.5, 0.5, 0], [-0.5, 0.5, 0]], np.float32)
    steps = np.stack([card + (-0.5, 0, 0), card, card + (1.0, 0.25, 0)]).astype(np.float32)
    scene = core.SceneDescription()
    made = scene.add_mesh("card", card, np.array([[0, 1, 2], [0, 2, 3]], np.int32), moved_vertices=steps)
    scene.add_instance("card", made, matrix())
    scene.set_camera("ORTHOGRAPHIC", matrix((0, 0, 5)), (-1, -1), (1, 1), 0.1, 9.0)
    found = render(core, scene, size=8, samples=4, passes=["combined", "vector"])
    wanted = np.zeros((8, 8, 4))
    wanted[2:6, 2:6] = (-2, 0, -4, -1)  # a pixel is a quarter wide
    np.testing.assert_allclose(found.pass_pixels("vector"), wanted, atol=1e-5)


def test_what_deforms_has_no_ray_cache(core):
    scene = core.SceneDescription()
    mirror = material(core, scene, ("glossy", 1.0, 0.9, 0.0, "SHARP"))
    scene.add_instance("body", scene.add_shape(cube(core)), matrix(), mirror)
    scene.set_world(background(core, (0.5, 0.7, 1.0)), 0)
    look_down(scene)
    session = render(core, scene, size=4, samples=1, ray_interpolation=core.RayInterpolation(mode="ON"))
    (entry,) = session.statistics()["ray_caches"]
    assert "deforms" in str(entry)


@pytest.mark.parametrize(
    "moved",
    [
        np.zeros((1, 8, 3), np.float32),
        np.zeros((2, 7, 3), np.float32),
        np.full((2, 8, 3), np.nan, np.float32),
        np.zeros((8, 3), np.float32),
    ],
)
def test_meshes_that_cannot_deform_so_are_refused_by_name(core, moved):
    with pytest.raises(core.InputError, match="cube.*moved_vertices"):
        mesh(core, shapes.CUBE_VERTICES, moved)


@pytest.mark.parametrize(
    "moved", [np.zeros((1, 240, 4)), np.zeros((2, 239, 4)), np.full((2, 240, 4), np.inf), np.full((2, 240, 4), -1.0)]
)
def test_strands_that_cannot_deform_so_are_refused_by_name(core, moved):
    steps = hair_steps()
    arguments = ("hair", np.ascontiguousarray(steps[1][:, :3]), steps[1][:, 3].astype(np.float32))
    with pytest.raises(core.InputError, match="hair.*(moved_points|points|radii)"):
        core.Strands(*arguments, np.arange(0, 241, 6, dtype=np.int32), moved_points=moved)


@pytest.mark.parametrize("steps", [ball_steps()[:1], ball_steps()[:, :, :6], ball_steps() * [1, 1, 1, 2]])
def test_splines_that_cannot_deform_so_are_refused_by_name(core, steps):
    moved = [[sphere_spline(core, points=np.array(points))] for points in steps]
    with pytest.raises(core.InputError, match="ball.*moved_splines"):
        core.SceneDescription().add_surface("ball", [sphere_spline(core)], moved)


@pytest.mark.parametrize("moved", [np.zeros((1, 8, 3)), np.zeros((2, 7, 3)), np.full((2, 8, 3), np.nan)])
def test_cages_that_cannot_deform_so_are_refused_by_name(core, moved):
    with pytest.raises(core.InputError, match="cage.*(moved_vertices|vertices)"):
        core.SubdivisionSurface(
            "cage",
            shapes.CUBE_VERTICES,
            np.full(6, 4, np.int32),
            np.array(shapes.CUBE_QUADS, np.int32).ravel(),
            moved_vertices=moved.astype(np.float32),
        )


@pytest.mark.parametrize("name", ["NURBS ball", "subdivided cube"])
def test_normals_are_those_of_the_surface_at_its_time(core, name):
    origins, directions = rays_around(500, 6)
    for time in (0.125, 0.4):
        seen = []
        for shape, times in ((SHAPES[name](core, time=time), 0.5), (SHAPES[name](core), time)):
            found = tracer(shape).closest_hits(origins, directions, times=np.full(500, times, np.float32))
            seen.append(found)
        both = (seen[0]["instance"] == 0) & (seen[1]["instance"] == 0)
        assert both.sum() > 50
        turned = np.linalg.norm(seen[0]["normal"][both] - seen[1]["normal"][both], axis=1)
        assert np.quantile(turned, 0.95) < 5e-3
