"""Volumes against Cycles: every node of volumes, even and by textures, in objects, glass and the world."""

from pathlib import Path

import numpy as np
import pytest
from measured_nodes import keep_comparison

pytestmark = pytest.mark.nodes

HERE = Path(__file__).resolve().parent
# Of the brightest part. Noise of both engines at these samples; caustics through glass are the worst of it.
# Through what varies Cycles marches in steps, with an error of its own; many bounces are noisier.
CLOSE, UNEVEN, WITH_CAUSTICS = 0.015, 0.02, 0.03


def test_volumes_look_as_in_cycles(run_blender, tmp_path):
    run = run_blender(HERE / "volume_oracle.py", tmp_path, timeout=900).report
    result = run["result"]
    assert len(result) > 24
    wrong = []
    for name, engines in result.items():
        cycles = np.array(engines["CYCLES"])
        for engine in engines.keys() - {"CYCLES"}:
            own = np.array(engines[engine])
            apart = np.abs(own - cycles) / cycles.max()
            difference = apart.max()
            caustics, varies = "glass" in name or "another" in name, "uneven" in name or "bounces" in name
            bound = WITH_CAUSTICS if caustics else UNEVEN if varies else CLOSE
            keep_comparison(f"volumes, {engine.lower()}", name, run["nodes"][name], difference, np.median(apart), bound)
            if difference > bound:
                wrong.append(f"{name}, {engine}: {difference:.4f}\n  {cycles.round(3)}\n  {own.round(3)}")
    assert not wrong, "\n".join(wrong)
