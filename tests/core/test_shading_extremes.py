"""Closures of any numbers say nothing that is NaN, infinite or negative."""

import numpy as np
from hypothesis import example, given
from hypothesis import strategies as st
from shading_support import UP, closures, direction, program_with

extreme = st.one_of(
    st.sampled_from([0.0, 1.0, -1.0, 1e-30, 1e-8, 1 + 1e-6, 1 - 1e-6, 10.0, 1e6, 3e38]),
    st.floats(-10, 10, width=32),
)
unit = st.tuples(st.floats(-1, 1, width=32), st.floats(0, 6.25, width=32))


def given_principled(count):
    """So many numbers, the method, the directions of viewer and light, and how far the normal leans."""
    method = st.sampled_from(["", "MULTI_GGX"])
    return given(st.lists(extreme, min_size=count, max_size=count), method, unit, unit, st.floats(0, 6.25, width=32))


def check_principled(operation, operands, text, view, light, tilt):
    outgoing = direction(*view)
    normal = np.float32((np.sin(tilt), 0, np.cos(tilt)))
    check_finite(
        closures(program_with(operation, operands, text), outgoing, normal=normal), outgoing, direction(*light)
    )


@given_principled(21)
def test_principled_is_finite_for_any_numbers(numbers, text, view, light, tilt):
    operands = list(numbers[:18]) + [None, None, None]
    check_principled("principled", operands, text, view, light, tilt)


def _layers(**at):
    """White layers, by the place of a number."""
    return [at.get(f"n{i}", 1.0 if i in (0, 1, 17) else 0.0) for i in range(27)]


@example(_layers(n0=4.7e-38, n11=1.0, n14=1.0, n18=1.0, n19=1.0), "", (0.0, 0.0), (0.0, 0.0), 0.0)
@example(_layers(n23=2.0**-24), "", (1.0, 0.0), (1.0, 0.0), 0.0)
@example(_layers(n18=3e38, n19=1.0, n26=1.0), "", (0.5, 0.0), (0.5, 0.0), 0.0)
@given_principled(27)
def test_layers_are_finite_for_any_numbers(numbers, text, view, light, tilt):
    operands = [*numbers[:20], None, None, None, numbers[23], *[None] * 4, *numbers[24:]]
    check_principled("principled_layers", operands, text, view, light, tilt)


@example("conductor", "GGX", [1.0, 0.0, 0.0, 1.0, 1.0, 0.0], (1.0, 0.0), (1.0, 0.0))
@example("conductor", "GGX", [1.0, 0.0, 3e38, 1.0, 0.0, 0.0], (1.0, 0.0), (1.0, 0.0))
@example("glossy", "BECKMANN", [1.0, 1.0, 1.0, 0.0, 0.0, 0.0], (2.0**-38, 0.0), (2.0**-39, 0.0))
@given(
    st.sampled_from(["glossy", "glass", "refraction", "film", "metal", "conductor"]),
    st.sampled_from(["SHARP", "GGX", "MULTI_GGX", "BECKMANN", "ASHIKHMIN_SHIRLEY"]),
    st.lists(extreme, min_size=6, max_size=6),
    unit,
    unit,
)
def test_microfacets_are_finite_for_any_numbers(identifier, text, numbers, view, light):
    film = numbers[4:]
    forms = {"glossy": numbers[:3], "film": [*numbers[:4], None, *film]}
    forms |= dict.fromkeys(("metal", "conductor"), [*numbers[:4], None, numbers[2], 0.0, None, *film])
    outgoing, incoming = direction(*view), direction(*light)
    operation = {"film": "glass", "conductor": "metal"}.get(identifier, identifier)
    ints = {"metal": [0], "conductor": [1]}.get(identifier, [])
    lobes = closures(program_with(operation, forms.get(identifier, numbers[:4]), text, ints), outgoing)
    check_finite(lobes, outgoing, incoming)


def check_finite(lobes, outgoing, incoming):
    """Nothing the closures say is NaN or infinite, nor negative."""
    random = np.float32([[0, 0, 0], [0.999999, 0.999999, 0.999999], [0.3, 0.7, 0.5], [0.9, 0.1, 0.99]])
    sample = lobes.sample(outgoing, UP, random)
    for name in ("direction", "weight", "density", "eta"):
        assert np.isfinite(sample[name]).all(), name
    lengths = np.linalg.norm(sample["direction"][sample["valid"]], axis=1)
    np.testing.assert_allclose(lengths, 1, atol=1e-4)
    # Huge weights overflow in sums of values; the closures must still not say NaN.
    value = lobes.evaluate(outgoing, incoming[None], UP)
    assert not np.isnan(value).any() and (value >= 0).all()
    density = lobes.density(outgoing, incoming[None], UP)
    assert not np.isnan(density).any() and (density >= 0).all()
