"""Light linking: on which objects lights shine, and which objects cast their shadows."""

import cached_scenes
import numpy as np
import path_scenes
import pytest
import scenes
from light_support import random_numbers, sphere_directions
from test_lights_sampling import irradiance

ANY, ALL_BLOCK = (1 << 63) - 1, (1 << 24) - 1
UNLINKED = (-1, -1)


def linking(lit_by=ANY, blocks=ALL_BLOCK, link=UNLINKED):
    return (lit_by, blocks, *link)


def many_lights(core, shines=lambda name: True, world=True, links=None):
    """Lights of every kind; those with a name in `links` shine on one set alone."""
    scene, links = core.SceneDescription(), links or {}
    scenes.look_down(scene)

    def lamp(name, kind, place, strength, **more):
        if shines(name):
            scene.add_lamp(name, kind, scenes.matrix(place), (strength,) * 3, link=links.get(name, UNLINKED), **more)

    lamp("point", "POINT", (1, 1, 1), 50, radius=0.3)
    lamp("spot", "SPOT", (-1, 0, 2), 80, radius=0.2, spot_size=2.0)
    lamp("area", "RECTANGLE", (0, 1, 2), 60, size_x=1.5)
    lamp("sun", "SUN", (0, 0, 0), 3, angle=0.4)
    lamp("other sun", "SUN", (0, 0, 0), 2, angle=0.9)
    glow = scene.add_material_list([scene.add_material("glow", scenes.emission(core, strength=7.0))])
    for i in range(5):
        name = f"plate {i}"
        if shines(name):
            link = linking(link=links.get(name, UNLINKED))
            place = scenes.matrix((i - 2, -0.5, 1 + 0.3 * i), 0.4)
            scene.add_instance(name, scenes.quad(scene, name), place, glow, linking=link)
    if world:
        scene.set_world(path_scenes.uneven_world(core), sampling_resolution=64)
    return scene


LINKS = {"point": (0, -1), "area": (1, -1), "sun": (1, -1), "plate 1": (2, -1), "plate 3": (0, 4), "other sun": (2, -1)}


def lights_of(lit_by):
    return lambda name: LINKS.get(name, UNLINKED)[0] < 0 or lit_by >> LINKS[name][0] & 1


@pytest.mark.parametrize("lit_by", [0, 1, 2, 3, 4, 6, ANY])
@pytest.mark.parametrize("world", [True, False])
def test_a_point_is_lit_as_if_there_were_only_the_lights_of_its_sets(core, lit_by, world):
    position = np.array([0.1, 0.2, -0.5])
    linked = core.LightProbe(many_lights(core, links=LINKS, world=world))
    alone = core.LightProbe(many_lights(core, lights_of(lit_by), world=world))
    numbers = random_numbers(60_000)
    mean, error = irradiance(linked.sample(position, numbers, lit_by))
    wanted, of_wanted = irradiance(alone.sample(position, numbers))
    assert mean == pytest.approx(wanted, abs=4 * (error + of_wanted) + 1e-3 * wanted)
    directions = sphere_directions(20_000)
    np.testing.assert_allclose(
        linked.look(position, directions, lit_by)[0].sum(), alone.look(position, directions)[0].sum(), rtol=0.2
    )


@pytest.mark.parametrize("lit_by", [0, 1, 5, ANY])
def test_sampling_and_looking_agree_on_the_density_of_linked_lights(core, lit_by):
    position = np.array([0.1, 0.2, -0.5])
    probe = core.LightProbe(many_lights(core, links=LINKS))
    samples = probe.sample(position, random_numbers(4000), lit_by)
    used = samples["density"] > 0
    _, density = probe.look(position, samples["direction"][used].astype(np.float64), lit_by)
    # Where lights overlap, `look` adds up what each could have sampled; but plates hide what is behind them.
    assert (density >= samples["density"][used] * 0.999).mean() > 0.9


def test_probabilities_of_linked_lights_add_up_to_one(core):
    position = np.array([0.1, 0.2, -0.5])
    for lit_by in (0, 1, 2, 5, ANY):
        probe = core.LightProbe(
            many_lights(core, links={name: link for name, link in LINKS.items() if "plate" not in name})
        )
        used = probe.sample(position, random_numbers(20_000), lit_by)["density"] > 0
        _, everywhere = probe.look(position, sphere_directions(200_000), lit_by)
        assert everywhere.mean() * 4 * np.pi == pytest.approx(used.mean(), abs=0.1), lit_by


