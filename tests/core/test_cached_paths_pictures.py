"""Pictures with ray interpolation: within the error of those without, and the same bits however they are made."""

import numpy as np
import pytest
from cached_scenes import (
    INTERPOLATED,
    MISSED,
    NOT_ASKED,
    STILL,
    TWO_CLASS,
    ball,
    ball_scene,
    picture,
    render,
    share_of,
    used,
    world,
)
from path_scenes import material
from scenes import CUBE_TRIANGLES, CUBE_VERTICES, background, look_down, matrix, quad, sphere_spline


def test_the_uv_pass_of_interpolated_surfaces_is_that_of_tracing(core):
    def uv(mode):
        session = render(core, ball_scene(core, "simple"), mode, passes=["combined", "uv", "mask"])
        return session.pass_pixels("uv")[..., 1], share_of(session, INTERPOLATED)

    (off, _), (on, share) = uv("OFF"), uv("ON")
    assert share > 0.01
    assert np.median(np.abs(on - off)) < 0.01


# The allowed error at cell centres for an error of 0.005 (quality_settings in core/ri_tree/ray_cache.h).
MOST_AT_CENTRES = 0.05


@pytest.mark.parametrize("kind", ["mirror", "simple"])
def test_an_interpolated_picture_is_that_of_tracing_within_the_error(core, kind):
    off, on = render(core, ball_scene(core, kind), "OFF"), render(core, ball_scene(core, kind))
    assert share_of(on, INTERPOLATED) > 0.1
    difference = np.abs(picture(on) - picture(off))
    # Radiance changes by at most 0.4 a radian of the world's directions; directions are off by 0.02 at most.
    assert difference.mean() < 0.01 * picture(off).mean()
    assert np.median(difference) < 0.002


def test_interpolated_glass_is_the_same_body_as_traced_glass(core):
    # Auto uses the model of On; for an error this small no cache is faster, so its rays are traced.
    traced, on = render(core, ball_scene(core, "glass"), "AUTO", error=1e-6), render(core, ball_scene(core, "glass"))
    assert used(traced) == [] and share_of(on, INTERPOLATED) > 0.1
    assert np.abs(picture(on) - picture(traced)).mean() < 0.01 * picture(traced).mean()


def test_a_glass_body_in_even_light_disappears_as_energy_is_kept(core):
    scene = core.SceneDescription()
    shape = scene.add_surface("ball", [sphere_spline(core)])
    scene.add_instance("ball", shape, matrix(), material(core, scene, ("glass", 1.0, 1.0, 0.0, 1.45, "SHARP")))
    program = core.Program("world")
    ones = [program.constant(1, 1, 1, 1) for _ in range(3)]
    program.operation("background", ones)
    scene.set_world(program, 0)
    look_down(scene, 6.0, 0.3)
    for mode in ("ON", "AUTO"):
        assert np.allclose(picture(render(core, scene, mode, roulette_start=100)), 1.0, atol=2e-3), mode


@pytest.mark.parametrize("kind", ["mirror", "glass", "simple"])
def test_threads_cache_size_and_kept_caches_change_no_bit(core, kind):
    reference = picture(render(core, ball_scene(core, kind), threads=1))
    store = core.RayCacheStore()
    for settings in (dict(threads=4), dict(cache_bytes=200_000), dict(tile_size=8), dict(caches=store)):
        assert np.array_equal(picture(render(core, ball_scene(core, kind), **settings)), reference), settings
    again = render(core, ball_scene(core, kind), caches=store)
    assert np.array_equal(picture(again), reference)
    assert used(again)[0]["samples_taken"] == 0


def test_frames_of_a_kept_cache_show_the_same_for_any_threads_and_differ_by_little(core):
    def frames(**settings):
        store, shown = core.RayCacheStore(), []
        for _ in range(4):
            shown.append(picture(render(core, ball_scene(core, "glass"), caches=store, **settings)))
            store.next_frame()
        return shown

    one, many = frames(threads=1), frames(threads=4, tile_size=8)
    for i, (a, b) in enumerate(zip(one, many)):
        assert np.array_equal(a, b), i
    # Later frames interpolate more, within the error of the setting.
    assert np.abs(one[-1] - one[0]).mean() < 0.005


