"""Lamps, emitting surfaces and the world: what they give, and that they are sampled with the density they claim."""

import numpy as np
import pytest
from light_support import NORMAL, POSITION, random_numbers, sphere_directions
from scenes import background, emission, look_down, matrix

POWER = 100.0
AREA_RADIANCE = POWER / 4  # times 1 / area


def tilted(translation=(0.0, 0.0, 1.0), angle=0.3):
    """A frame turned about x; lamps shine along its -z."""
    m = np.eye(4)
    c, s = np.cos(angle), np.sin(angle)
    m[1:3, 1:3] = [[c, -s], [s, c]]
    m[:3, 3] = translation
    return m


LAMPS = {
    "point": dict(kind="POINT"),
    "sphere": dict(kind="POINT", radius=0.5),
    "sphere around the point": dict(kind="POINT", radius=3.0),
    "soft point": dict(kind="POINT", radius=0.5, soft_falloff=True),
    "soft point nearer than its radius": dict(kind="POINT", radius=3.0, soft_falloff=True),
    "soft spot": dict(kind="SPOT", spot_size=2.0, spot_blend=0.5, radius=0.4, soft_falloff=True),
    "spot": dict(kind="SPOT", spot_size=2.0, spot_blend=0.5),
    "wide spot": dict(kind="SPOT", spot_size=2.0, spot_blend=0.5, radius=0.4),
    "sun": dict(kind="SUN"),
    "wide sun": dict(kind="SUN", angle=0.5),
    "half a sky of sun": dict(kind="SUN", angle=np.pi),
    "rectangle": dict(kind="RECTANGLE", size_x=1.5, size_y=0.7),
    "rectangle with spread": dict(kind="RECTANGLE", size_x=1.5, size_y=0.7, spread=1.2),
    "small rectangle": dict(kind="RECTANGLE", size_x=0.04, size_y=0.03),
    "disk": dict(kind="DISK", size_x=1.5, size_y=0.7),
    "disk with spread": dict(kind="DISK", size_x=1.5, size_y=0.7, spread=1.2),
}
WIDE = [name for name in LAMPS if name not in ("point", "spot", "sun", "small rectangle")]


def probe_of(core, *lamps, frame=None):
    scene = core.SceneDescription()
    look_down(scene)
    for i, lamp in enumerate(lamps):
        arguments = {"matrix": tilted() if frame is None else frame, "strength": (POWER,) * 3, **lamp}
        scene.add_lamp(name=f"lamp {i}", **arguments)
    return core.LightProbe(scene)


def irradiance(samples, normal=NORMAL):
    """Mean and standard error of the irradiance by light sampling."""
    cosine = np.maximum(samples["direction"] @ normal, 0)
    density = samples["density"]
    values = np.where(density > 0, samples["radiance"][:, 0] * cosine / np.where(density > 0, density, 1), 0)
    return values.mean(), values.std() / np.sqrt(len(values))


