"""Generated coordinates stay where they were before a mesh was deformed, as in Cycles."""

from pathlib import Path

import numpy as np

# Of colours from 0 to 3.
CLOSE = 5e-3
# A bumped normal is told by heights a pixel away, which either engine takes its own way.
ROUGHLY = 0.15


def test_generated_coordinates_of_deformed_meshes(run_blender, tmp_path):
    pictures = run_blender(Path(__file__).with_name("deformed_oracle.py"), tmp_path).report["pictures"]
    assert len(pictures) == 6
    for case, pair in pictures.items():
        cycles, own = (np.array(picture) for picture in pair)
        inside = (cycles[..., 3] == 1.0) & (own[..., 3] == 1.0)
        assert inside.sum() > 800, case
        apart = np.abs(cycles - own)[inside][:, :3].max(axis=1)
        assert np.quantile(apart, 0.95) < (ROUGHLY if case == "bumped" else CLOSE), case
        assert np.ptp(own[inside][:, :3], axis=0).max() > 0.5, case
