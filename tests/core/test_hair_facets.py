"""Hair of rough facets: what is sampled and what is evaluated are the same light, and little of it is lost."""

import numpy as np
import pytest
from path_scenes import material, picture
from rayleaf import _core
from scenes import background, look_down, matrix, quad
from shading_support import UP, WHITE, program_with, stratified

NOTHING = (0.0, 0.0, 0.0)
DEFAULTS = {
    **{"weight": 1.0, "absorption": NOTHING, "melanin": 0.0, "redness": 0.0, "tint": WHITE, "roughness": 0.3},
    **{"ior": 1.55, "offset": 0.0, "random": 0.5, "random_color": 0.0, "random_roughness": 0.0, "ratio": 1.0},
    **{"reflected": 1.0, "passed": 1.0, "returned": 1.0, "axis": None, "thickness": 0.0},
}
ALL_BUT_CAMERA = 30


def facets(**values):
    """Operands of hair_facets."""
    return list({**DEFAULTS, **values}.values())


def hair(**values):
    """The closures of a fibre along x, seen from above and somewhat along it, met off its middle."""
    return on_mesh(program_with("hair_facets", facets(**values), "ABSORPTION"))


def viewer(along=0.4):
    return np.float32((along, 0.0, np.sqrt(1.0 - along * along)))


def on_mesh(program, along=0.4, across=0.0):
    outgoing = viewer(along)
    normal = np.float32((0.0, across, np.sqrt(1.0 - across * across)))
    rows = [np.float32(v).reshape(1, 3) for v in (normal, outgoing, UP)]
    point = _core.shading.surface_points(
        np.zeros((1, 3), np.float32),
        rows[0],
        rows[1],
        facet_normal=rows[2],
        dp_du=np.float32([[1, 0, 0]]),
        dp_dv=np.float32([[0, 1, 0]]),
    )
    return point.closures(program, 0)


def sphere(side):
    """side² directions, stratified over the sphere."""
    u = stratified(side, seed=3)
    z, turn = 2.0 * u[:, 0] - 1.0, 2.0 * np.pi * u[:, 1]
    sine = np.sqrt(np.maximum(1.0 - z * z, 0.0))
    return np.stack([sine * np.cos(turn), sine * np.sin(turn), z], -1).astype(np.float32)


def lights(directions):
    """Soft lights from several sides, (n, 7): what they send from those directions."""
    sides = np.float32([(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)])
    return np.concatenate([np.ones((len(directions), 1)), np.clip(directions @ sides.T, 0, None) ** 4], 1)


def sampled(lobes, side=256):
    """Mean light that arrives from each of the lights by sampled directions, (7, 3)."""
    sample = lobes.sample(viewer(), UP, stratified(side))
    weight = np.where(sample["valid"][:, None], sample["weight"], 0.0)
    assert np.isfinite(weight).all()
    return np.einsum("nl,nc->lc", lights(sample["direction"]), weight.astype(np.float64)) / side**2


def evaluated(lobes, side=384):
    """The same by values in all directions."""
    directions = sphere(side)
    value = lobes.evaluate(viewer(), directions, UP).astype(np.float64)
    assert np.isfinite(value).all() and (value >= 0.0).all()
    return np.einsum("nl,nc->lc", lights(directions), value) * (4.0 * np.pi / side**2)


@pytest.mark.parametrize(
    "values",
    [
        {},
        {"roughness": 0.1},
        {"roughness": 0.9},
        {"absorption": (0.1, 0.5, 2.0)},
        {"offset": 0.3},
        {"ior": 1.2},
        {"passed": 0.0, "returned": 0.0},
        {"reflected": 0.0, "returned": 0.0},
        {"reflected": 0.0, "passed": 0.0},
    ],
    ids=str,
)
def test_samples_and_values_are_the_same_light(values):
    lobes = hair(**values)
    by_samples, by_values = sampled(lobes), evaluated(lobes)
    assert by_samples.max() > 0.01
    np.testing.assert_allclose(by_samples, by_values, rtol=0.03, atol=0.006 * by_samples.max())


@pytest.mark.parametrize("roughness", [0.1, 0.3, 0.6])
@pytest.mark.parametrize("along", [0.0, 0.6])
def test_a_clear_fibre_scatters_nearly_all_light(roughness, along):
    lobes = on_mesh(program_with("hair_facets", facets(roughness=roughness), "ABSORPTION"), along)
    sample = lobes.sample(viewer(along), UP, stratified(256))
    share = np.where(sample["valid"], sample["weight"][:, 0], 0.0).mean()
    # What is reflected inside more often is a series of mean factors, and each facet gives back what it would lose alone.
    assert 0.99 < share < 1.06


def test_absorption_colours_what_passes_and_not_what_is_reflected():
    whole, black = sampled(hair(absorption=(0.0, 0.5, 2.0)))[0], sampled(hair(absorption=(1e3, 1e3, 1e3)))[0]
    assert whole[0] > 1.3 * whole[1] > 1.3 * 1.3 * whole[2]
    assert 0.04 < black[0] == black[1] == black[2] < 0.08


def test_a_fibre_beside_a_diffuse_lobe_adds_up():
    program = program_with("hair_facets", facets(weight=0.6), "ABSORPTION")
    half, color = program.constant(0.4, 0.4, 0.4, 1.0), program.constant(0.9, 0.5, 0.2, 1.0)
    program.operation("diffuse", [half, color], [])
    lobes = on_mesh(program)
    np.testing.assert_allclose(sampled(lobes), evaluated(lobes), rtol=0.03, atol=0.004)
    value, density = lobes.evaluate(viewer(), sphere(8), UP), lobes.density(viewer(), sphere(8), UP)
    assert (density > 0.0).all() and (value[sphere(8)[:, 2] < 0.0] > 0.0).any()


