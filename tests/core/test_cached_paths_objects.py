"""Which objects get a ray cache, of which kind, and the reasons given for others."""

import re

import numpy as np
import pytest
from cached_scenes import ball, ball_scene, picture, render, used, world
from path_scenes import material
from scenes import CUBE_TRIANGLES, CUBE_VERTICES, emission, look_down, matrix, sphere_spline


# A picture large enough for a probe.
# A picture large enough for a probe, a part of it that is rendered, and a part of that.
LARGE = dict(width=1024, height=1024, samples=4, crop_x=480, crop_y=480, crop_width=96, crop_height=96)
NOTHING_RESIDENT = dict(resident_megabytes=0.0)  # rays to facets in the geometry cache cost more than interpolated ones
DICED = LARGE | NOTHING_RESIDENT
PART = dict(crop_x=512, crop_y=496, crop_width=40, crop_height=40)


def reports(session):
    return {name: each for each in session.statistics()["ray_caches"] for name in each["objects"]}


def all_kinds(core, **more):
    scene = core.SceneDescription()
    for i, kind in enumerate(("mirror", "glass", "simple")):
        ball(core, scene, kind, kind, (2.2 * i - 3.3, 0, 0), **more)
    fog = scene.add_material("fog", None, volume=core.VolumeVisualisation())
    shape = scene.add_surface("fog", [sphere_spline(core)])
    scene.add_instance("fog", shape, matrix((3.3, 0, 0)), scene.add_material_list([fog]), **more)
    scene.set_world(world(core), 32)
    look_down(scene, 8.0, 0.6)
    return scene


def test_each_kind_of_material_gets_its_kind_of_cache(core):
    found = reports(render(core, all_kinds(core), crop_x=0, crop_width=513))
    assert {name: each["kind"] for name, each in found.items()} == {
        "mirror": "mirror",
        "glass": "glass",
        "simple": "mirror",  # point and normal are all that is needed
        "fog": "volume",
    }
    for each in found.values():
        assert each["used"] and each["samples_taken"] > 0 and each["bytes"] > 0
        assert each["answers"]["interpolated"] > 0


@pytest.mark.parametrize("thickness, kind", ((0.0, "glass"), (300.0, "mirror")))
def test_glass_under_a_film_is_interpolated_up_to_its_first_hit(core, thickness, kind):
    program = core.Program("film")
    numbers = [program.constant(x, x, x, 1) for x in (1.0, 1.0, 0.0, 1.45, thickness, 1.33)]
    program.operation("glass", [*numbers[:4], -1, *numbers[4:]], text="SHARP")
    scene = core.SceneDescription()
    shape = scene.add_surface("ball", [sphere_spline(core)])
    scene.add_instance("ball", shape, matrix(), scene.add_material_list([scene.add_material("film", program)]))
    scene.set_world(world(core), 32)
    look_down(scene, 6.0, 0.3)
    assert reports(render(core, scene))["ball"]["kind"] == kind


def test_texture_coordinates_are_stored_where_a_pass_shows_them(core):
    session = render(core, all_kinds(core), passes=["combined", "uv"])
    assert {each["kind"] for each in used(session)} == {"simple", "volume"}


def test_nothing_is_allocated_when_off(core):
    session = render(core, all_kinds(core), "OFF")
    assert session.statistics()["ray_caches"] == []
    assert "ray caches" in session.statistics()["left_out"]
    assert (session.pass_pixels("mask") == 0).all()


@pytest.mark.parametrize(("name", "obstacle"), [("flat", "flat"), ("glow", "emits"), ("painted", "attributes")])
def test_objects_that_cannot_have_a_cache_are_told_with_the_reason(core, name, obstacle):
    scene = ball_scene(core, "mirror", floor=False)
    if name == "flat":
        scene.add_instance(name, scene.add_mesh(name, CUBE_VERTICES, CUBE_TRIANGLES), matrix((3, 0, 0)))
    else:
        program = emission(core) if name == "glow" else core.Program(name)
        if name == "painted":
            program.operation("diffuse", [program.constant(1, 1, 1, 1), program.operation("attribute", ints=[0])])
        materials = scene.add_material_list([scene.add_material(name, program)])
        scene.add_instance(name, scene.add_surface(name, [sphere_spline(core)]), matrix((3, 0, 0)), materials)
    found = reports(render(core, scene))
    assert not found[name]["used"] and obstacle in found[name]["reason"]
    assert found["ball"]["used"]


