"""White rough surfaces that give back what single scattering loses."""

import pytest

from shading_support import albedo, closures, direction, principled, program_with

WHITE = (1.0, 1.0, 1.0)


@pytest.mark.parametrize("cosine", [1.0, 0.3, 0.05])
@pytest.mark.parametrize("roughness", [0.3, 1.0])
@pytest.mark.parametrize("ior", [1.0, 1.0005])
def test_glass_of_an_index_near_one_loses_nothing_and_gains_nothing(ior, roughness, cosine):
    outgoing = direction(cosine)
    glass = program_with("glass", [1.0, WHITE, roughness, ior], "MULTI_GGX")
    both = principled(
        "MULTI_GGX",
        base_color=WHITE,
        transmission=1.0,
        ior=ior,
        roughness=roughness,
        transmission_roughness=roughness,
    )
    for program in (glass, both):
        assert albedo(closures(program, outgoing), outgoing)[0] == pytest.approx(1.0, abs=0.04)


@pytest.mark.parametrize("cosine", [1.0, 0.5, 0.1])
@pytest.mark.parametrize("roughness, anisotropy", [(0.5, -0.9), (0.5, 0.9), (0.8, -0.5), (1.0, 0.5)])
def test_anisotropic_facets_keep_about_all_light(roughness, anisotropy, cosine):
    """The tables know even facets alone: within a tenth."""
    outgoing = direction(cosine)
    program = program_with("glossy", [1.0, WHITE, roughness, None, anisotropy, 0.0, None], "MULTI_GGX")
    assert albedo(closures(program, outgoing), outgoing)[0] == pytest.approx(1.0, abs=0.1)
