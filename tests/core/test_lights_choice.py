"""Which of many lights is chosen: by the cosine at the point, and by the side that shines."""

import numpy as np
import pytest
from light_support import NORMAL, POSITION, emitter_scene, random_numbers
from path_scenes import lit_plane, material, render
from scenes import CUBE_TRIANGLES, CUBE_VERTICES, diffuse, emission, look_down, matrix, quad
from test_emitting_surfaces import SHAPES
from test_lights_sampling import LAMPS, POWER, irradiance, probe_of, tilted


@pytest.mark.parametrize("normal", [[0, 0, 1.0], [1.0, 0, 0.2], [0, 0, -1.0]])
def test_a_normal_changes_which_light_is_chosen_but_not_how_much_arrives(core, normal):
    normal = np.array(normal) / np.linalg.norm(normal)
    lamps = [LAMPS[name] for name in ("sphere", "wide sun", "rectangle", "disk")]
    frames = [tilted((x, 0.4, z), a) for x, z, a in ((-2.5, 1.2, 0), (0, 1, 0.3), (0.6, 1.2, 0.3), (2.0, -3, 3.0))]
    probe = probe_of(core, *[{**lamp, "matrix": frame} for lamp, frame in zip(lamps, frames, strict=True)])
    random = random_numbers(100000)
    plain, plain_error = irradiance(probe.sample(POSITION, random), normal)
    samples = probe.sample(POSITION, random, normal=normal)
    value, error = irradiance(samples, normal)
    assert abs(value - plain) < 5 * np.hypot(error, plain_error)
    assert error < 1.1 * plain_error
    # Lights that are behind the surface are still chosen.
    behind = (samples["density"] > 0) & (samples["direction"] @ normal < 0)
    assert 0 < behind.mean() < ((samples["direction"] @ normal > 0) & (samples["density"] > 0)).mean()


def test_with_a_normal_few_samples_go_to_a_lamp_behind_the_surface(core):
    frames = [tilted((0.3, 0.2, z - 0.4), angle) for z, angle in ((2.0, 0.0), (-2.0, np.pi))]
    probe = probe_of(core, *[{**LAMPS["rectangle"], "matrix": frame} for frame in frames])
    random = random_numbers(20000)
    (_, error), (_, plain_error) = (
        irradiance(probe.sample(POSITION, random, normal=normal), NORMAL) for normal in (NORMAL, None)
    )
    assert error < 0.5 * plain_error


def test_with_a_normal_the_density_is_the_one_that_scattered_rays_are_told(core):
    lamps = [{**LAMPS["rectangle"], "matrix": tilted((x, 0.4, 1.2))} for x in (-2.5, 0.6, 3.0)]
    probe = probe_of(core, *lamps)
    normal = np.array([0.6, 0, 0.8])
    samples = probe.sample(POSITION, random_numbers(2000), normal=normal)
    _, density = probe.look(POSITION, samples["direction"].astype(np.float64), normal=normal)
    np.testing.assert_allclose(density, samples["density"], rtol=1e-3)


def fine_ball(scene, rings=8, radius=1.0):
    """A mesh of triangles whose outside is the ball's."""
    z, turn = np.meshgrid(np.linspace(np.pi, 0, rings + 1), np.arange(2 * rings) * np.pi / rings, indexing="ij")
    vertices = radius * np.stack([np.sin(z) * np.cos(turn), np.sin(z) * np.sin(turn), np.cos(z)], -1).reshape(-1, 3)
    triangles = []
    for i in range(rings):
        for j in range(2 * rings):
            a, b = 2 * rings * i + j, 2 * rings * i + (j + 1) % (2 * rings)
            triangles += [[a, b, b + 2 * rings]] if i > 0 else []
            triangles += [[a, b + 2 * rings, a + 2 * rings]] if i < rings - 1 else []
    return scene.add_mesh("ball", vertices.astype(np.float32), np.array(triangles, np.int32))


@pytest.mark.parametrize("position", [[0.3, 0.2, -2.0], [-2.0, 1.0, -5.0], [4.0, -3.0, 5.0]])
def test_of_a_ball_of_light_the_side_that_is_seen_is_chosen_nearly_always(core, position):
    probe = core.LightProbe(emitter_scene(core, fine_ball))
    samples = probe.sample(np.array(position), random_numbers(20000))
    used = samples["density"] > 0
    at = position + samples["direction"][used] * samples["distance"][used, None]
    faces = ((at - [0, 0, 1.5]) * -samples["direction"][used]).sum(1) > 0
    assert faces.mean() > 0.75, "what crosses the ball's horizon, so that some of its far side is chosen"


