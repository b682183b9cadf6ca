"""Attributes of instances, and properties of what makes them and of the view layer, are those of Cycles."""

from pathlib import Path

import numpy as np


def test_attributes_of_instances(run_blender, tmp_path):
    run = run_blender(Path(__file__).with_name("instancer_attributes_oracle.py"), tmp_path)
    pictures = run.report["pictures"]
    are_shown = tuple(run.report["version"]) >= (4, 5)
    assert ("does not show attributes of instances" in run.log) is not are_shown
    colors = {}
    for case, pair in pictures.items():
        cycles, own = (np.array(picture) for picture in pair)
        inside = (cycles[..., 3] == 1.0) & (own[..., 3] == 1.0)
        assert inside.sum() > 300, case
        colors[case] = len(np.unique(cycles[inside].round(2), axis=0))
        if are_shown or case not in run.report["of_geometry_nodes"]:
            apart = np.abs(cycles - own)[inside]
            assert np.quantile(apart, 0.97) < 1e-3, case  # samples of their borders differ
    assert all(colors[case] > 5 for case in run.report["of_geometry_nodes"]), colors
    assert len(pictures) == 11
