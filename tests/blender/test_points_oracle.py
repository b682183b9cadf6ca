"""Point clouds are balls, with the coordinates and the light of Cycles', and attributes of their own."""

from pathlib import Path

import numpy as np

# Colours of nodes; of light that is scattered, the noise of samples comes in.
CLOSE, NOISY = 1e-3, 0.2
NOISE = {"matte", "glass"}


def test_points_are_those_of_cycles(run_blender, tmp_path):
    pictures = run_blender(Path(__file__).with_name("points_oracle.py"), tmp_path).report["pictures"]
    assert len(pictures) == 9
    for case, pair in pictures.items():
        cycles, own = (np.array(picture) for picture in pair)
        inside = (cycles[..., 3] == 1.0) & (own[..., 3] == 1.0)
        assert inside.sum() > 2000, case
        assert abs((cycles - own)[..., 3].mean()) < 1e-3, case
        shown = own[inside][:, :3]
        assert np.ptp(shown, axis=0).max() > 0.03, case
        if case == "Attribute":  # which Cycles shows as 0
            number = np.arange(16)[:, None]
            expected = 12 + np.hstack([0.1 * number, 1 - 0.05 * number, 0.3 + 0 * number])
            apart = np.abs(shown[:, None] - expected).max(axis=-1).min(axis=-1)
        else:
            apart = np.abs(cycles[inside][:, :3] - shown).max(axis=-1)
        assert np.quantile(apart, 0.9) < (NOISY if case in NOISE else CLOSE), case
        if case == "matte":  # glass mirrors the sun, in few samples
            assert np.allclose(cycles[inside].mean(axis=0), own[inside].mean(axis=0), atol=0.02), case