def two_floors(core, closure=("diffuse", 1.0, 0.5), lamp=None, **more):
    """Two halves of a floor; the left is in the first set of receivers."""
    scene = core.SceneDescription()
    grey = path_scenes.material(core, scene, closure)
    for name, x, lit_by in (("left", -1, 1), ("right", 1, 0)):
        place = scenes.matrix((x, 0, 0))
        scene.add_instance(name, scenes.quad(scene, name, 1.0), place, grey, linking=linking(lit_by))
    if lamp is not None:
        scene.add_lamp("lamp", scenes_kind(lamp), scenes.matrix((0, 0, 2)), (50,) * 3, link=(0, -1), **lamp_size(lamp))
    scenes.look_down(scene, half=0.15)
    return scene


def scenes_kind(lamp):
    return {"point": "POINT", "ball": "POINT", "area": "RECTANGLE", "sun": "SUN"}[lamp]


def lamp_size(lamp):
    unseen = {"visibility": 62}  # by the camera
    return unseen | {"point": {}, "ball": {"radius": 0.5}, "area": {"size_x": 2.0}, "sun": {"angle": 0.3}}[lamp]


def halves(pixels):
    middle = pixels.shape[1] // 2
    return pixels[:, :middle], pixels[:, middle:]


@pytest.mark.parametrize("integrator", ["PATH", "DISTRIBUTION"])
@pytest.mark.parametrize(
    "closure", [("diffuse", 1.0, 0.5), ("glossy", 1.0, 0.9, 0.3, "GGX")], ids=["diffuse", "glossy"]
)
@pytest.mark.parametrize("lamp", ["point", "ball", "area", "sun"])
def test_a_lamp_lights_what_it_is_linked_to_and_nothing_else(core, lamp, closure, integrator):
    settings = dict(samples=256, integrator=integrator)
    found = path_scenes.picture(core, two_floors(core, closure, lamp), **settings)
    left, right = halves(found)
    assert (right == 0).all()
    scene = two_floors(core, closure)
    scene.add_lamp("lamp", scenes_kind(lamp), scenes.matrix((0, 0, 2)), (50,) * 3, **lamp_size(lamp))
    wanted = halves(path_scenes.picture(core, scene, **settings))[0]
    assert left.mean() > 0.01
    assert left.mean() == pytest.approx(wanted.mean(), rel=0.01)


@pytest.mark.parametrize("roughness, sampled", [(0.0, False), (0.2, True)])
@pytest.mark.parametrize("integrator", ["PATH", "DISTRIBUTION"])
def test_surfaces_that_emit_are_mirrored_by_what_they_are_linked_to(core, roughness, sampled, integrator):
    def scene_of(link):
        scene = two_floors(core, ("glossy", 1.0, 0.9, roughness, "GGX"))
        glow = scene.add_material_list([scene.add_material("glow", scenes.emission(core, strength=7.0))])
        place = scenes.matrix((0, 0, 3), 2.0)
        scene.add_instance("lamp", scenes.quad(scene, "lamp"), place, glow, visibility=62, linking=linking(link=link))
        return path_scenes.picture(core, scene, samples=64, integrator=integrator)

    left, right = halves(scene_of((0, -1)))
    wanted, _ = halves(scene_of(UNLINKED))
    assert (right == 0).all() and wanted.min() > 1
    np.testing.assert_allclose(left, wanted, rtol=1e-6 if not sampled else 0.1)


def under_a_plate(core, lamp, closure=("diffuse", 1.0, 0.5), blocks=1, has_plate=True, plate=("diffuse", 1.0, 0.5)):
    """A floor under a lamp with a plate in between, which only blocks the lamp's light if it is in set 0."""
    scene = core.SceneDescription()
    grey = path_scenes.material(core, scene, closure)
    scene.add_instance("floor", scenes.quad(scene, "floor", 4.0), scenes.matrix(), grey)
    if has_plate:
        unseen = 63 & ~(1 | 2 | 4)  # by shadow rays alone, and light that goes on
        other = path_scenes.material(core, scene, plate, name="plate")
        where = scenes.matrix((0, 0, 1))
        link = linking(blocks=blocks)
        scene.add_instance("plate", scenes.quad(scene, "plate"), where, other, visibility=unseen, linking=link)
    if lamp == "emitter":
        glow = scene.add_material_list([scene.add_material("glow", scenes.emission(core, strength=7.0))])
        link = linking(link=(-1, 0))
        scene.add_instance("lamp", scenes.quad(scene, "l"), scenes.matrix((0, 0, 2)), glow, visibility=62, linking=link)
    else:
        where = scenes.matrix((0, 0, 2))
        scene.add_lamp("lamp", scenes_kind(lamp), where, (50,) * 3, link=(-1, 0), **lamp_size(lamp))
    scenes.look_down(scene, half=0.15)
    return scene