def test_a_store_forgets_what_the_last_frame_did_not_use(core):
    store = core.RayCacheStore()
    render(core, ball_scene(core, "mirror"), caches=store)
    assert store.count() == 1 and store.bytes() > 0
    store.next_frame()
    render(core, ball_scene(core, "glass"), caches=store)
    assert store.count() == 2
    store.next_frame()
    assert store.count() == 1


@pytest.mark.slow
def test_an_object_that_changes_shape_every_frame_holds_one_cache(core):
    def scene(radius):
        made = core.SceneDescription()
        spline = sphere_spline(core, radius=radius)
        shape = made.add_surface("ball", [spline])
        made.add_instance("ball", shape, matrix(), material(core, made, ("glossy", 1.0, 0.9, 0.0, "SHARP")))
        made.set_world(world(core), 32)
        look_down(made, 6.0, 0.3)
        return made

    store, most = core.RayCacheStore(), 300_000
    for frame in range(5):
        kept = render(core, scene(1.0 - 0.05 * frame), caches=store, cache_bytes=most)
        assert store.count() == 1 and store.bytes() <= most
        alone = render(core, scene(1.0 - 0.05 * frame), cache_bytes=most)
        assert np.array_equal(picture(kept), picture(alone)), frame
        assert used(kept)[0]["bytes"] <= most and used(kept)[0]["tracer_bytes"] > 0
        store.next_frame()


def test_a_shape_that_another_object_still_has_keeps_its_cache(core):
    def scene(first, second):
        made = core.SceneDescription()
        glossy = material(core, made, ("glossy", 1.0, 0.9, 0.0, "SHARP"))
        for name, place, radius in (("first", -0.6, first), ("second", 0.6, second)):
            shape = made.add_surface(name, [sphere_spline(core, radius=radius)])
            made.add_instance(name, shape, matrix((place, 0, 0)), glossy)
        made.set_world(world(core), 32)
        look_down(made, 6.0, 0.3)
        return made

    store, taken = core.RayCacheStore(), []
    for radii in ((0.5, 0.5), (0.4, 0.5)):
        shown = used(render(core, scene(*radii), caches=store))
        taken.append({name: each["samples_taken"] for each in shown for name in each["objects"]})
        held = store.count()
        store.next_frame()
    # Made for the first frame, used by the second. A kept cache takes a few more samples; a new one takes all of them.
    assert held == 2 and taken[0]["second"] > 0
    assert taken[1]["second"] < 0.4 * taken[0]["second"] and taken[1]["first"] > 0


def test_what_lies_inside_glass_is_not_skipped(core):
    def scene():
        made = ball_scene(core, "glass", floor=False)
        red = material(core, made, ("diffuse", 1.0, (1.0, 0.05, 0.05)), name="red")
        cube = made.add_mesh("cube", CUBE_VERTICES, CUBE_TRIANGLES)
        made.add_instance("cube", cube, matrix((0, 0, 0), 0.3), red)
        return made

    off, on = picture(render(core, scene(), "OFF")), picture(render(core, scene()))
    middle = np.s_[2:6, 0:16]
    assert off[middle][..., 0].mean() > 2 * off[middle][..., 1].mean()
    assert np.allclose(on[middle].mean(axis=(0, 1)), off[middle].mean(axis=(0, 1)), rtol=0.1)


def test_a_body_that_stands_on_a_table_is_still_skipped(core):
    def scene(height):
        made = ball_scene(core, "glass", floor=False)
        ground = material(core, made, ("diffuse", 1.0, 0.5), name="ground")
        made.add_instance("floor", quad(made, "floor", 6.0, height), matrix(), ground)
        return made

    # A difference between the models shows whether the inside is skipped: partial reflections.
    apart = [
        np.abs(picture(render(core, scene(h))) - picture(render(core, scene(h), "OFF"))).mean() for h in (-1.0, -0.5)
    ]
    assert apart[0] > 0.003 > apart[1]


def test_shadows_of_an_interpolated_object_fall_where_they_did(core):
    def scene():
        made = ball_scene(core, "simple")
        made.set_world(None)
        made.add_lamp("key", "POINT", matrix((-2, 0, 4)), (200, 200, 200))
        return made

    off, on = render(core, scene(), "OFF"), render(core, scene())
    assert (picture(off) < 0.2).all(axis=-1).mean() > 0.01, "no shadow to compare"
    apart = np.abs(picture(on) - picture(off)).max(axis=-1)
    assert (apart > 0.1).mean() < 0.02


