"""Ambient Occlusion, Bevel and Raycast give what they give in Cycles."""

from pathlib import Path

import numpy as np
import pytest
from measured_nodes import keep_comparison

pytestmark = pytest.mark.nodes

SCRIPT = Path(__file__).parent / "surroundings_oracle.py"
# Noise of parts of the picture: 2048 samples each, of some rays. Rays of Cycles' Bevel start in single precision.
ALLOWED = 0.012


def test_occlusion_and_rounded_edges_are_cycles_own(run_blender, tmp_path):
    run = run_blender(SCRIPT, tmp_path).report
    far, found = {}, run["found"]
    for case, pictures in found.items():
        cycles, rayleaf = (np.array(pictures[engine]) for engine in ("CYCLES", "RAYLEAF"))
        assert cycles.std() > 0.02, case  # the node shows
        difference = np.abs(rayleaf - cycles)
        keep_comparison("surroundings", case, run["nodes"][case], difference.max(), np.median(difference), 3 * ALLOWED)
        if difference.max() > 3 * ALLOWED or difference.mean() > ALLOWED / 2:
            far[case] = (difference.max(), difference.mean())
    assert far == {}, far
    edges, plain = (np.array(found[case]["RAYLEAF"]) for case in ("bevel", "no bevel"))
    assert np.abs(edges - plain).max() > 0.01
