"""Closures conserve energy, and their samplers, densities and values agree."""

from functools import partial

import numpy as np
import pytest
from rayleaf._core import Program, shading
from shading_support import (
    UP,
    WHITE,
    albedo,
    cell_of,
    chi_square_p_value,
    closures,
    direction,
    integrated,
    layers,
    principled,
    program_with,
    stratified,
)

MICROFACETS = ("GGX", "BECKMANN")
COSINES = (1.0, 0.7, 0.3, 0.08)


def rough_lobes():
    """Named programs of one non-singular lobe each."""
    lobes = {
        "diffuse": program_with("diffuse", [1.0, WHITE]),
        "oren_nayar": program_with("diffuse", [1.0, WHITE, 0.8]),
        "translucent": program_with("translucent", [1.0, WHITE]),
        "sheen": principled(base_color=(0.0, 0.0, 0.0), specular=0.0, sheen=1.0, sheen_tint=0.0),
        "principled_diffuse": principled(base_color=WHITE, specular=0.0, roughness=0.7),
        "clearcoat": principled(base_color=(0.0, 0.0, 0.0), specular=0.0, clearcoat=1.0, clearcoat_roughness=0.5),
        "anisotropic": principled(base_color=WHITE, metallic=1.0, roughness=0.6, anisotropic=0.8),
        "rough_keeping_energy": program_with("diffuse", [1.0, WHITE, 0.8, None], ints=[1]),
        "microfibres": program_with("microfibres", [1.0, WHITE, 0.4, None]),
        "microfibres_smooth": program_with("microfibres", [1.0, WHITE, 0.25, None]),
        "layers": layers(metallic=0.2, coat=1.0, coat_roughness=0.4, sheen=0.7, transmission=0.4),
        "metal": layers("GGX", base_color=(1.0, 0.7, 0.2), metallic=1.0, specular_tint=(0.3, 0.6, 1.0)),
        "sheet": layers(base_color=WHITE, roughness=0.7, transmission=1.0, thin_wall=1.0),
        "scattering_sheet": layers(subsurface=0.7, subsurface_anisotropy=0.4, transmission=0.3, thin_wall=1.0),
        "tinted_glass": principled(base_color=(0.9, 0.5, 0.1), specular_tint=0.6, roughness=0.6, transmission=1.0),
        "glass_of_two_roughnesses": principled(roughness=0.5, transmission=1.0, transmission_roughness=0.5),
        "glass_with_tinted_reflection": layers(
            base_color=(0.9, 0.5, 0.1), specular_tint=(0.2, 1.0, 0.6), roughness=0.6, transmission=1.0
        ),
        "toon_in_front": program_with("toon", [1.0, WHITE, 0.8, 0.4, None], "GLOSSY", ints=[1]),
        "principled": principled(metallic=0.3, clearcoat=1.0, clearcoat_roughness=0.4, sheen=0.5, transmission=0.4),
    }
    for text in MICROFACETS:
        for roughness in (0.25, 0.5, 1.0):
            lobes[f"glossy_{text}_{roughness}"] = program_with("glossy", [1.0, WHITE, roughness], text)
            for ior in (1.45, 1 / 1.45):
                operands = [1.0, WHITE, roughness, ior]
                lobes[f"refraction_{text}_{roughness}_{ior:.2f}"] = program_with("refraction", operands, text)
                lobes[f"glass_{text}_{roughness}_{ior:.2f}"] = program_with("glass", operands, text)
        lobes[f"glossy_{text}_joint"] = program_with("glossy", [1.0, WHITE, 0.9], text, ints=[1])
        lobes[f"refraction_{text}_joint"] = program_with("refraction", [1.0, WHITE, 0.9, 1.45], text, ints=[1])
        lobes[f"glass_{text}_at_normal"] = program_with("glass", [1.0, WHITE, 0.9, 1.45], text, ints=[0, 1])
        lobes[f"glass_{text}_joint"] = program_with("glass", [1.0, WHITE, 0.9, 1.45], text, ints=[1])
    return lobes


