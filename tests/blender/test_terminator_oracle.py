"""Coarse meshes that are shaded smooth show no facets in their shadow, as in Cycles."""

from pathlib import Path

import numpy as np

SCRIPT = Path(__file__).parent / "terminator_oracle.py"


# Of the mean: Cycles shades a mesh that is scaled after it has moved its corners, and so interpolates other normals.
ALLOWED = 0.04


def test_the_shadow_terminator_is_cycles_own(run_blender, tmp_path):
    found = run_blender(SCRIPT, tmp_path).report["found"]
    far = {}
    for case, pictures in found.items():
        cycles, rayleaf = (np.array(pictures[engine]) for engine in ("CYCLES", "RAYLEAF"))
        difference = np.abs(rayleaf - cycles).mean() / cycles.mean()
        if not difference < ALLOWED:
            far[case] = difference
    assert far == {}, far
    lifted, plain = (np.array(found[case]["RAYLEAF"]) for case in ("ball", "none"))
    assert lifted.mean() > 1.005 * plain.mean()  # the offset shows