@pytest.mark.parametrize("error", [0.02, 0.005, 0.001])
def test_rays_that_enter_glass_at_an_interpolated_point_start_neither_behind_facets_nor_far_away(core, error):
    """A body that the floor intersects: its inside is traced, from where the cache says that rays enter."""
    made = ball_scene(core, "glass", floor=False)
    ground = material(core, made, ("diffuse", 1.0, 0.5), name="ground")
    made.add_instance("floor", quad(made, "floor", 6.0, -0.5), matrix(), ground)
    off, on = render(core, made, "OFF"), render(core, made, error=error)
    assert share_of(on, INTERPOLATED) > 0.1
    assert np.abs(picture(on) - picture(off)).mean() <= error


def test_what_lies_right_behind_an_interpolated_film_is_seen_where_it_is(core):
    """A clear ball around a cube whose corners nearly touch it: rays go on behind the film, on their lines."""
    made = core.SceneDescription()
    clear = material(core, made, ("transparent", 1.0, (0.7, 0.9, 1.0)), name="clear")
    made.add_instance("ball", made.add_surface("ball", [sphere_spline(core)]), matrix(), clear)
    red = material(core, made, ("diffuse", 1.0, (1.0, 0.05, 0.05)), name="red")
    cube = made.add_mesh("cube", CUBE_VERTICES, CUBE_TRIANGLES)
    made.add_instance("cube", cube, matrix((0, 0, 0.3), 0.45), red)
    made.set_world(world(core), 32)
    look_down(made, 6.0, 0.3)
    off = picture(render(core, made, "OFF"))
    on = render(core, made, error=0.02)
    assert share_of(on, INTERPOLATED) > 0.2
    # The film is only transparent: the same rays meet the same objects.
    assert (np.abs(picture(on) - off).max(axis=-1) > 0.01).mean() < 0.001


def test_no_interpolated_surface_shadows_or_mirrors_itself(core):
    scene = ball_scene(core, "simple", floor=False)
    on = picture(render(core, scene, samples=16, error=0.02))
    off = picture(render(core, scene, "OFF", samples=16))
    lit = off.min(axis=-1) > 0.05
    # A ray caught by its own surface would leave a black pixel in lit surroundings.
    assert (on[lit] > 0.5 * off[lit]).all()


def test_the_mask_and_the_error_say_how_each_pixel_was_answered(core):
    on = render(core, ball_scene(core, "mirror"), passes=["combined", "mask", "mask_colors", "interpolation_error"])
    mask, colors, error = (on.pass_pixels(name) for name in ("mask", "mask_colors", "interpolation_error"))
    assert set(np.unique(mask)) <= {0, 1, 2, 3, 4}
    on_ball = (4, 70)  # off the middle, where the sphere has its pole
    assert mask[on_ball] == INTERPOLATED and mask[4, 170] in (NOT_ASKED, MISSED)
    assert colors[on_ball][2] > colors[on_ball][0], "blue shows what is interpolated"
    inside = share_of(on, INTERPOLATED, TWO_CLASS)
    assert 0.1 < inside < 0.9
    assert (error[mask == INTERPOLATED] <= MOST_AT_CENTRES).all() and (error[(mask == NOT_ASKED)] == 0).all()


def test_textures_seen_by_way_of_an_interpolated_mirror_are_as_sharp_as_traced(core):
    def scene():
        made = core.SceneDescription()
        ball(core, made, "ball", "mirror")
        stripes = np.zeros((64, 64, 3), np.float32)
        stripes[:, ::2] = 1.0
        image = made.add_image_pixels("stripes", stripes, "LINEAR")
        program = core.Program("floor")
        one = program.constant(1, 1, 1, 1)
        place = program.operation("generated")
        scaled = program.operation("vector_math", [place, program.constant(0.3, 0.3, 0.3, 0)], text="MULTIPLY")
        color = program.operation("image", [scaled], [image, 0, 0])
        program.operation("diffuse", [one, color])
        floor = made.add_material_list([made.add_material("floor", program)])
        made.add_instance("floor", quad(made, "floor", 20.0, -1.2), matrix(), floor)
        program = core.Program("world")
        program.operation("background", [program.constant(1, 1, 1, 1) for _ in range(3)])
        made.set_world(program, 0)
        made.set_camera("PERSPECTIVE", tilted(), (-0.2, -0.2), (0.2, 0.2), 0.01, 100.0)
        return made

    off, on = picture(render(core, scene(), "OFF", samples=16)), picture(render(core, scene(), samples=16))
    assert abs(on.std() - off.std()) < 0.1 * off.std()