@pytest.mark.parametrize("integrator", ["PATH", "DISTRIBUTION"])
@pytest.mark.parametrize("roughness", [None, 0.0, 0.1, 0.4])
@pytest.mark.parametrize("lamp", ["point", "ball", "area", "sun", "emitter"])
def test_what_does_not_block_a_light_casts_no_shadow_in_it(core, lamp, roughness, integrator):
    closure = ("diffuse", 1.0, 0.5) if roughness is None else ("glossy", 1.0, 0.9, roughness, "GGX")
    settings = dict(samples=64, integrator=integrator)
    blocked = path_scenes.picture(core, under_a_plate(core, lamp, closure), **settings)
    free = path_scenes.picture(core, under_a_plate(core, lamp, closure, blocks=0), **settings)
    wanted = path_scenes.picture(core, under_a_plate(core, lamp, closure, has_plate=False), **settings)
    assert blocked.mean() < 0.9 * wanted.mean() or wanted.max() == 0
    np.testing.assert_array_equal(free, wanted)


def test_a_light_without_links_has_the_shadows_of_all(core):
    scene = under_a_plate(core, "point", blocks=0)
    scene.clear_lamps()
    scene.add_lamp("lamp", "POINT", scenes.matrix((0, 0, 2)), (50,) * 3)
    assert path_scenes.picture(core, scene).min() == 0


def test_links_beside_others_do_not_touch_them(core):
    """Rays to a light with blockers are of another kind: transparent shadows stay what they are."""
    veil = ("transparent", 1.0, 0.25)
    clear = path_scenes.picture(core, under_a_plate(core, "point", blocks=1, plate=veil), samples=4)
    free = path_scenes.picture(core, under_a_plate(core, "point", blocks=0, plate=veil), samples=4)
    np.testing.assert_allclose(clear[4, 4], 0.25 * free[4, 4], rtol=1e-4)


def linked_scene(core):
    """Links of all kinds among many kinds of closures."""
    scene = path_scenes.varied_scene(core)
    scene.add_lamp("linked", "POINT", scenes.matrix((1, 0, 2)), (30,) * 3, radius=0.3, link=(0, 1))
    scene.add_lamp("sun", "SUN", scenes.matrix(), (1,) * 3, angle=0.4, link=(-1, 0))
    glow = scene.add_material_list([scene.add_material("glow", scenes.emission(core, strength=4.0))])
    glass = path_scenes.material(core, scene, ("glass", 1.0, 0.9, 0.2, 1.4, "GGX"), name="more glass")
    rows = {"one": (glow, linking(link=(1, 2))), "two": (glass, linking(1, 5)), "three": (glass, linking(2, 6))}
    for number, (name, (material, link)) in enumerate(rows.items()):
        place = scenes.matrix((number - 1, -0.5, 0.6 + 0.3 * number), 0.3)
        scene.add_instance(name, scenes.quad(scene, name), place, material, linking=link)
    return scene


@pytest.mark.parametrize("change", [dict(stream_paths=0), dict(stream_paths=5), dict(threads=2)])
def test_every_way_of_tracing_gives_the_same_bits(core, change):
    settings = dict(size=24, samples=6)
    wanted = path_scenes.picture(core, linked_scene(core), **settings)
    assert wanted.mean() > 0
    np.testing.assert_array_equal(path_scenes.picture(core, linked_scene(core), **settings, **change), wanted)


