"""Stereoscopic pictures against Cycles: each view of every kind."""

from pathlib import Path

import numpy as np
import plain_exr

HERE = Path(__file__).resolve().parent
SIDE = 4  # pixels along a side of the parts that are compared
CLOSE = 0.015  # noise of both engines


def view(path, name):
    channels = plain_exr.read(path)
    picture = np.stack([channels[f"ViewLayer.Combined.{name}.{letter}"] for letter in "RGB"], -1)
    height, width = picture.shape[0] // SIDE, picture.shape[1] // SIDE
    return picture.reshape(height, SIDE, width, SIDE, 3).mean((1, 3))


def test_views_are_those_of_cycles(run_blender, tmp_path):
    run = run_blender(HERE / "stereo_oracle.py", tmp_path, timeout=900)
    errors = {}
    for case in run.report["cases"]:
        path = str(tmp_path / case.replace(" ", "_"))
        seen = {
            name: [view(f"{path}_{engine}.exr", name) for engine in ("CYCLES", "RAYLEAF")] for name in ("left", "right")
        }
        for name, (wanted, own) in seen.items():
            errors[case, name] = float(np.abs(own - wanted).max())
        assert np.abs(seen["left"][1] - seen["right"][1]).max() > 5 * CLOSE, case
    assert {key: error for key, error in errors.items() if error > CLOSE} == {}
