"""Simulated smoke and fire against Cycles."""

from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parent
CLOSE = 0.02  # of the brightest part


def test_smoke_and_fire_look_as_in_cycles(run_blender, tmp_path):
    result = run_blender(HERE / "smoke_oracle.py", tmp_path, timeout=600).report["result"]
    assert len(result) == 3
    for name, engines in result.items():
        cycles, own = (np.array(engines[engine]) for engine in ("CYCLES", "RAYLEAF"))
        assert cycles.std() > 0.01, name
        assert np.abs(own - cycles).max() < CLOSE * cycles.max(), f"{name}\n{cycles.round(3)}\n{own.round(3)}"
