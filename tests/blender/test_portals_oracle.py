"""Rays that go by portals show what they show in Cycles."""

from pathlib import Path

import numpy as np
import pytest
from measured_nodes import keep_comparison

pytestmark = pytest.mark.nodes

SCRIPT = Path(__file__).parent / "portals_oracle.py"
# Of the brightest part: noise of both engines.
CLOSE = 0.012


def test_portals_show_the_other_place_as_in_cycles(run_blender, tmp_path):
    run = run_blender(SCRIPT, tmp_path, timeout=300).report
    if not run["found"]:
        pytest.skip("Ray Portal came with Blender 4.2")
    far = {}
    for case, pictures in run["found"].items():
        cycles = np.array(pictures["CYCLES PATH"])
        for integrator in ("PATH", "DISTRIBUTION"):
            apart = np.abs(np.array(pictures[f"RAYLEAF {integrator}"]) - cycles) / cycles.max()
            keep_comparison(
                "portals", f"{case}, {integrator}", run["nodes"][case], apart.max(), np.median(apart), CLOSE
            )
            if apart.max() > CLOSE:
                far[f"{case}, {integrator}"] = apart.max()
    assert far == {}, far