def test_within_a_ball_of_light_its_inside_is_chosen(core):
    probe = core.LightProbe(emitter_scene(core, SHAPES["a spline sphere"](core)))
    position = np.array([0.1, 0.0, 1.6])
    samples = probe.sample(position, random_numbers(20000))
    used = samples["density"] > 0
    at = position + samples["direction"][used] * samples["distance"][used, None]
    assert used.mean() > 0.99 and not (((at - [0, 0, 1.5]) * -samples["direction"][used]).sum(1) > 0).any()


def deviation(samples, normal=NORMAL):
    """Of one sample of the irradiance, over the mean."""
    value, error = irradiance(samples, normal)
    return error / value * len(samples["density"]) ** 0.5


def noise_beside_a_ball(core, lamps):
    """Of its outside and some lamps, at several places."""
    center, radius, result = np.array([0, 2, 3]), 0.5, []
    for position in ([0.3, 0.2, -0.4], [3, 3, -0.4], [-4, -4, -0.4], [6, -6, -0.4]):
        scene = core.SceneDescription()
        look_down(scene)
        glow = [scene.add_material("glow", emission(core, strength=POWER))]
        scene.add_instance("ball", fine_ball(scene, radius=radius), matrix(center), scene.add_material_list(glow))
        for i, place in enumerate(lamps):
            scene.add_lamp(f"lamp {i}", "POINT", matrix(place), (POWER,) * 3, radius=0.1)
        samples = core.LightProbe(scene).sample(np.array(position, float), random_numbers(20000), normal=NORMAL)
        from_center = position + samples["direction"] * samples["distance"][:, None] - center
        outwards = (from_center * samples["direction"]).sum(1) > 0
        samples["radiance"][outwards & (np.linalg.norm(from_center, axis=1) < 1.1 * radius)] = 0
        result.append(deviation(samples))
    return np.array(result)


def test_the_triangles_of_a_ball_are_chosen_by_what_of_them_is_seen(core):
    assert noise_beside_a_ball(core, []).max() < 0.5


def test_lamps_and_a_shape_of_many_small_lights_are_chosen_by_what_they_shine(core):
    """The tree divides lights where they are unlike, not where half of their number is."""
    assert noise_beside_a_ball(core, [(5, 0, 3)]).mean() < 0.6


def test_a_lamp_that_is_far_stronger_leaves_some_samples_to_the_others(core):
    """It may be hidden, which the choice does not know."""
    lamps = [{**LAMPS["point"], "matrix": tilted((x, 0.0, 2.0)), "strength": (s,) * 3} for x, s in ((-1, 1), (1, 1e6))]
    samples = probe_of(core, *lamps).sample(np.zeros(3), random_numbers(20000), normal=np.array([0, 0, 1.0]))
    assert 0.1 < (samples["direction"][:, 0] < 0).mean() < 0.2


def test_of_a_lamp_that_the_horizon_cuts_the_part_above_it_counts(core):
    """At best its cosine is that of its upper end."""
    at_horizon = {**LAMPS["rectangle"], "matrix": tilted((0, 6.0, 0), -np.pi / 2), "strength": (40 * POWER,) * 3}
    above = {**LAMPS["sphere"], "matrix": tilted((0, 0, 3.0))}
    probe = probe_of(core, at_horizon, above)
    samples = probe.sample(np.zeros(3), random_numbers(20000), normal=np.array([0, 0, 1.0]))
    assert deviation(samples, np.array([0, 0, 1.0])) < 1.0


def plane_with_lamps(core, count):
    """Lit evenly by lamps side by side; the first is behind a wall."""
    scene = lit_plane(core)
    black = material(core, scene, ("diffuse", 1.0, 0.0), name="black")
    scene.add_instance("wall", quad(scene, "wall", 0.2), matrix((0.25, 0, 0.5)), black, visibility=16)
    for i in range(count):
        scene.add_lamp(f"lamp {i}", "POINT", matrix((0.5 - i, 0, 1)), (10, 10, 10))
    return scene