def test_media_are_lit_by_the_lights_of_their_object(core):
    def fog_of(lit_by, link):
        scene = core.SceneDescription()
        program = core.Program("fog")
        color, density = program.constant(1, 1, 1, 1), program.constant(*[0.5] * 4)
        program.operation(
            "volume_scatter", [program.constant(1, 1, 1, 1), color, density, program.constant(0, 0, 0, 0)]
        )
        fog = scene.add_material_list([scene.add_material("fog", None, medium=program)])
        cube = scene.add_mesh("cube", scenes.CUBE_VERTICES, scenes.CUBE_TRIANGLES)
        scene.add_instance("fog", cube, scenes.matrix(), fog, linking=linking(lit_by))
        scene.add_lamp("lamp", "POINT", scenes.matrix((0, 0, 3)), (50,) * 3, link=link)
        scenes.look_down(scene, half=0.1)
        return path_scenes.picture(core, scene, samples=16)

    wanted = fog_of(ANY, UNLINKED)
    assert wanted.min() > 0 and (fog_of(0, (0, -1)) == 0).all()
    np.testing.assert_array_equal(fog_of(1, (0, -1)), wanted)


def test_statistics_name_light_linking_where_nothing_is_linked(core):
    for lamp, names_it in (("point", False), (None, True)):
        scene = two_floors(core, lamp=lamp) if lamp else path_scenes.lit_plane(core)
        statistics = path_scenes.render(core, scene, samples=1).statistics()
        assert ("light linking" in statistics["left_out"]) == names_it


def test_scenes_that_are_linked_otherwise_are_told_apart(core):
    scene = two_floors(core, lamp="point")
    same, other = two_floors(core, lamp="point"), two_floors(core)
    other.add_lamp("lamp", "POINT", scenes.matrix((0, 0, 2)), (50,) * 3, visibility=62)
    assert not scene.shows_same_as(other) and not same.shows_same_as(other)


def test_an_edit_of_links_shows(core):
    """Tables of a scene that is gone are what the next one begins with."""
    parts = core.SceneParts()

    def scene_of(lit_by, blocks):
        scene = core.SceneDescription(parts)
        grey = path_scenes.material(core, scene, ("diffuse", 1.0, 0.5))
        floor, plate = scenes.quad(scene, "floor", 4.0), scenes.quad(scene, "plate", 0.2)
        for name, shape, place, visibility in (("floor", floor, (0, 0, 0), 63), ("plate", plate, (0, 0, 1), 48)):
            link = linking(lit_by, blocks)
            scene.add_instance(name, shape, scenes.matrix(place), grey, visibility=visibility, linking=link)
        scene.add_lamp("lamp", "POINT", scenes.matrix((0, 0, 2)), (50,) * 3, link=(0, 0))
        scenes.look_down(scene, half=0.15)
        return scene

    means = [path_scenes.picture(core, scene_of(*sets), samples=4).mean() for sets in ((1, 1), (1, 0), (0, 0), (1, 1))]
    assert means[0] == means[3] and means[1] > means[0] > means[2] == 0


def test_a_ray_cache_is_not_asked_for_shadows_that_its_object_does_not_cast(core):
    def rendered(blocks, mode):
        scene = core.SceneDescription()
        cached_scenes.ball(core, scene, "ball", "mirror", linking=linking(blocks=blocks))
        grey = path_scenes.material(core, scene, ("diffuse", 1.0, 0.5))
        scene.add_instance("floor", scenes.quad(scene, "floor", 6.0, -1.5), scenes.matrix(), grey)
        scene.add_lamp("lamp", "POINT", scenes.matrix((-3, 0, 3)), (900,) * 3, link=(-1, 0), visibility=62)
        scenes.look_down(scene, 6.0, 0.3)
        return cached_scenes.render(core, scene, mode)

    means = {}
    for blocks in (0, 1):
        on, off = rendered(blocks, "ON"), rendered(blocks, "OFF")
        assert cached_scenes.used(on)
        pictures = [cached_scenes.picture(session) for session in (on, off)]
        assert np.abs(pictures[0] - pictures[1]).mean() < 0.01 * max(pictures[1].mean(), means.get(0, 0))
        means[blocks] = pictures[0][:, 150:].mean()  # beside the ball, in its shadow
    assert means[0] > 0.2 and means[1] < 0.1 * means[0]


@pytest.mark.parametrize(
    "numbers", [(-1, 0, -1, -1), (0, 1 << 24, -1, -1), (0, 0, 63, -1), (0, 0, -1, 24), (0, 0, -2, -1)]
)
def test_numbers_that_are_no_sets_are_refused_by_name(core, numbers):
    scene = two_floors(core)
    with pytest.raises(core.InputError, match="'far'"):
        scene.add_instance("far", 0, scenes.matrix(), 0, linking=numbers)
    with pytest.raises(core.InputError, match="'lamp'"):
        scene.add_lamp("lamp", "POINT", scenes.matrix(), (1, 1, 1), link=(63, -1))
