"""Materials whose closures differ by the way they face alone get them from a table, to the bit what a run gives."""

import numpy as np
import pytest
from shading_support import UP, WHITE, closures, direction, layers, one_point, principled, program_with, stratified

PLAIN = {
    "diffuse": lambda: program_with("diffuse", [0.7, (0.8, 0.4, 0.1), 0.3]),
    "translucent": lambda: program_with("translucent", [1.0, WHITE]),
    "velvet": lambda: program_with("velvet", [1.0, WHITE, 0.4]),
    "toon": lambda: program_with("toon", [1.0, WHITE, 0.5, 0.2], "GLOSSY"),
    "glossy": lambda: program_with("glossy", [1.0, WHITE, 0.4], "GGX"),
    "glossy, compensated": lambda: program_with("glossy", [1.0, (0.9, 0.5, 0.1), 0.8], "MULTI_GGX"),
    "glossy, stretched": lambda: program_with("glossy", [1.0, WHITE, 0.4, None, 0.7, 0.1], "GGX"),
    "refraction": lambda: program_with("refraction", [1.0, WHITE, 0.2, 1.45], "BECKMANN"),
    "glass": lambda: program_with("glass", [1.0, WHITE, 0.3, 1.45], "GGX"),
    "glass, compensated": lambda: program_with("glass", [1.0, WHITE, 0.7, 1.45], "MULTI_GGX"),
    "subsurface": lambda: program_with("subsurface", [1.0, WHITE, 0.5, (1.0, 0.4, 0.2), 1.4, 0.0]),
    "subsurface, refracted": lambda: program_with(
        "subsurface", [1.0, WHITE, 0.5, (1.0, 0.4, 0.2), 1.4, 0.0, None, 0.5], ints=[1, 1, 1]
    ),
    "microfibres": lambda: program_with("microfibres", [1.0, WHITE, 0.4, None]),
    "transparent": lambda: program_with("transparent", [0.5, (0.2, 0.9, 0.4)]),
    "emission": lambda: program_with("emission", [1.0, WHITE, 3.0]),
    "bent": lambda: program_with("diffuse", [1.0, WHITE, 0.3, (0.3, 0.1, 0.9)]),
    "bent, shadowed by facets": lambda: program_with(
        "diffuse", [1.0, WHITE, 0.3, (0.3, 0.1, 0.9)], bump_shadow="FACETS"
    ),
    **{
        f"{identifier}, {clearing}": lambda identifier=identifier, operands=operands, clearing=clearing: program_with(
            identifier, operands, "GGX" * (identifier == "glass"), clearing=clearing
        )
        for clearing in ("MIRRORS", "NONE")
        for identifier, operands in (
            ("diffuse", [0.7, (0.8, 0.4, 0.1), 0.3]),
            ("glass", [1.0, WHITE, 0.3, 1.45]),
            ("subsurface", [1.0, WHITE, 0.5, (1.0, 0.0, 0.2), 1.4, 0.0]),
        )
    },
    "principled": lambda: principled(metallic=0.3, clearcoat=1.0, sheen=0.5, transmission=0.4, alpha=0.8),
    "principled, compensated": lambda: principled("MULTI_GGX", metallic=0.3, roughness=0.8, transmission=0.4),
    "principled, stretched": lambda: principled(metallic=1.0, roughness=0.6, anisotropic=0.8),
    "principled, bent": lambda: principled(metallic=1.0, normal=(0.2, 0.3, 0.9)),
    "layers": lambda: layers(metallic=0.2, coat=1.0, sheen=0.7, transmission=0.4),
}


def that_reads(program):
    """The same, but it reads what no closure needs, so that it is run at every point."""
    program.operation("position")
    return program


@pytest.mark.parametrize("cosine", [1.0, 0.6, 0.02, -0.5])
@pytest.mark.parametrize("name", PLAIN)
def test_a_point_gets_to_the_bit_the_closures_of_a_run(name, cosine):
    outgoing = direction(cosine)
    random = np.random.default_rng(5)
    incoming = random.normal(size=(64, 3)).astype(np.float32)
    incoming /= np.linalg.norm(incoming, axis=1)[:, None]
    for normal in (UP, direction(0.95, 2.0), direction(0.4, -1.0)):
        point, programs = one_point(outgoing, UP, normal), (PLAIN[name](), that_reads(PLAIN[name]()))
        results = [point.results(program) for program in programs]
        for key in results[0]:
            np.testing.assert_array_equal(results[0][key], results[1][key], err_msg=key)
        held, run = (point.closures(program, 0) for program in programs)
        values = [lobes.evaluate(outgoing, incoming, UP) for lobes in (held, run)]
        np.testing.assert_array_equal(*values)
        samples = [lobes.sample(outgoing, UP, stratified(8)) for lobes in (held, run)]
        for key in samples[0]:
            np.testing.assert_array_equal(samples[0][key], samples[1][key], err_msg=key)


def test_an_operation_added_later_counts():
    program = program_with("diffuse", [1.0, WHITE])
    before = closures(program, UP).evaluate(UP, UP[None], UP)
    half = program.constant(0.5, 0.5, 0.5, 0.5)
    program.operation("diffuse", [half, program.constant(1, 1, 1, 1)])
    np.testing.assert_allclose(closures(program, UP).evaluate(UP, UP[None], UP), 1.5 * before, rtol=1e-6)