def test_where_there_are_several_lights_the_first_surface_is_lit_by_two_of_them(core):
    scene = plane_with_lamps(core, 2)
    session = render(core, scene, size=16, samples=1, max_bounces=0)
    light = session.pass_pixels("combined")[6:10, 6:10, 0]
    # By one of them, half the samples would be black.
    assert light.min() > 0.5 * light.mean() and light.std() < 0.3 * light.mean()


@pytest.mark.parametrize("lamps, per_path", [(1, 1), (2, 2), (3, 2)])
def test_there_are_as_many_shadow_rays_as_lights_are_sampled(core, lamps, per_path):
    rays = render(core, plane_with_lamps(core, lamps), size=4, samples=16, max_bounces=0).statistics()["rays"]
    assert rays["shadow"] == per_path * rays["camera"] == per_path * 4 * 4 * 16


def test_further_surfaces_are_lit_by_one_light(core):
    scene = plane_with_lamps(core, 2)
    ceiling = material(core, scene, ("diffuse", 1.0, 0.5), name="ceiling")
    scene.add_instance("ceiling", quad(scene, "ceiling", 40.0), matrix((0, 0, 2)), ceiling, visibility=2)
    rays = render(core, scene, size=4, samples=64, max_bounces=1).statistics()["rays"]
    first = 2 * rays["camera"]
    assert first < rays["shadow"] <= first + rays["camera"]


def test_a_limit_on_light_is_that_of_the_sum_of_what_two_lights_give(core):
    limit = 0.2
    light = render(core, plane_with_lamps(core, 3), size=8, samples=1, max_bounces=0, clamp_direct=limit)
    assert light.pass_pixels("combined")[..., 0].max() <= limit * (1 + 1e-5)


BESIDE = np.array([6.0, 0, 0.5])


def share_of_a_lamp(core, *walls, at=(0, 0, 1), position=BESIDE, normal=(0, 0, 1.0), visibility=127):
    """How often the lamp at a place is chosen where another like it is as far away on the other side; walls are a shape,
    its matrix and its material."""
    scene = core.SceneDescription()
    look_down(scene)
    for i, (add, place, kind) in enumerate(walls):
        made = material(core, scene, (kind, 1.0, 0.8), name=f"wall {i}")
        scene.add_instance(f"wall {i}", add(scene, f"wall {i}"), place, made, visibility=visibility)
    for i, place in enumerate((np.array(at), 2 * position - at)):
        place[2] = at[2]
        scene.add_lamp(f"lamp {i}", "POINT", matrix(place), (POWER,) * 3)
    samples = core.LightProbe(scene).sample(position, random_numbers(20000), normal=np.array(normal))
    return (samples["direction"][:, 0] * np.sign(at[0] - position[0]) > 0).mean()


def test_a_lamp_is_chosen_less_where_its_light_is_seen_to_end(core):
    """Few rays of the lamp tell, about what casts shadows and lets nothing through."""

    def box(scene, name):
        return scene.add_mesh(name, 0.5 * CUBE_VERTICES, CUBE_TRIANGLES)

    around = matrix((0, 0, 1))
    assert abs(share_of_a_lamp(core) - 0.5) < 0.02
    assert share_of_a_lamp(core, (box, around, "diffuse")) < 0.2
    assert abs(share_of_a_lamp(core, (box, around, "transparent")) - 0.5) < 0.02
    assert abs(share_of_a_lamp(core, (box, around, "diffuse"), visibility=1) - 0.5) < 0.02
    assert share_of_a_lamp(core, (box, around, "diffuse"), position=np.array([0.3, 0, 0.9])) > 0.4, "it is within"


def test_a_surface_that_is_lit_does_not_seem_to_stand_before_itself(core):
    """However flat the light arrives, on this side of a wall or the other."""

    def floor(scene, name):
        return quad(scene, name, 50.0)

    low = np.array([0, 0, 0.1])
    wall = matrix((3.0, 0, 0)) @ np.array([[0, 0, 1, 0], [0, 1, 0, 0], [-1, 0, 0, 0], [0, 0, 0, 1.0]])
    ground = (floor, matrix(), "diffuse")
    at = np.array([6.0, 0, 0])
    assert abs(share_of_a_lamp(core, ground, at=low, position=at) - 0.5) < 0.02
    assert share_of_a_lamp(core, ground, (floor, wall, "diffuse"), at=low, position=at) < 0.35
    before = np.array([2.9, 0, 0])
    assert abs(share_of_a_lamp(core, (floor, wall, "diffuse"), at=low, position=before, normal=(-1.0, 0, 0)) - 1) < 0.2


