"""Rays that do not see the world, glass on a transparent film, and opaque shadows are as in Cycles."""

from pathlib import Path

import numpy as np

SCRIPT = Path(__file__).parent / "film_oracle.py"
# Noise of parts of the picture: 4096 samples each.
ALLOWED = 0.012


def test_what_is_hidden_from_rays_is_hidden_as_in_cycles(run_blender, tmp_path):
    found = run_blender(SCRIPT, tmp_path).report["found"]
    far, plain = {}, np.array(found["plain"]["CYCLES"])
    for case, pictures in found.items():
        cycles, rayleaf = (np.array(pictures[engine]) for engine in ("CYCLES", "RAYLEAF"))
        assert case == "plain" or np.abs(cycles - plain).max() > 0.008, case  # it shows
        difference = np.abs(rayleaf - cycles)
        if difference.max() > 3 * ALLOWED or difference.mean() > ALLOWED / 2:
            far[case] = (difference.max(), difference.mean())
    assert far == {}, far