ROUGH = rough_lobes()


@pytest.mark.slow
@pytest.mark.parametrize("cosine", COSINES)
@pytest.mark.parametrize("name", ROUGH)
def test_the_sampler_matches_its_density(name, cosine):
    outgoing = direction(cosine)
    lobes = closures(ROUGH[name], outgoing)
    rows, columns, count = 24, 48, 160
    sample = lobes.sample(outgoing, UP, np.random.default_rng(7).random((count**2, 3), np.float32))
    observed = np.bincount(cell_of(sample["direction"][sample["valid"]], rows, columns), minlength=rows * columns)
    expected = integrated(lambda points: lobes.density(outgoing, points, UP), rows, columns) * count**2
    assert expected.sum() <= count**2 * 1.005, "a density integrates to at most 1"
    assert observed.sum() == pytest.approx(expected.sum(), abs=5 * count), "samples fail as often as the density says"
    p = chi_square_p_value(observed.astype(float), expected)
    assert p > 1e-5, f"{name} at cosine {cosine}: p = {p}"


@pytest.mark.parametrize("name", ROUGH)
def test_a_samples_weight_is_value_over_density(name):
    outgoing = direction(0.8)
    lobes = closures(ROUGH[name], outgoing)
    sample = lobes.sample(outgoing, UP, stratified(40))
    valid = sample["valid"]
    assert valid.sum() > 100
    value = lobes.evaluate(outgoing, sample["direction"][valid], UP)
    density = lobes.density(outgoing, sample["direction"][valid], UP)
    np.testing.assert_allclose(sample["density"][valid], density, rtol=1e-6)
    np.testing.assert_allclose(sample["weight"][valid] * density[:, None], value, rtol=1e-5, atol=1e-9)
    below = sample["direction"][valid][:, 2] < 0
    np.testing.assert_array_equal(sample["transmitted"][valid], below)


@pytest.mark.parametrize("cosine", COSINES)
@pytest.mark.parametrize("name", ROUGH)
def test_no_lobe_makes_light(name, cosine):
    outgoing = direction(cosine)
    share = albedo(closures(ROUGH[name], outgoing), outgoing)
    limit = 1.0
    if name in ("principled", "principled_diffuse"):
        limit = 1.35  # Disney's sum of diffuse, retro-reflection and coats is not bounded by 1 at grazing angles
    assert (share <= limit + 0.01).all(), share


@pytest.mark.parametrize("cosine", COSINES)
@pytest.mark.parametrize("name", ["diffuse", "translucent"])
def test_white_lambert_scatters_all_light(name, cosine):
    outgoing = direction(cosine)
    np.testing.assert_allclose(albedo(closures(ROUGH[name], outgoing), outgoing), 1.0, atol=1e-5)


@pytest.mark.parametrize("operation", ["glossy", "refraction", "glass"])
def test_joint_masking_is_that_of_heitz(operation):
    """One over 1 + a + b instead of (1 + a) (1 + b), of Smith's integrals (Heitz 2014, section 6.2): of GGX facets here."""
    outgoing, alpha2 = direction(0.3), 0.9**4
    incoming = np.array([[0.5, 0.1, 0.4], [-0.9, 0.3, 0.2], [-0.6, 0.1, -0.7]])
    incoming /= np.linalg.norm(incoming, axis=1)[:, None]
    operands = [1.0, WHITE, 0.9, 1.45][: 3 if operation == "glossy" else 4]
    separate, joint = (
        closures(program_with(operation, operands, "GGX", ints=ints), outgoing).evaluate(outgoing, incoming, UP)
        for ints in ([], [1])
    )
    hidden = [(np.sqrt(1 + alpha2 * (1 / z**2 - 1)) - 1) / 2 for z in (0.3, incoming[:, 2])]
    ratio = (1 + hidden[0]) * (1 + hidden[1]) / (1 + hidden[0] + hidden[1])
    seen = separate[:, 0] > 0
    assert seen.any()
    np.testing.assert_allclose(joint[seen, 0] / separate[seen, 0], ratio[seen], rtol=1e-5)


