"""Hair, and bodies that light goes through, have the colours that Cycles gives them."""

from pathlib import Path

import numpy as np
import pytest
from measured_nodes import keep_comparison

pytestmark = pytest.mark.nodes

SCRIPT = Path(__file__).parent / "spread_oracle.py"
# Of what is covered, a share of Cycles' brightest channel; and of the mean of all cases. Bodies are the same in both. Strands
# are not: Rayleaf's have round ends, which cover a twentieth more here, and are lit and seen by the others.
ALLOWED = {"subsurface": (0.01, 0.02), "hair": (0.07, 0.03)}
# Strands that mirror light along themselves to each other, where the ends count most: 0.11 less in 3.4, 0.12 in 5.2, both
# converged; without bounces 0.003.
ALONG_THE_STRANDS = 0.13
# With one diffuse bounce the Principled shader is up to 0.03 dimmer than in Cycles, converged; path traced up to 0.02.
ONE_BOUNCE = 0.03
# Since 4.0 Cycles' walks that go far beyond a body's size bring up to 0.04 more of the strongest channel than 3.4's, which
# ours are; why is not known.
FARTHER_WALKS = 0.04
# In 4.2 and 4.3 up to 0.19 off, where they are anisotropic or of one saturated colour; why is not known. No more in 4.5.
DIMMER_WALKS = 0.19


def differences(found):
    """By case: the difference of both engines' means, and what two seeds of each differ by."""
    result = {}
    for name, means in found.items():
        cycles, rayleaf = (
            np.array([np.array(means[f"{engine} {seed}"][:3]) / means[f"{engine} {seed}"][3] for seed in (1, 2)])
            for engine in ("CYCLES", "RAYLEAF")
        )
        whole = cycles.mean(axis=0).max()
        noise = (np.abs(cycles[0] - cycles[1]) + np.abs(rayleaf[0] - rayleaf[1])).max() / whole
        result[name] = ((rayleaf.mean(axis=0) - cycles.mean(axis=0)) / whole, noise)
    return result


@pytest.mark.parametrize("kind, integrator", [("subsurface", "path"), ("subsurface", "distribution"), ("hair", "path")])
def test_bodies_and_hair_have_the_colours_that_cycles_gives_them(run_blender, tmp_path, kind, integrator):
    run = run_blender(SCRIPT, kind, integrator, tmp_path)
    found = differences(run.report["found"])
    assert len(found) > 10
    each, mean = ALLOWED[kind]
    version = tuple(run.report["version"])
    if integrator == "distribution":
        each = ONE_BOUNCE
    if kind == "subsurface" and version >= (4, 0):
        each = FARTHER_WALKS

    def is_dim(name):
        return (
            (4, 0) <= version < (4, 4)
            and kind == "subsurface"
            and ("Anisotropy" in name or "(1.0, 0.02, 0.0, 1)" in name)
        )

    def allowed(name):
        if is_dim(name):
            return DIMMER_WALKS
        return ALONG_THE_STRANDS if "'Reflection'" in name and "'Offset'" in name else each

    wrong = {}
    for name, (d, noise) in found.items():
        bound, largest = allowed(name) + noise, np.abs(d).max()
        keep_comparison(f"{kind}, {integrator}", name, run.report["nodes"][name], largest, np.median(np.abs(d)), bound)
        if largest > bound:
            wrong[name] = (d.tolist(), noise)
    assert wrong == {}
    assert np.abs(np.mean([d for d, _ in found.values()], axis=0)).max() < mean
    assert np.median([noise for _, noise in found.values()]) < 0.15
