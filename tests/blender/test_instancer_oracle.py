"""Texture coordinates from the instancer are those of Cycles."""

from pathlib import Path

import numpy as np


def test_coordinates_of_what_makes_instances(run_blender, tmp_path):
    pictures = run_blender(Path(__file__).with_name("instancer_oracle.py"), tmp_path).report["pictures"]
    assert len(pictures) == 9
    varied = set()
    for case, pair in pictures.items():
        cycles, own = (np.array(picture) for picture in pair)
        inside = (cycles[..., 3] == 1.0) & (own[..., 3] == 1.0)
        assert inside.sum() > 1000, case
        apart = np.abs(cycles - own)[inside]
        assert np.quantile(apart, 0.95) < 1e-3, case  # cubes overlap, and samples of their borders differ
        if np.ptp(own[inside][:, :2], axis=0).min() > 0.5:
            varied.add(case)
    assert {"FACES, UV", "FACES, UV Map", "PARTICLES, UV", "PARTICLES, UV Map"} <= varied