def test_glass_may_reflect_the_share_of_the_smooth_surface():
    """All of reflection and refraction is then that of rough mirrors and of rough refraction, times that share."""
    outgoing = direction(0.3)
    mirror, bent, glass = (
        closures(program_with(operation, [1.0, WHITE, 0.6, 1.45][:count], "GGX", ints=ints), outgoing)
        for operation, count, ints in (("glossy", 3, []), ("refraction", 4, []), ("glass", 4, [0, 1]))
    )
    smooth = closures(program_with("glass", [1.0, WHITE, 0.0, 1.45], "SHARP"), outgoing)
    share = smooth.albedo(outgoing, shading.LobeKind.GLOSSY)[0]
    assert 0.1 < share < 0.4
    incoming = np.array([[-0.8, -0.3, 0.4], [-0.5, 0.1, 0.8], [-0.6, -0.1, -0.7], [-0.6, -0.3, -0.6]])
    incoming /= np.linalg.norm(incoming, axis=1)[:, None]
    of_all = share * mirror.evaluate(outgoing, incoming, UP) + (1 - share) * bent.evaluate(outgoing, incoming, UP)
    assert (of_all > 0).all()
    np.testing.assert_allclose(glass.evaluate(outgoing, incoming, UP), of_all, rtol=1e-4)


@pytest.mark.parametrize("masking", [[], [1]])
@pytest.mark.parametrize("roughness", (0.2, 0.4, 0.6, 0.8, 1.0))
@pytest.mark.parametrize("cosine", (1.0, 0.6, 0.3, 0.1))
def test_compensated_reflection_gives_back_all_light(roughness, cosine, masking):
    outgoing = direction(cosine)
    program = program_with("glossy", [1.0, WHITE, roughness], "MULTI_GGX", ints=masking)
    share = albedo(closures(program, outgoing), outgoing)
    np.testing.assert_allclose(share, 1.0, atol=0.01)


@pytest.mark.parametrize("roughness", (0.3, 1.0))
@pytest.mark.parametrize("cosine", COSINES)
def test_a_rough_white_surface_that_keeps_its_energy_scatters_all_light(roughness, cosine):
    outgoing = direction(cosine)
    share = albedo(closures(program_with("diffuse", [1.0, WHITE, roughness, None], ints=[1]), outgoing), outgoing)
    np.testing.assert_allclose(share, 1.0, atol=0.02)


@pytest.mark.parametrize("roughness", (0.2, 0.6, 1.0))
@pytest.mark.parametrize("cosine", (1.0, 0.6, 0.3))
@pytest.mark.parametrize("more", ({}, {"metallic": 1.0}, {"transmission": 1.0}, {"sheen": 1.0}))
def test_white_layers_lose_little_light_and_make_none(roughness, cosine, more):
    outgoing = direction(cosine)
    share = albedo(closures(layers(base_color=WHITE, roughness=roughness, **more), outgoing), outgoing)
    # What a layer lets through on the way in is dimmed by the viewer's angle alone.
    assert (share > 0.9).all() and (share < 1.03).all(), share


def test_a_coat_dims_emission_by_what_it_reflects_and_tints_it_by_the_way_through_it():
    tint, cosine, ior = np.array((0.5, 0.8, 1.0)), 0.4, 1.6
    outgoing = direction(cosine)
    program = layers(emission_color=WHITE, coat=1.0, coat_ior=ior, coat_tint=tuple(tint))
    point = shading.surface_points(np.zeros((1, 3), np.float32), UP[None], outgoing[None])
    inside = np.sqrt(1 - (1 - cosine**2) / ior**2)
    s, p = (cosine - ior * inside) / (cosine + ior * inside), (inside - ior * cosine) / (inside + ior * cosine)
    np.testing.assert_allclose(
        point.results(program)["emission"][0], (1 - (s * s + p * p) / 2) * tint ** (1 / inside), rtol=1e-5
    )


