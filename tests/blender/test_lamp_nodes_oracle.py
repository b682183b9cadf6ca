"""Nodes of lamps against Cycles: light distributions, coordinates, falloff, several emissions, on every kind of lamp."""

from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parent


def test_lamps_with_nodes_shine_as_in_cycles(run_blender, tmp_path):
    pictures = run_blender(HERE / "lamp_nodes_oracle.py", tmp_path, timeout=600).report["pictures"]
    assert len(pictures) > 35
    wrong = []
    for name, (cycles, rayleaf) in pictures.items():
        expected, got = np.array(cycles), np.array(rayleaf)
        assert expected.max() > 0.0, f"{name}: black in Cycles"
        largest, mean = np.abs(got - expected).max() / expected.max(), got.mean() / expected.mean() - 1.0
        # Lamps without a size are free of noise but for where a sample lies in its pixel; areas have some.
        if largest > (0.05 if "rectangle" in name or "disk" in name else 0.02) or abs(mean) > 0.005:
            wrong.append(f"{name}: pixels by {largest:.4f}, mean by {mean:.4f}")
    assert not wrong, "\n".join(wrong)
