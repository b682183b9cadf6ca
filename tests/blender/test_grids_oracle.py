"""Clouds of grids against Cycles: OpenVDB files, sequences, what modifiers make, and all that materials read of them."""

from pathlib import Path

import numpy as np
import pytest
from core.vdb_files import make_grid, write
from measured_nodes import keep_comparison

pytestmark = pytest.mark.nodes

HERE = Path(__file__).resolve().parent
# Of the brightest part: noise of both at these samples, and Cycles' steps.
CLOSE = 0.012


def ball(x, y, z, radius=0.9):
    """Dense in the middle, and uneven."""
    return np.clip(1.0 - np.sqrt(x * x + y * y + z * z) / radius, 0.0, 1.0) * (1.2 + np.sin(5.0 * x + 3.0 * z))


def write_cloud(path, size, **more):
    """Density, colours and the kelvins of its upper half."""
    inside = ball(*np.meshgrid(*[(np.arange(size) + 0.5) / size * 2 - 1] * 3, indexing="ij"), **more) > 0
    write(
        path,
        make_grid("density", lambda x, y, z: ball(x, y, z, **more), size),
        make_grid("color", lambda x, y, z: np.stack([0.5 + 0.4 * x, 0.5 + 0.0 * x, 0.5 + 0.4 * y], -1), size),
        make_grid("flame", lambda x, y, z: 0.5 * ball(x, z, y, **more), size),
        make_grid("temperature", lambda x, y, z: np.where(inside & (z > 0), 1500.0, 0.0), size),
    )


def test_clouds_look_as_in_cycles(run_blender, tmp_path):
    write_cloud(tmp_path / "cloud_0001.vdb", 20)
    write_cloud(tmp_path / "cloud_0002.vdb", 16, radius=0.6)
    run = run_blender(HERE / "grids_oracle.py", tmp_path, tmp_path, timeout=900).report
    result = run["result"]
    assert len(result) > 14
    wrong = []
    for name, engines in result.items():
        cycles, own = (np.array(engines[engine]) for engine in ("CYCLES", "RAYLEAF"))
        apart = np.abs(own - cycles) / cycles.max()
        difference = apart.max()
        keep_comparison("grids", name, run["nodes"].get(name, ()), difference, np.median(apart), CLOSE)
        if difference > CLOSE:
            wrong.append(f"{name}: {difference:.4f}\n  {cycles.round(3)}\n  {own.round(3)}")
    assert not wrong, "\n".join(wrong)