def test_the_tint_of_a_metal_is_its_reflectance_near_82_degrees():
    color, tint = np.array((0.9, 0.6, 0.3)), np.array((0.2, 0.5, 1.0))
    outgoing = direction(1 / 7, 0.0)
    metal = layers("GGX", base_color=tuple(color), metallic=1.0, roughness=0.0, specular_tint=tuple(tint))
    sample = closures(metal, outgoing).sample(outgoing, UP, np.float32([[0.3, 0.4, 0.5]]))
    np.testing.assert_allclose(sample["weight"][0], tint * (color + (1 - color) * (6 / 7) ** 5), rtol=1e-5)


@pytest.mark.parametrize("roughness", (0.3, 0.6, 1.0))
@pytest.mark.parametrize("ior", (1.3, 1.5, 2.4, 1 / 1.5))
@pytest.mark.parametrize("cosine", (1.0, 0.5, 0.15))
def test_compensated_glass_loses_nothing(roughness, ior, cosine):
    outgoing = direction(cosine)
    program = program_with("glass", [1.0, WHITE, roughness, ior], "MULTI_GGX")
    np.testing.assert_allclose(albedo(closures(program, outgoing), outgoing), 1.0, atol=0.015)


@pytest.mark.parametrize("cosine", (0.9, 0.75, 0.7, 0.3))
@pytest.mark.parametrize("ior", (1.45, 1 / 1.45))
@pytest.mark.parametrize("shader", (principled, partial(layers, "GGX")))
def test_no_sample_of_rough_glass_weighs_more_than_its_light(shader, ior, cosine):
    """Also near the angle of total reflection, where some facets reflect all light and others hardly any."""
    outgoing = direction(cosine)
    program = shader(base_color=WHITE, roughness=0.6, transmission=1.0, ior=ior)
    sample = closures(program, outgoing).sample(outgoing, UP, stratified(40))
    assert sample["weight"][sample["valid"]].max() < 1.0 + 1e-4


@pytest.mark.parametrize("ior", (1.0, 1 + 1e-6, 1 - 1e-6, 0.7, 1.33, 10.0))
@pytest.mark.parametrize("cosine", (1.0, 0.5, 0.05, 1e-3))
def test_smooth_glass_loses_nothing(ior, cosine):
    outgoing = direction(cosine)
    lobes = closures(program_with("glass", [1.0, WHITE, 0.0, ior], "SHARP"), outgoing)
    sample = lobes.sample(outgoing, UP, stratified(16))
    assert sample["valid"].all() and sample["singular"].all()
    np.testing.assert_allclose(sample["weight"], 1.0, atol=1e-5)
    if abs(ior - 1) < 1e-5 and sample["transmitted"].any():
        assert abs(sample["direction"][sample["transmitted"]] + outgoing).max() < 2e-3


def test_a_clear_interface_passes_light_unbent():
    outgoing = direction(0.4)
    sample = closures(program_with("glass", [1.0, WHITE, 0.7, 1.0], "GGX"), outgoing).sample(
        outgoing, UP, stratified(8)
    )
    assert sample["valid"].all() and sample["transmitted"].all()
    np.testing.assert_allclose(sample["direction"], np.tile(-outgoing, (64, 1)), atol=1e-6)


def test_a_mirror_reflects_everything_to_the_mirror_direction():
    outgoing = direction(0.3, 0.0)
    lobes = closures(program_with("glossy", [1.0, (0.9, 0.5, 0.1), 0.0], "GGX"), outgoing)
    sample = lobes.sample(outgoing, UP, np.float32([[0.3, 0.4, 0.5]]))
    np.testing.assert_allclose(sample["direction"][0], outgoing * (-1, -1, 1), atol=1e-6)
    np.testing.assert_allclose(sample["weight"][0], (0.9, 0.5, 0.1), rtol=1e-6)
    assert not lobes.has_smooth_lobes() and sample["density"][0] == 0
    assert (lobes.evaluate(outgoing, sample["direction"], UP) == 0).all()