def test_what_stands_around_lights_changes_no_mean(core):
    """By its density each sample is worth what the choice made of it."""
    values = []
    for kind in ("diffuse", "transparent"):
        scene = core.SceneDescription()
        look_down(scene)
        box = scene.add_mesh("box", 0.5 * CUBE_VERTICES, CUBE_TRIANGLES)
        scene.add_instance("box", box, matrix((0, 0, 1)), material(core, scene, (kind, 1.0, 0.8)))
        for i, x in enumerate((0.0, 3.0, 7.0, -5.0, 4.0, -9.0)):
            scene.add_lamp(f"lamp {i}", "POINT", matrix((x, 0.5 * i * (i > 0), 1)), (POWER,) * 3, radius=0.2)
        probe = core.LightProbe(scene)
        samples = probe.sample(BESIDE, random_numbers(100000), normal=NORMAL)
        values.append(irradiance(samples))
        _, density = probe.look(BESIDE, samples["direction"][:2000].astype(np.float64), normal=NORMAL)
        met = density > 0  # by rounding a ray to the rim of a ball may miss it
        assert met.mean() > 0.98
        np.testing.assert_allclose(density[met], samples["density"][:2000][met], rtol=1e-3)
    (first, error), (second, other) = values
    assert abs(first - second) < 5 * np.hypot(error, other)


CUBE = np.array([[x, y, z] for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)], np.float32)
FACES = [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]]


def share_from_the_sky(core, faces=6, outside=False):
    """Of the samples near a lamp in a shining cube, how many go to the cube."""
    scene = core.SceneDescription()
    look_down(scene)
    triangles = [part for a, b, c, d in FACES[6 - faces :] for part in ([a, b, c], [a, c, d])]
    cube = scene.add_mesh("sky", 20 * CUBE, np.array(triangles, np.int32))
    glow = [scene.add_material("glow", emission(core, strength=0.3))]
    scene.add_instance("sky", cube, np.eye(4), scene.add_material_list(glow))
    scene.add_lamp("lamp", "POINT", matrix((0, 0, 1)), (20 * POWER,) * 3)
    if outside:
        dark = [scene.add_material("dark", diffuse(core))]
        scene.add_instance("plane", quad(scene, "plane"), matrix((0, 0, 100)), scene.add_material_list(dark))
    samples = core.LightProbe(scene).sample(POSITION, random_numbers(20000))
    return ((samples["density"] > 0) & (samples["distance"] > 10)).mean()


def test_an_even_sky_around_the_whole_scene_is_left_to_scattered_rays(core):
    """As the world is: what a sky has in common everywhere, rays that any surface scatters find."""
    around, open_one, of_some = (share_from_the_sky(core, **each) for each in ({}, {"faces": 5}, {"outside": True}))
    assert 0 < around < 0.65 * min(open_one, of_some)


def test_a_lamp_beside_a_long_weak_light_is_chosen_as_often_as_without_it(core):
    """Among other small lights: one is chosen by nodes, and nobody is outside of one that holds the long light."""
    shares = []
    for length in (0.0, 400.0, 4000.0):
        scene = core.SceneDescription()
        glow = scene.add_material_list([scene.add_material("glow", emission(core, strength=3.0))])
        for i in range(200):
            scene.add_instance("bead", quad(scene, "bead", 0.05), matrix((0.15 * i - 15, 3, 0)), glow)
        scene.add_lamp("lamp", "POINT", matrix((0.05, -0.5, 1)), (1000.0,) * 3, radius=0.1)
        stripe = matrix((0, -0.5, 0))
        stripe[1, 1] = length
        if length > 0.0:
            scene.add_instance("stripe", quad(scene, "stripe", 0.1), stripe, glow)
        look_down(scene)
        samples = core.LightProbe(scene).sample(np.array([0.5, 2.5, 0.2]), random_numbers(20000))
        shares.append((samples["radiance"].max(axis=1) > 10.0).mean())
    assert shares[0] > 0.5
    assert min(shares[1:]) > 0.8 * shares[0]