def test_instances_of_a_shape_share_a_cache_unless_their_materials_differ(core):
    scene = core.SceneDescription()
    shape = scene.add_surface("ball", [sphere_spline(core)])
    mirror = material(core, scene, ("glossy", 1.0, 0.9, 0.0, "SHARP"), name="mirror")
    clear = material(core, scene, ("glass", 1.0, 1.0, 0.0, 1.3, "SHARP"), name="clear")
    dense = material(core, scene, ("glass", 1.0, 1.0, 0.0, 2.0, "SHARP"), name="dense")
    for i, materials in enumerate((mirror, mirror, clear, dense)):
        scene.add_instance(f"ball {i}", shape, matrix((2.2 * i - 3.3, 0, 0)), materials)
    scene.set_world(world(core), 32)
    look_down(scene, 8.0, 0.6)
    caches = used(render(core, scene))
    assert sorted((each["kind"], each["instances"]) for each in caches) == [("glass", 1), ("glass", 1), ("mirror", 2)]


def test_an_object_may_have_settings_of_its_own(core):
    scene = core.SceneDescription()
    own = scene.add_ray_interpolation("ball", core.RayInterpolation(mode="ON", error=0.02))
    off = scene.add_ray_interpolation("other", core.RayInterpolation(mode="OFF"))
    ball(core, scene, "ball", "mirror", ray_interpolation=own)
    ball(core, scene, "other", "mirror", (2.5, 0, 0), ray_interpolation=off)
    ball(core, scene, "third", "mirror", (-2.5, 0, 0))
    scene.set_world(world(core), 32)
    look_down(scene, 8.0, 0.45)
    assert [each["objects"] for each in used(render(core, scene, "OFF"))] == [["ball"]]
    assert sorted(each["objects"][0] for each in used(render(core, scene, "ON"))) == ["ball", "third"]


def test_auto_says_what_it_decided_and_why(core):
    whole = dict(crop_x=0, crop_y=0, crop_width=0, crop_height=0)
    resident = render(core, ball_scene(core, "mirror"), "AUTO", **LARGE)
    assert "traced faster than interpolated" in reports(resident)["ball"]["reason"]
    small = render(core, ball_scene(core, "mirror"), "AUTO", **{**DICED, **whole, "width": 64, "height": 64})
    assert "too few rays" in reports(small)["ball"]["reason"] and not reports(small)["ball"]["used"]
    large = [render(core, ball_scene(core, "mirror"), "AUTO", **DICED) for _ in range(2)]
    reasons = [reports(session)["ball"]["reason"] for session in large]
    assert reasons[0] == reasons[1] and "queries" in reasons[0] and "of tracing" in reasons[0]


@pytest.mark.slow
def test_auto_foretells_from_a_few_blocks_what_a_whole_picture_samples(core):
    whole = dict(crop_x=0, crop_y=0, crop_width=0, crop_height=0, samples=8)
    on, auto = (
        reports(render(core, ball_scene(core, "mirror"), mode, **whole, **NOTHING_RESIDENT))["ball"]
        for mode in ("ON", "AUTO")
    )
    answers = on["answers"]
    queries = sum(count for name, count in answers.items() if name not in ("not a ray", "box missed"))
    told = float(re.search(r"([\d.]+) samples a query", auto["reason"]).group(1))
    # A block shares far fewer samples than its whole picture, so it takes many more of them per query.
    assert 1 / 3 < told / (on["samples_taken"] / queries) < 3


