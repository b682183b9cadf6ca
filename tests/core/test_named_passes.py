"""Passes that a scene names: light groups and what programs write; and the passes Mist, volumes and denoisers' guides."""

import numpy as np
import pytest
from path_scenes import lit_plane, material, render, uneven_world, varied_scene
from scenes import CUBE_TRIANGLES, CUBE_VERTICES, background, emission, look_down, matrix, quad

INTEGRATORS = ["PATH", "DISTRIBUTION"]


def grouped_scene(core, fog=False):
    """A lamp, an emitting cube and the world, each in a group of its own."""
    scene = core.SceneDescription()
    floor = material(core, scene, ("diffuse", 0.7, (0.8, 0.5, 0.3)), ("glossy", 0.3, 0.9, 0.3, "GGX"))
    scene.add_instance("floor", quad(scene, "floor", 4), matrix(), floor)
    glow = scene.add_material_list([scene.add_material("glow", emission(core, color=(1, 0.6, 0.3), strength=4.0))])
    cube = scene.add_mesh("cube", CUBE_VERTICES, CUBE_TRIANGLES)
    scene.add_instance("glow", cube, matrix((-0.4, 0.6, 0.4), 0.2), glow, light_group=1)
    scene.add_lamp("key", "RECTANGLE", matrix((1, 1, 3)), (60, 60, 50), light_group=0)
    medium = None
    if fog:
        medium = core.Program("fog")
        medium.operation("volume_scatter", [medium.constant(*[v] * 4) for v in (1.0, 0.8, 0.1, 0.0)])
    scene.set_world(uneven_world(core), 32, medium, light_group=2)
    look_down(scene, height=4, half=0.35)
    return scene


@pytest.mark.parametrize("integrator", INTEGRATORS)
@pytest.mark.parametrize("fog", [False, True])
def test_light_groups_add_up_to_the_picture(core, integrator, fog):
    slots = ["slot0", "slot1", "slot2"]
    session = render(core, grouped_scene(core, fog), size=16, samples=16, integrator=integrator, exposure=1.5,
                     clamp_indirect=3.0, passes=["combined", *slots])  # fmt: skip
    groups = [session.pass_pixels(name)[..., :3].astype(np.float64) for name in slots]
    assert all(group.max() > 0 for group in groups[: 2 if fog else 3])  # fog hides the world
    np.testing.assert_allclose(sum(groups), session.pass_pixels("combined")[..., :3], rtol=1e-4, atol=1e-5)


def test_a_light_group_holds_what_its_lights_alone_would_give(core):
    scene = grouped_scene(core)
    session = render(core, scene, size=8, samples=1024, passes=["combined", "slot0"])
    alone = core.SceneDescription()
    floor = material(core, alone, ("diffuse", 0.7, (0.8, 0.5, 0.3)), ("glossy", 0.3, 0.9, 0.3, "GGX"))
    alone.add_instance("floor", quad(alone, "floor", 4), matrix(), floor)
    dark = material(core, alone, ("transparent", 0.0, 0.0))
    cube = alone.add_mesh("cube", CUBE_VERTICES, CUBE_TRIANGLES)
    alone.add_instance("glow", cube, matrix((-0.4, 0.6, 0.4), 0.2), dark)
    alone.add_lamp("key", "RECTANGLE", matrix((1, 1, 3)), (60, 60, 50))
    look_down(alone, height=4, half=0.35)
    wanted = render(core, alone, size=8, samples=1024).pass_pixels("combined")[..., :3]
    found = session.pass_pixels("slot0")[..., :3]
    assert found.mean() == pytest.approx(wanted.mean(), rel=0.02)


def written_scene(core, transparency=None):
    """A plane whose program writes its position to slot 1 and a number to slot 0."""
    scene = core.SceneDescription()
    program = core.Program("writes")
    one = program.constant(1, 1, 1, 1)
    if transparency is None:
        program.operation("diffuse", [one, program.constant(0.5, 0.5, 0.5, 1)])
    else:
        program.operation("transparent", [one, program.constant(*[transparency] * 3, 1)])
    program.operation("aov", [program.operation("position")], [1])
    program.operation("aov", [program.constant(*[7.0] * 4)], [0])
    materials = scene.add_material_list([scene.add_material("writes", program)])
    scene.add_instance("plane", quad(scene, "plane", 0.5), matrix((0, 0, 1)), materials)
    look_down(scene, height=5, half=0.4)
    return scene


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_programs_write_to_slots_where_the_camera_sees_them(core, integrator):
    passes = ["combined", "position", "slot0", "slot1"]
    session = render(core, written_scene(core), size=9, samples=64, integrator=integrator, exposure=2.0, passes=passes)
    value, position = session.pass_pixels("slot0"), session.pass_pixels("slot1")
    assert value[4, 4] == pytest.approx([7, 7, 7, 1]) and np.all(value[0] == 0)
    assert position[4, 4, 2] == pytest.approx(1.0)
    assert position[4, 3, 0] == pytest.approx(session.pass_pixels("position")[4, 3, 0], abs=0.3)
    # Where the plane covers a part of a pixel, that part.
    edge = value[4, :, 3]
    np.testing.assert_allclose(value[4, :, 0], 7 * edge, rtol=1e-5)


