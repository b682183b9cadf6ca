"""Filter Glossy and the caustics switches change what they change in Cycles."""

from pathlib import Path

import numpy as np

SCRIPT = Path(__file__).parent / "caustics_oracle.py"
# Of the brightness of white paper. Noise of sharp caustics; of blurred ones there is less.
NOISE = 0.025


def test_caustics_are_filtered_as_in_cycles(run_blender, tmp_path):
    found = run_blender(SCRIPT, tmp_path).report["found"]
    far, sharp = {}, np.array(found["sharp"]["CYCLES"])
    for case, pictures in found.items():
        cycles, rayleaf = (np.array(pictures[engine]) for engine in ("CYCLES", "RAYLEAF"))
        change = np.abs(cycles - sharp).max()
        assert case == "sharp" or change > 2 * NOISE, (case, change)  # it shows
        difference = np.abs(rayleaf - cycles)
        if difference.max() > NOISE or difference.mean() > NOISE / 5:
            far[case] = (difference.max(), difference.mean())
    assert far == {}, far