def test_auto_knows_that_glass_with_something_inside_is_answered_with_first_hits_alone(core):
    def told(occupied):
        scene = ball_scene(core, "glass", floor=False)
        if occupied:
            red = material(core, scene, ("diffuse", 1.0, (1.0, 0.05, 0.05)), name="red")
            cube = scene.add_mesh("cube", CUBE_VERTICES, CUBE_TRIANGLES)
            scene.add_instance("cube", cube, matrix((0, 0, 0), 0.02), red)
        return reports(render(core, scene, "AUTO", **DICED))["ball"]["reason"]

    # Interpolated, a path goes on where it leaves the glass, and that costs as much as is saved; a first hit is less.
    assert "queries" in told(True)
    assert "traced faster than interpolated" in told(False)


def test_auto_decides_alike_whatever_a_store_holds_and_whatever_part_is_rendered(core):
    store = core.RayCacheStore()
    render(core, ball_scene(core, "mirror"), "ON", caches=store)
    whole = render(core, ball_scene(core, "mirror"), "AUTO", caches=store, **DICED)
    part = render(core, ball_scene(core, "mirror"), "AUTO", **{**DICED, **PART})
    assert reports(whole)["ball"]["reason"] == reports(part)["ball"]["reason"]
    assert "queries" in reports(whole)["ball"]["reason"]
    assert np.array_equal(picture(part)[496:536, 512:552], picture(whole)[496:536, 512:552])


@pytest.mark.parametrize(
    "settings", [dict(error=0.0), dict(error=float("nan")), dict(mode="MAYBE"), dict(depth_limit=61)]
)
def test_settings_without_meaning_are_rejected_by_name(core, settings):
    with pytest.raises(core.InputError, match=next(iter(settings))):
        core.RayInterpolation(**settings)


def extreme_picture(core, kind, mode="ON", **settings):
    """A tiny picture in which every cell is sampled, however few rays cross it."""
    interpolation = core.RayInterpolation(mode=mode, **{"depth_limit": 24, "rays_per_cell": 0.0, **settings})
    values = core.Settings(width=8, height=8, samples=2, threads=1, ray_interpolation=interpolation)
    session = core.Session(ball_scene(core, kind), values)
    assert session.render()
    return picture(session), session.statistics()["ray_caches"][0]


@pytest.mark.parametrize("kind", ["mirror", "glass"])
def test_pictures_at_the_ends_of_every_threshold_are_right(core, kind):
    # On Auto a picture this small is traced, by the same model of glass.
    traced, nothing = extreme_picture(core, kind, "AUTO")
    assert not nothing["used"]
    usual, cache = extreme_picture(core, kind)
    assert cache["interpolated"] > 20, cache["answers"]
    exact, cache = extreme_picture(core, kind, depth_limit=0)
    assert np.array_equal(exact, traced) and cache["interpolated"] == 0, "at depth 0 everything is traced"
    exact, cache = extreme_picture(core, kind, distance_threshold=0.0)
    assert np.array_equal(exact, traced) and cache["interpolated"] == 0, "no interpolated ray is without error"
    for size in (0, 20_000):
        again, cache = extreme_picture(core, kind, cache_bytes=size)
        assert np.array_equal(again, usual) and cache["bytes"] <= size, "the cache's size shows"
    wild, cache = extreme_picture(core, kind, distance_threshold=float("inf"), angle_threshold=float("inf"))
    # Any direction is possible, but none that sees objects that do not exist.
    assert cache["interpolated"] > 20 and np.isfinite(wild).all()
    assert wild.min() >= 0.9 * traced.min() and wild.max() <= 1.1 * traced.max()


def test_finer_settings_ask_more_of_every_threshold(core):
    coarse, fine = core.RayInterpolation(error=0.02), core.RayInterpolation(error=0.001)
    assert fine.distance_threshold < coarse.distance_threshold
    assert fine.angle_threshold < coarse.angle_threshold
    assert fine.depth_limit > coarse.depth_limit