def test_surfaces_behind_an_opaque_one_write_nothing_and_those_behind_glass_add(core):
    passes = ["combined", "slot0"]
    scene = written_scene(core, transparency=0.9)
    program = core.Program("behind")
    program.operation("diffuse", [program.constant(1, 1, 1, 1), program.constant(0.5, 0.5, 0.5, 1)])
    program.operation("aov", [program.constant(*[1.0] * 4)], [0])
    behind = scene.add_material_list([scene.add_material("behind", program)])
    scene.add_instance("behind", quad(scene, "behind", 4), matrix(), behind)
    scene.add_instance("hidden", quad(scene, "hidden", 4), matrix((0, 0, -1)), behind)
    session = render(core, scene, size=9, samples=16, passes=passes)
    assert session.pass_pixels("slot0")[4, 4] == pytest.approx([8, 8, 8, 2])
    assert session.pass_pixels("slot0")[0, 0] == pytest.approx([1, 1, 1, 1])


def test_a_slot_that_nobody_asks_for_costs_and_changes_nothing(core):
    plain = render(core, varied_scene(core), samples=4).pass_pixels("combined")
    scene = varied_scene(core)
    asked = render(core, scene, samples=4, passes=["combined", "slot63", "crypto_asset_07"])
    assert np.array_equal(asked.pass_pixels("combined"), plain)
    with pytest.raises(core.InputError, match="slot64"):
        core.Settings(passes=["slot64"])
    with pytest.raises(core.InputError, match="slot0"):
        asked.pass_pixels("slot0")


def test_the_passes_by_name_have_the_same_bits_for_any_threads_and_streams(core):
    passes = ["combined", "slot0", "slot1", "slot2", "mist", "denoising_albedo", "denoising_normal", "denoising_depth"]

    def pixels(**settings):
        session = render(core, grouped_scene(core), size=20, samples=6, passes=passes, **settings)
        return [session.pass_pixels(name).tobytes() for name in passes]

    first = pixels(threads=1)
    assert pixels(threads=5, tile_size=8) == first
    assert pixels(stream_paths=0) == first


@pytest.mark.parametrize("integrator", INTEGRATORS)
@pytest.mark.parametrize("falloff", [0.5, 1.0, 2.0])
def test_mist_rises_from_its_start_over_its_depth(core, integrator, falloff):
    scene = core.SceneDescription()
    for place, height in ((-1.0, 4.0), (0.0, 2.0), (1.0, 0.0)):
        scene.add_instance("quad", quad(scene, "quad", 0.3), matrix((place, 0, height)))
    look_down(scene, height=5, half=0.3)  # 2 units wide at a distance of 3.3
    mist = dict(mist_start=2.0, mist_depth=4.0, mist_falloff=falloff)
    session = render(core, scene, size=64, samples=4, integrator=integrator, passes=["combined", "mist"], **mist)
    found = session.pass_pixels("mist")[32, :, 0]
    assert found[0] == 1.0  # nothing there
    assert found[32] == pytest.approx(((3.0 - 2.0) / 4.0) ** falloff, abs=0.02)


def test_what_volumes_scatter_goes_into_their_passes(core):
    passes = ["combined", "volume_direct", "volume_indirect", "emission", "environment"]
    parts = [f"{kind}_{part}" for kind in ("diffuse", "glossy") for part in ("direct", "indirect", "color")]
    for integrator in INTEGRATORS:
        session = render(core, grouped_scene(core, fog=True), size=12, samples=32, integrator=integrator,
                         volume_bounces=4, passes=[*passes, *parts])  # fmt: skip
        found = {name: session.pass_pixels(name)[..., :3].astype(np.float64) for name in [*passes, *parts]}
        assert found["volume_direct"].max() > 0 and found["volume_indirect"].max() > 0
        total = sum(found[name] for name in passes[1:])
        for kind in ("diffuse", "glossy"):
            total = total + found[f"{kind}_color"] * (found[f"{kind}_direct"] + found[f"{kind}_indirect"])
        np.testing.assert_allclose(total, found["combined"], rtol=1e-4, atol=1e-4)


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_guides_of_denoisers_are_seen_through_mirrors(core, integrator):
    scene = core.SceneDescription()
    mirror = material(core, scene, ("glossy", 1.0, (0.5, 1.0, 1.0), 0.0, "SHARP"))
    scene.add_instance("mirror", quad(scene, "mirror", 10), matrix(), mirror)
    red = material(core, scene, ("diffuse", 1.0, (0.8, 0.2, 0.1)))
    scene.add_instance("ceiling", quad(scene, "ceiling", 20), matrix((0, 0, 8)), red)
    scene.set_world(background(core, strength=1.0))
    look_down(scene, height=5, half=0.2)
    passes = ["combined", "denoising_albedo", "denoising_normal", "denoising_depth"]
    session = render(core, scene, size=5, samples=16, integrator=integrator, passes=passes)
    assert session.pass_pixels("denoising_albedo")[2, 2] == pytest.approx([0.4, 0.2, 0.1], rel=1e-3)
    assert session.pass_pixels("denoising_normal")[2, 2] == pytest.approx([0, 0, 1], abs=1e-3)
    depth = 5.0 + 8.0 * (0.5 + 1 + 1) / 3
    assert session.pass_pixels("denoising_depth")[2, 2, 0] == pytest.approx(depth, rel=0.02)


def test_guides_of_what_shines_are_its_colour_up_to_one(core):
    scene = lit_plane(core, albedo=0.25)
    glow = scene.add_material_list([scene.add_material("glow", emission(core, color=(3.0, 0.5, 0.0), strength=1.0))])
    scene.add_instance("glow", quad(scene, "glow", 0.1), matrix((0, 0, 1)), glow)
    session = render(core, scene, size=5, samples=4, passes=["combined", "denoising_albedo"])
    assert session.pass_pixels("denoising_albedo")[2, 2] == pytest.approx([1.0, 0.5, 0.0])
