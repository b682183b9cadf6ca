"""A surface that stands for a thin sheet, of the layers since Blender 5.2: what it reflects and lets through adds up."""

import numpy as np
import pytest
from shading_support import UP, WHITE, albedo, closures, direction, layers, one_point

TINT = np.array((0.9, 0.5, 0.2))


def fresnel(cosine, ior):
    """Reflectance of one side of the sheet, unpolarized."""
    inside = np.sqrt(1 - (1 - cosine**2) / ior**2)
    s, p = (cosine - ior * inside) / (cosine + ior * inside), (inside - ior * cosine) / (inside + ior * cosine)
    return (s * s + p * p) / 2, inside


def shares(cosine, ior):
    """Reflected and passed, by the sum over all reflections inside."""
    r, inside = fresnel(cosine, ior)
    left, back, through, crossing = TINT ** (1 / inside), r, 0.0, 1 - r
    for _ in range(60):
        crossing = crossing * left
        through += crossing * (1 - r)
        crossing = crossing * r * left
        back = back + crossing * (1 - r)
        crossing = crossing * r
    return back, through


def sheet(**values):
    return layers(base_color=tuple(TINT), transmission=1.0, thin_wall=1.0, **values)


@pytest.mark.parametrize("cosine", (1.0, 0.6, 0.2))
@pytest.mark.parametrize("ior", (1.1, 1.5, 2.5))
def test_a_smooth_sheet_shares_light_as_all_reflections_in_it_do(cosine, ior):
    outgoing = direction(cosine)
    program = sheet(roughness=0.0, ior=ior)
    assert program.may_be_transparent
    back, through = shares(cosine, ior)
    # The curve from the reflectance straight on to that at grazing is the dielectric's, at an angle as the layers have it.
    np.testing.assert_allclose(albedo(closures(program, outgoing), outgoing), back, atol=0.002)
    np.testing.assert_allclose(one_point(outgoing).results(program)["transparency"][0], through, atol=0.002)


@pytest.mark.parametrize("roughness", (0.1, 0.4, 0.7, 1.0))
@pytest.mark.parametrize("cosine", (1.0, 0.6))
def test_a_rough_sheet_shares_light_as_a_smooth_one(roughness, cosine):
    outgoing = direction(cosine)
    sample = closures(sheet(roughness=roughness, ior=1.5), outgoing).sample(
        outgoing, UP, np.random.default_rng(5).random((40000, 3), np.float32)
    )
    weights = sample["weight"] * sample["valid"][:, None]
    through = sample["direction"][:, 2] < 0
    back, passed = shares(cosine, 1.5)
    np.testing.assert_allclose((weights * ~through[:, None]).mean(axis=0), back, rtol=0.05)
    np.testing.assert_allclose((weights * through[:, None]).mean(axis=0), passed, rtol=0.02)


def test_light_passes_a_rough_sheet_unbent_on_average():
    outgoing = direction(0.8)
    sample = closures(sheet(roughness=0.3), outgoing).sample(
        outgoing, UP, np.random.default_rng(5).random((20000, 3), np.float32)
    )
    through = sample["valid"] & (sample["direction"][:, 2] < 0)
    mean = sample["direction"][through].mean(axis=0)
    assert through.mean() > 0.8
    np.testing.assert_allclose(mean / np.linalg.norm(mean), -outgoing, atol=0.01)
    assert sample["transmitted"][through].all() and (sample["eta"][through] == 1).all()


def test_light_that_scatters_in_a_sheet_leaves_on_both_sides():
    program = layers(
        base_color=tuple(TINT), specular_level=0.0, subsurface=1.0, subsurface_anisotropy=0.6, thin_wall=1.0
    )
    assert not program.may_be_transparent
    outgoing = direction(0.7)
    lobes = closures(program, outgoing)
    for side, share in ((1, 0.2), (-1, 0.8)):
        incoming = np.float32([[0.6, 0.0, side * 0.8]])
        np.testing.assert_allclose(lobes.evaluate(outgoing, incoming, UP)[0], TINT * share * 0.8 / np.pi, rtol=1e-5)


def test_a_sheet_is_the_same_from_both_sides():
    outgoing = direction(0.6)
    results = [one_point(outgoing, facet * UP, UP).results(sheet(roughness=0.0)) for facet in (1, -1)]
    np.testing.assert_array_equal(*(each["transparency"] for each in results))


def test_white_sheets_lose_nothing():
    outgoing = direction(0.5)
    program = layers(base_color=WHITE, roughness=0.5, transmission=1.0, thin_wall=1.0)
    np.testing.assert_allclose(albedo(closures(program, outgoing), outgoing), 1.0, atol=0.01)
