"""Whole paths against Cycles: bounce limits by kind, transparency, passes, alpha."""

from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parent


def test_limits_and_passes_mean_what_they_mean_in_cycles(run_blender, tmp_path):
    result = run_blender(HERE / "path_oracle_script.py", tmp_path).report["result"]
    wrong = []
    for variant, engines in result.items():
        for name, expected in engines["CYCLES"].items():
            cycles, rayleaf = np.array(expected), np.array(engines["RAYLEAF"][name])
            difference = np.abs(rayleaf - cycles).max() / max(
                np.abs(np.array(engines["CYCLES"]["Combined"])).max(), 1e-3
            )
            # Differences with these seeds reach 0.005 of the brightest part, mostly by caustics through the glass.
            if difference > 0.01:
                wrong.append(f"{variant}, {name}: {difference:.4f}\n  {cycles.round(4)}\n  {rayleaf.round(4)}")
    assert not wrong, "\n".join(wrong)