@pytest.mark.parametrize("name", WIDE)
def test_sampling_and_looking_agree_on_density_and_radiance(core, name):
    probe = probe_of(core, LAMPS[name])
    samples = probe.sample(POSITION, random_numbers(4000))
    used = samples["density"] > 0
    assert used.mean() > 0.3 and not samples["delta"].any()
    radiance, density = probe.look(POSITION, samples["direction"][used].astype(np.float64))
    # Directions pass through floats: within 1e-6 of a lamp's border a ray may miss it.
    seen = density > 0
    assert seen.mean() > 0.999
    np.testing.assert_allclose(density[seen], samples["density"][used][seen], rtol=1e-3)
    np.testing.assert_allclose(radiance[seen, 0], samples["radiance"][used][seen, 0], rtol=1e-2, atol=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize("name", WIDE)
def test_light_sampling_gives_the_irradiance_of_looking_everywhere(core, name):
    probe = probe_of(core, LAMPS[name])
    sampled, error = irradiance(probe.sample(POSITION, random_numbers(40000)))
    directions = sphere_directions(400000)
    radiance, density = probe.look(POSITION, directions)
    values = 4 * np.pi * radiance[:, 0] * np.maximum(directions @ NORMAL, 0)
    spread = np.hypot(error, values.std() / np.sqrt(len(values)))
    assert abs(sampled - values.mean()) < 5 * spread, f"{sampled} against {values.mean()} +- {spread}"
    # The density integrates to at most 1, less where samples may carry nothing.
    share = 4 * np.pi * density
    assert share.mean() <= 1.0001 + 5 * share.std() / np.sqrt(len(share))


@pytest.mark.parametrize("name", [n for n in LAMPS if "sphere" in n or n == "point"][:2])
def test_a_point_lamp_follows_the_inverse_square_law_whatever_its_radius(core, name):
    probe = probe_of(core, LAMPS[name])
    offset = np.array([0.0, 0.0, 1.0]) - POSITION
    distance = np.linalg.norm(offset)
    expected = POWER / (4 * np.pi) / distance**2 * (offset / distance @ NORMAL)
    value, error = irradiance(probe.sample(POSITION, random_numbers(20000)))
    assert abs(value - expected) < 5 * error + 1e-5 * expected


def test_inside_a_shining_sphere_every_direction_is_as_bright(core):
    value, error = irradiance(probe_of(core, dict(kind="POINT", radius=3.0)).sample(POSITION, random_numbers(40000)))
    expected = np.pi * POWER / (4 * np.pi**2 * 9)
    assert abs(value - expected) < 5 * error


@pytest.mark.parametrize("radius", [0.01, 0.5, 3.0, 100.0])
def test_a_point_lamp_with_soft_falloff_is_a_disk_that_faces_the_point(core, radius):
    probe = probe_of(core, dict(kind="POINT", radius=radius, soft_falloff=True))
    offset = np.array([0.0, 0.0, 1.0]) - POSITION
    square = offset @ offset
    facing = offset / np.sqrt(square)
    value, error = irradiance(probe.sample(POSITION, random_numbers(20000)), facing)
    expected = POWER / (4 * np.pi**2 * radius**2) * np.pi * radius**2 / (radius**2 + square)
    assert abs(value - expected) < 5 * error + 1e-5 * expected


def test_a_sun_gives_its_strength_to_a_surface_that_faces_it(core):
    toward = tilted()[:3, 2]
    value, error = irradiance(probe_of(core, dict(kind="SUN")).sample(POSITION, random_numbers(10)), toward)
    assert value == pytest.approx(POWER, rel=1e-5)
    # Over the cap of half angle a the mean cosine is (1 + cos a) / 2.
    value, error = irradiance(
        probe_of(core, dict(kind="SUN", angle=0.5)).sample(POSITION, random_numbers(40000)), toward
    )
    assert abs(value - POWER * (1 + np.cos(0.25)) / 2) < 5 * error


@pytest.mark.parametrize("profile", ["COSINE", "EVEN"])
def test_a_spot_fades_from_its_axis_to_the_border_of_its_cone(core, profile):
    size, blend = 1.2, 0.5
    lamp = dict(kind="SPOT", spot_size=size, spot_blend=blend, spot_profile=profile)
    probe = probe_of(core, lamp, frame=matrix((0, 0, 2)))
    for x in (0.0, 0.4, 0.9, 1.2, 1.35, 1.4):
        cosine = 2 / np.hypot(2, x)
        border = np.cos(size / 2)
        t = np.clip((cosine - border) / ((1 - border) * blend), 0, 1)
        intensity = POWER / (4 * np.pi) * (cosine if profile == "COSINE" else 1) * t * t * (3 - 2 * t)
        samples = probe.sample(np.array([x, 0, 0.0]), random_numbers(1))
        assert samples["radiance"][0, 0] == pytest.approx(intensity / (4 + x * x), rel=1e-5, abs=1e-7), f"x = {x}"


def parallel_rectangle(a, b, c):
    """Form factor from a patch to a rectangle a x b above one of its corners, at height c (Howell, B-4)."""
    x, y = a / c, b / c
    return (
        x / np.sqrt(1 + x * x) * np.arctan(y / np.sqrt(1 + x * x))
        + y / np.sqrt(1 + y * y) * np.arctan(x / np.sqrt(1 + y * y))
    ) / (2 * np.pi)


@pytest.mark.parametrize("height", [0.01, 0.5, 2.0, 50.0])
def test_a_rectangle_lights_by_its_form_factor(core, height):
    a, b = 1.5, 0.7
    probe = probe_of(core, dict(kind="RECTANGLE", size_x=a, size_y=b), frame=matrix((a / 2, b / 2, height)))
    value, error = irradiance(probe.sample(np.zeros(3), random_numbers(20000)), np.array([0, 0, 1.0]))
    expected = np.pi * AREA_RADIANCE / (a * b) * parallel_rectangle(a, b, height)
    assert abs(value - expected) < 5 * error + 1e-5 * expected


@pytest.mark.parametrize("height", [0.05, 0.5, 2.0, 50.0])
def test_a_disk_lights_by_its_form_factor(core, height):
    radius = 0.6
    lamp = dict(kind="DISK", size_x=2 * radius, size_y=2 * radius)
    value, error = irradiance(
        probe_of(core, lamp, frame=matrix((0, 0, height))).sample(np.zeros(3), random_numbers(40000)),
        np.array([0, 0, 1.0]),
    )
    expected = np.pi * AREA_RADIANCE / (np.pi * radius**2) * radius**2 / (radius**2 + height**2)
    assert abs(value - expected) < 5 * error + 1e-5 * expected


@pytest.mark.parametrize("spread", [0.2, 1.0, 2.5, np.pi])
def test_the_spread_of_an_area_lamp_keeps_its_power(core, spread):
    """Far away: the integral of intensity over the hemisphere is that of a lamp without slats, pi P / 4."""
    far = 1e4
    probe = probe_of(core, dict(kind="RECTANGLE", size_x=0.1, size_y=0.1, spread=spread), frame=matrix())
    angle = (np.arange(400) + 0.5) / 400 * np.pi / 2
    intensity = []
    for a in angle:
        position = far * np.array([np.sin(a), 0, -np.cos(a)])
        value, _ = irradiance(probe.sample(position, random_numbers(4)), -position / far)
        intensity.append(value * far**2)
    power = np.sum(2 * np.pi * np.sin(angle) * np.array(intensity)) * np.pi / 2 / 400
    assert power == pytest.approx(np.pi * POWER / 4, rel=5e-3)


@pytest.mark.parametrize("lamp", LAMPS.values(), ids=LAMPS.keys())
@pytest.mark.parametrize("size", [0.0, 1e-20, 1e-9, 1e6])
def test_sizes_near_zero_and_huge_powers_stay_finite(core, lamp, size):
    sizes = {key: size for key in ("radius", "angle", "size_x", "size_y", "spread", "spot_size")}
    probe = probe_of(core, {**lamp, **sizes, "strength": (1e9, 1.0, 0.0)})
    for position in (POSITION, np.array([0, 0, 1.0]), np.array([0, 0, 1 - 1e-9]), np.array([1e7, 3, -1e7])):
        samples = probe.sample(position, random_numbers(200))
        for key in ("direction", "radiance", "density"):
            assert np.isfinite(samples[key]).all(), f"{key} at {position}"
        contribution = samples["radiance"][:, 0] / np.maximum(samples["density"], 1e-30)
        assert np.isfinite(contribution).all()
        radiance, density = probe.look(position, sphere_directions(200))
        assert np.isfinite(radiance).all() and np.isfinite(density).all()


def striped_world(core):
    """Bright in a small part of the sky, by a checker over the direction."""
    program = core.Program("world")
    direction = program.operation("generated")
    one = program.constant(1, 1, 1, 1)
    checker = program.operation(
        "checker",
        [direction, program.constant(30, 25, 20, 1), program.constant(0.1, 0.2, 0.3, 1), program.constant(*[1.5] * 4)],
    )
    program.operation("background", [one, checker, one])
    return program


def world_probe(core, world, resolution=64):
    scene = core.SceneDescription()
    look_down(scene)
    scene.set_world(world, resolution)
    return core.LightProbe(scene)


@pytest.mark.slow
def test_the_world_is_sampled_with_the_density_it_claims(core):
    probe = world_probe(core, striped_world(core))
    samples = probe.sample(POSITION, random_numbers(200000))
    _, density = probe.look(POSITION, samples["direction"].astype(np.float64))
    # Directions pass through floats: on a cell's border the neighbour may answer.
    assert np.isclose(density, samples["density"], rtol=1e-3).mean() > 0.999
    # Chi-square over 12 x 24 boxes of equal solid angle.
    directions = sphere_directions(2000000)
    expected_density = probe.look(POSITION, directions)[1].astype(np.float64)

    def boxes(d):
        rows = np.minimum(((1 - d[:, 2]) / 2 * 12).astype(int), 11)
        columns = np.minimum(((np.arctan2(d[:, 1], d[:, 0]) / (2 * np.pi) % 1) * 24).astype(int), 23)
        return rows * 24 + columns

    expected = np.bincount(boxes(directions), expected_density, 288) * 4 * np.pi / len(directions) * 200000
    variance = np.bincount(boxes(directions), expected_density**2, 288) * (4 * np.pi / len(directions) * 200000) ** 2
    counted = np.bincount(boxes(samples["direction"]), minlength=288)
    assert counted.sum() == pytest.approx(expected.sum(), rel=0.01)
    statistic = np.sum((counted - expected) ** 2 / (expected + variance))
    assert statistic < 288 + 5 * np.sqrt(2 * 288), f"chi-square {statistic} of 287 degrees of freedom"


def test_a_world_that_is_black_or_the_same_everywhere_is_not_sampled(core):
    assert world_probe(core, background(core)).count() == 0
    assert world_probe(core, background(core, strength=0.0)).count() == 0
    assert world_probe(core, striped_world(core)).count() == 1


def test_among_many_lights_the_choice_is_part_of_the_density(core):
    lamps = [LAMPS[name] for name in ("sphere", "wide sun", "rectangle", "disk")]
    frames = [tilted((x, 0.4, 1.2)) for x in (-2.5, 0, 0.6, 3.0)]
    probe = probe_of(core, *[{**lamp, "matrix": frame} for lamp, frame in zip(lamps, frames, strict=True)])
    alone = [probe_of(core, {**lamp, "matrix": frame}) for lamp, frame in zip(lamps, frames, strict=True)]
    together, error = irradiance(probe.sample(POSITION, random_numbers(100000)))
    parts = [irradiance(p.sample(POSITION, random_numbers(40000))) for p in alone]
    expected = sum(value for value, _ in parts)
    spread = np.sqrt(error**2 + sum(e**2 for _, e in parts))
    assert abs(together - expected) < 5 * spread


def test_among_hundreds_of_lamps_a_ray_meets_exactly_those_in_its_way(core):
    rng = np.random.default_rng(7)
    centers, radii = rng.uniform(-5, 5, (300, 3)), rng.uniform(0.05, 0.4, 300)
    lamps = [
        dict(kind="POINT", matrix=matrix(c), radius=r, strength=(4 * np.pi**2 * r * r,) * 3)  # radiance 1
        for c, r in zip(centers, radii, strict=True)
    ]
    probe = probe_of(core, *lamps)
    position = np.array([8.0, 1, 2])
    directions = sphere_directions(3000)
    offset = centers - position
    along = directions @ offset.T
    miss = np.linalg.norm(offset[None] - along[..., None] * directions[:, None], axis=2)
    expected = ((along > 0) & (miss < radii)).sum(1)
    np.testing.assert_allclose(probe.look(position, directions)[0][:, 0], expected, rtol=1e-5)


def test_a_lamp_of_negative_strength_takes_light_away(core):
    both = probe_of(core, LAMPS["rectangle"], {**LAMPS["rectangle"], "strength": (-POWER / 2,) * 3})
    value, error = irradiance(both.sample(POSITION, random_numbers(40000)))
    alone, own_error = irradiance(probe_of(core, LAMPS["rectangle"]).sample(POSITION, random_numbers(40000)))
    assert abs(value - alone / 2) < 5 * np.hypot(error, own_error)


@pytest.mark.parametrize("kind", ["POINT", "SPOT", "RECTANGLE", "SUN"])
def test_a_lamp_is_chosen_by_what_its_nodes_make_of_its_strength(core, kind):
    """A measured light distribution may be a thousand times as strong as the lamp's own number says."""
    scene = core.SceneDescription()
    look_down(scene)
    away = {"SPOT": {"spot_size": 1.0}, "SUN": {"angle": 0.01}}.get(kind, {})
    scene.add_lamp("weak", kind, matrix((-2, 0, 4)), (1, 1, 1), **away)
    strong = emission(core, strength=1000.0)
    scene.add_lamp("strong", kind, matrix((2, 0, 4)), (1, 1, 1), emission=strong, **away)
    random = np.random.default_rng(3).random((2000, 2)).astype(np.float32)
    chosen = core.LightProbe(scene).sample(np.array([0.0, 0, 0]), random)
    # Half of all choices among suns, and a quarter of those among other lights, do not ask how strong they are.
    least = 0.7 if kind == "SUN" else 0.8
    bright = chosen["radiance"][:, 0] > chosen["radiance"][:, 0].max() / 30
    assert least < bright.mean() < 1