@pytest.mark.parametrize("cosine", (0.9, 0.5, 0.2))
def test_smooth_refraction_follows_snell_and_fresnel(cosine):
    ior = 1.5
    outgoing = direction(cosine, 0.0)
    sample = closures(program_with("glass", [1.0, WHITE, 0.0, ior], "SHARP"), outgoing).sample(
        outgoing, UP, stratified(64)
    )
    through = sample["transmitted"]
    sine = np.sqrt(1 - cosine**2)
    np.testing.assert_allclose(sample["direction"][through][:, 0], -sine / ior, atol=1e-6)
    np.testing.assert_allclose(sample["eta"][through], 1 / ior, rtol=1e-6)
    cos_t = np.sqrt(1 - (sine / ior) ** 2)
    s, p = (cosine - ior * cos_t) / (cosine + ior * cos_t), (cos_t - ior * cosine) / (cos_t + ior * cosine)
    assert abs((~through).mean() - (s * s + p * p) / 2) < 0.015  # 4096 draws
    kinds = set(sample["kind"][through]), set(sample["kind"][~through])
    assert kinds == ({2}, {1})


def test_light_inside_glass_is_totally_reflected_beyond_the_critical_angle():
    outgoing = -direction(0.3)  # the critical cosine of 1.5 is 0.745
    sample = closures(program_with("glass", [1.0, WHITE, 0.0, 1.5], "SHARP"), outgoing).sample(
        outgoing, UP, stratified(8)
    )
    assert sample["valid"].all() and not sample["transmitted"].any()
    refraction = closures(program_with("refraction", [1.0, WHITE, 0.0, 1.5], "SHARP"), outgoing)
    assert not refraction.sample(outgoing, UP, stratified(8))["valid"].any()


def test_the_index_turns_over_for_a_viewer_inside():
    inside, outside = -direction(0.9, 0.0), direction(0.9, 0.0)
    program = program_with("refraction", [1.0, WHITE, 0.0, 1.5], "SHARP")
    down = closures(program, outside).sample(outside, UP, stratified(1))
    up = closures(program, inside).sample(inside, UP, stratified(1))
    sine = np.sqrt(1 - 0.81)
    np.testing.assert_allclose(abs(down["direction"][0, 0]), sine / 1.5, rtol=1e-5)
    np.testing.assert_allclose(abs(up["direction"][0, 0]), sine * 1.5, rtol=1e-5)
    assert up["direction"][0, 2] > 0 > down["direction"][0, 2]


@pytest.mark.parametrize(
    "name",
    ["diffuse", "sheen", "principled_diffuse", "clearcoat", "anisotropic", "glossy_GGX_0.5", "glossy_BECKMANN_0.5"],
)
def test_reflection_is_reciprocal(name):
    random = np.random.default_rng(3)
    for _ in range(50):
        a, b = (direction(float(random.uniform(0.05, 1)), float(random.uniform(0, 6.28))) for _ in range(2))
        forward = closures(ROUGH[name], a).evaluate(a, b[None], UP)[0] / b[2]
        back = closures(ROUGH[name], b).evaluate(b, a[None], UP)[0] / a[2]
        np.testing.assert_allclose(forward, back, rtol=2e-3, atol=1e-7, err_msg=f"{a} {b}")


def test_no_light_leaks_through_a_bent_normal():
    outgoing, bent = direction(0.3, 0.0), direction(0.5, 1.0)
    below = -direction(0.2, 1.0)
    for name in ("diffuse", "glossy_GGX_0.5", "anisotropic"):
        lobes = closures(ROUGH[name], outgoing, normal=bent)
        assert (lobes.evaluate(outgoing, below[None], UP) == 0).all()
        sample = lobes.sample(outgoing, UP, stratified(32))
        assert (sample["direction"][sample["valid"]][:, 2] > 0).all()


@pytest.mark.parametrize("tilt", (0.1, 0.5, 0.9, 1.3))
def test_a_mirror_with_a_bent_normal_never_goes_black(tilt):
    normal = np.float32((np.sin(tilt), 0, np.cos(tilt)))
    for cosine in (0.9, 0.4, 0.05):
        for azimuth in np.linspace(0, 2 * np.pi, 9):
            outgoing = direction(cosine, float(azimuth))
            sample = closures(program_with("glossy", [1.0, WHITE, 0.0], "SHARP"), outgoing, normal=normal).sample(
                outgoing, UP, np.float32([[0.5, 0.5, 0.5]])
            )
            assert sample["valid"][0] and sample["direction"][0, 2] > 0, (tilt, cosine, azimuth)


