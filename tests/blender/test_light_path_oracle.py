"""Light Path answers as in Cycles, to every kind of ray."""

from pathlib import Path

import numpy as np
import pytest
from measured_nodes import keep_comparison

pytestmark = pytest.mark.nodes

SCRIPT = Path(__file__).parent / "light_path_oracle.py"
# Of the brightest part: noise of both engines.
CLOSE = 0.03


def test_every_output_tells_of_rays_what_it_tells_in_cycles(run_blender, tmp_path):
    run = run_blender(SCRIPT, tmp_path, timeout=300).report
    assert len(run["found"]) >= 26
    far = {}
    for case, pictures in run["found"].items():
        cycles, rayleaf = (np.array(pictures[engine]) for engine in ("CYCLES", "RAYLEAF"))
        apart = np.abs(rayleaf - cycles) / cycles.max()
        keep_comparison("light paths", case, run["nodes"][case], apart.max(), np.median(apart), CLOSE)
        if apart.max() > CLOSE:
            far[case] = (apart.max(), cycles.round(3).tolist(), rayleaf.round(3).tolist())
    assert far == {}