def test_textures_on_an_interpolated_surface_are_where_and_as_sharp_as_traced(core):
    """Fine stripes by the surface's own coordinate: a footprint that is none would alias, one too wide would blur."""

    def scene(lines):
        made = core.SceneDescription()
        stripes = np.zeros((8, lines, 3), np.float32)
        stripes[:, ::2] = (1.0, 0.6, 0.2)
        image = made.add_image_pixels("stripes", stripes, "LINEAR")
        program = core.Program("striped")
        one = program.constant(1, 1, 1, 1)
        color = program.operation("image", [program.operation("uv", ints=[-1])], [image, 0, 0])
        program.operation("diffuse", [one, color])
        striped = made.add_material_list([made.add_material("striped", program)])
        made.add_instance("ball", made.add_surface("ball", [sphere_spline(core)]), matrix(), striped)
        made.set_world(background(core, strength=1.0))
        look_down(made, 6.0, 0.3)
        return made

    # 32 stripes around the ball are some twenty pixels wide, 2048 a third of one.
    for lines, aliased in ((32, False), (2048, True)):
        off, on = (render(core, scene(lines), mode, samples=16) for mode in ("OFF", "ON"))
        assert used(on)[0]["kind"] == "simple" and share_of(on, INTERPOLATED) > 0.1
        assert used(on)[0]["interpolated"] > 0.5 * (used(on)[0]["queries"] - used(on)[0]["missed"])
        apart = np.abs(picture(on) - picture(off))
        # Traced, a hit lies on a facet, a tenth of a pixel beside the surface: not little, where a stripe is a third.
        assert apart.mean() < (0.01 if aliased else 0.005), (lines, apart.mean())
        if aliased:
            assert abs(picture(on).std() - picture(off).std()) < 0.1 * picture(off).std()


def tilted():
    """A camera that looks at the origin from the side, a little from below."""
    m = np.eye(4)
    angle = np.radians(80)
    m[1:3, 1:3] = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
    m[:3, 3] = 7 * m[:3, 2]
    return m


def test_glass_followed_past_the_cells_is_the_same_as_traced_glass(core):
    # Wide spacing: too few rays cross any cell.
    settings = dict(STILL, width=65, height=65, crop_x=0, crop_y=0, crop_width=65, crop_height=65)
    traced = render(core, ball_scene(core, "glass"), "AUTO", **settings)
    on = render(core, ball_scene(core, "glass"), **settings)
    mask = on.pass_pixels("mask").reshape(65, 65)
    followed = mask == TWO_CLASS
    statistics = used(on)[0]
    assert used(traced) == [] and followed.mean() > 0.05, np.unique(mask, return_counts=True)
    assert statistics["followed"] == statistics["answers"]["followed"] >= followed.sum()
    difference = np.abs(picture(on) - picture(traced)).max(axis=-1)[followed]
    # The facets of so small a picture are coarse: a tenth of a pixel off. A few rays pass an edge of the floor.
    assert np.median(difference) < 1e-5 and (difference > 1e-2).mean() < 0.03, np.quantile(difference, [0.5, 0.9, 1])


def crowded_ball(core, count):
    """A ball of glass, and so many triangles far away that no ray sees."""
    made = ball_scene(core, "glass")
    shape = made.add_mesh("bit", np.eye(3, dtype=np.float32) * 1e-3, np.array([[0, 1, 2]], np.int32))
    place = np.random.default_rng(1).uniform(20, 30, (count, 3)).astype(float)
    matrices = np.tile(np.eye(4), (count, 1, 1))
    matrices[:, :3, 3] = place
    none, zeros = np.full(count, -1, np.int32), np.zeros(count, np.int32)
    names = [f"bit {i}" for i in range(count)]
    assert not made.add_instances(names, zeros + shape, matrices, none, zeros, zeros.astype(np.float32), zeros)
    return made


def test_the_model_of_glass_does_not_depend_on_how_many_objects_there_are(core):
    few, many = (render(core, crowded_ball(core, count), **STILL) for count in (10, 10_001))
    np.testing.assert_array_equal(picture(few), picture(many))