def test_a_value_is_the_same_each_time():
    directions = sphere(16)
    first, second = (hair(absorption=(0.1, 0.5, 2.0)).evaluate(viewer(), directions, UP) for _ in range(2))
    np.testing.assert_array_equal(first, second)


def test_what_no_light_takes_scatters_nothing():
    lobes = hair(reflected=0.0, passed=0.0, returned=0.0)
    assert not lobes.evaluate(viewer(), sphere(8), UP).any()


@pytest.mark.parametrize(
    "values",
    [
        {"roughness": -1.0},
        {"roughness": 0.0},
        {"roughness": 50.0},
        {"ior": 0.0},
        {"ior": 1.0},
        {"ior": 1e6},
        {"offset": 1.6},
        {"offset": 1e30},
        {"absorption": (1e38, -1e38, -1.0)},
        {"absorption": (1e30, 0.0, 1e-30)},
        {"ratio": -3e38},
        {"random_roughness": 3e38, "random": 3e38},
    ],
    ids=str,
)
def test_no_number_makes_values_that_are_not_finite(values):
    lobes = hair(**values)
    assert np.isfinite(lobes.evaluate(viewer(), sphere(24), UP)).all()
    sample = lobes.sample(viewer(), UP, stratified(24))
    assert np.isfinite(sample["weight"][sample["valid"]]).all()


def covered(ratio, axis, form="ROUND", **values):
    """Share of a bright background that a thick black fibre along x hides, seen from above."""
    scene = _core.SceneDescription()
    black = facets(absorption=(1e4, 1e4, 1e4), reflected=0.0, ratio=ratio, axis=axis, **values)
    points, radii = np.float64([(-9, 0, 0), (-3, 0, 0), (3, 0, 0), (9, 0, 0)]), np.full(4, 0.5, np.float32)
    strand = _core.Strands("hair", points, radii, np.int32([0, 4]), basis="LINEAR", form=form)
    scene.add_instance(
        "hair", scene.add_shape(strand), matrix(), material(_core, scene, ("hair_facets", *black, "ABSORPTION"))
    )
    scene.set_world(background(_core))
    look_down(scene, 100.0, 0.01)
    return 1.0 - picture(_core, scene, size=16, samples=64).mean()


@pytest.mark.parametrize("form", ["ROUND", "RIBBON"])
@pytest.mark.parametrize(
    ("ratio", "axis", "share"),
    [(1.0, (0, 1, 0), 1.0), (0.4, (0, 1, 0), 1.0), (0.4, (0, 0, 1), 0.4), (2.5, (0, 0, 1), 0.4)],
)
def test_a_flat_fibre_covers_what_its_cross_section_does(ratio, axis, share, form):
    # Half of what the camera sees, which the round strand covers.
    assert covered(ratio, axis, form) == pytest.approx(0.5 * share, abs=0.02)


def test_a_flat_fibre_casts_the_shadow_of_its_cross_section():
    def shadow(axis):
        scene = _core.SceneDescription()
        black = facets(absorption=(1e4, 1e4, 1e4), reflected=0.0, ratio=0.4, axis=axis)
        points, radii = np.float64([(-9, 0, 3), (-3, 0, 3), (3, 0, 3), (9, 0, 3)]), np.full(4, 0.5, np.float32)
        strand = _core.Strands("hair", points, radii, np.int32([0, 4]), basis="LINEAR")
        hair = material(_core, scene, ("hair_facets", *black, "ABSORPTION"), name="hair")
        scene.add_instance("hair", scene.add_shape(strand), matrix(), hair, visibility=ALL_BUT_CAMERA)
        scene.add_instance("plane", quad(scene, "plane", 3.0), matrix(), material(_core, scene, ("diffuse", 1.0, 0.5)))
        scene.add_lamp("sun", "SUN", matrix((0, 0, 9)), (1.0, 1.0, 1.0))
        look_down(scene, 100.0, 0.01)
        return picture(_core, scene, size=16, samples=64, max_bounces=0).mean()

    assert shadow((0, 1, 0)) == pytest.approx(shadow((0, 0, 1)) * 0.5 / 0.8, rel=0.03)


def test_up_close_a_fibre_is_lit_from_one_side():
    def side_lit(thickness):
        scene = _core.SceneDescription()
        grey = facets(absorption=(0.3, 0.3, 0.3), thickness=thickness, axis=(0, 1, 0))
        points, radii = np.float64([(-9, 0, 0), (-3, 0, 0), (3, 0, 0), (9, 0, 0)]), np.full(4, 0.5, np.float32)
        strand = _core.Strands("hair", points, radii, np.int32([0, 4]), basis="LINEAR", has_inside=False)
        hair = material(_core, scene, ("hair_facets", *grey, "ABSORPTION"))
        scene.add_instance("hair", scene.add_shape(strand), matrix(), hair)
        scene.add_lamp("sun", "SUN", from_side, (1.0, 1.0, 1.0), angle=0.2)
        look_down(scene, 100.0, 0.005)
        return picture(_core, scene, size=16, samples=256)[..., 0].mean(axis=1)

    from_side = np.float64([[1, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]])  # its z towards -y
    near, far = side_lit(1.0), side_lit(0.0)
    assert far.std() < 0.05 * far.mean()
    assert near.std() > 0.5 * near.mean()
    assert near.mean() == pytest.approx(far.mean(), rel=0.1)