def test_evaluation_by_kind_adds_up():
    outgoing = direction(0.6)
    lobes = closures(ROUGH["principled"], outgoing)
    incoming = np.random.default_rng(1).normal(size=(200, 3))
    incoming = (incoming / np.linalg.norm(incoming, axis=1)[:, None]).astype(np.float32)
    from rayleaf import _core

    kinds = [_core.shading.LobeKind.DIFFUSE, _core.shading.LobeKind.GLOSSY, _core.shading.LobeKind.TRANSMISSION]
    parts = sum(lobes.evaluate(outgoing, incoming, UP, kind) for kind in kinds)
    np.testing.assert_allclose(parts, lobes.evaluate(outgoing, incoming, UP), rtol=1e-5, atol=1e-8)
    assert all(max(lobes.albedo(outgoing, kind)) > 0 for kind in kinds)


def test_velvet_is_glossy_light_of_diffuse_rays():
    outgoing, kinds = direction(0.6), shading.LobeKind
    lobes = closures(program_with("velvet", [1.0, WHITE, 0.4]), outgoing)
    sample = lobes.sample(outgoing, UP, stratified(8))
    incoming = sample["direction"][sample["valid"]]
    whole = lobes.evaluate(outgoing, incoming, UP)
    np.testing.assert_array_equal(lobes.evaluate(outgoing, incoming, UP, kinds.GLOSSY), whole)
    assert whole.max() > 0 and max(lobes.albedo(outgoing, kinds.DIFFUSE)) == 0
    assert (sample["kind"][sample["valid"]] == int(kinds.DIFFUSE)).all()


def many_lobes(count, mirror):
    """Diffuse lobes of different roughness, a hundredth each; perhaps a mirror comes last."""
    program = Program("many")
    one = program.constant(1, 1, 1, 1)
    for i in range(count):
        share, roughness = (program.constant(x, x, x, x) for x in (0.01, i / count))
        program.operation("diffuse", [share, one, roughness])
    if mirror:
        half = program.constant(0.5, 0.5, 0.5, 0.5)
        program.operation("glossy", [half, one, program.constant(0, 0, 0, 0)], text="SHARP")
    return closures(program, UP)


@pytest.mark.parametrize("count", [16, 17, 40])
def test_lobes_beyond_the_most_join_those_of_their_type(count):
    lobes = many_lobes(count, True)
    np.testing.assert_allclose(lobes.albedo(UP, shading.LobeKind.GLOSSY), [0.5] * 3, rtol=1e-5)
    diffuse = many_lobes(16, False).albedo(UP, shading.LobeKind.DIFFUSE)[0] / 16
    np.testing.assert_allclose(lobes.albedo(UP, shading.LobeKind.DIFFUSE), [count * diffuse] * 3, rtol=0.05)
    random = np.random.default_rng(1).random((4000, 3)).astype(np.float32)
    found = lobes.sample(UP, UP, random)
    mirrored = found["singular"] & found["valid"]
    np.testing.assert_allclose(found["direction"][mirrored], np.tile(UP, (mirrored.sum(), 1)), atol=1e-6)
    assert 0.5 < mirrored.mean() + 0.01 * count < 1.5


def test_lobes_that_differ_in_weight_alone_are_one():
    program = Program("twice")
    one = program.constant(1, 1, 1, 1)
    for _ in range(40):
        share = program.constant(0.01, 0.01, 0.01, 0.01)
        program.operation("diffuse", [share, one])
    lobes = closures(program, UP)
    assert len(lobes) == 1
    np.testing.assert_allclose(lobes.albedo(UP, shading.LobeKind.DIFFUSE), [0.4] * 3, rtol=1e-5)
