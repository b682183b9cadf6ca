"""Simulated smoke and fire against Cycles."""

from pathlib import Path

import numpy as np
import pytest
from measured_nodes import keep_comparison

pytestmark = pytest.mark.nodes

HERE = Path(__file__).resolve().parent
CLOSE = 0.02  # of the brightest part


def test_smoke_and_fire_look_as_in_cycles(run_blender, tmp_path):
    run = run_blender(HERE / "smoke_oracle.py", tmp_path, timeout=600).report
    result = run["result"]
    assert len(result) == 3
    for name, engines in result.items():
        cycles, own = (np.array(engines[engine]) for engine in ("CYCLES", "RAYLEAF"))
        assert cycles.std() > 0.01, name
        apart = np.abs(own - cycles) / cycles.max()
        keep_comparison("smoke", name, run["nodes"][name], apart.max(), np.median(apart), CLOSE)
        assert apart.max() < CLOSE, f"{name}\n{cycles.round(3)}\n{own.round(3)}"
