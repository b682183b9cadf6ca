"""Shadow catchers against Cycles: in the picture, and as a pass of their own."""

from pathlib import Path

import numpy as np
import plain_exr

HERE = Path(__file__).resolve().parent
SIDE = 4  # pixels along a side of the parts that are compared
# Of the largest value: noise of both engines, and in Combined over an opaque film Cycles' darker borders of objects.
CLOSE = 0.02


def pixels(folder, case, engine, name, letters):
    found = plain_exr.read(folder / f"{case}_{engine}.exr")
    return np.stack([found[f"ViewLayer.{name}.{letter}"] for letter in letters], -1)


def parts(picture):
    count = picture.shape[0] // SIDE
    return picture.reshape(count, SIDE, count, SIDE, -1).mean((1, 3))


def test_shadow_catchers_are_those_of_cycles(run_blender, tmp_path):
    run = run_blender(HERE / "shadow_catcher_oracle.py", tmp_path, timeout=900)
    found = {}
    for case, name, letters in (
        ("alpha", "Combined", "RGBA"),
        ("pass", "Combined", "RGBA"),
        ("pass", "Shadow Catcher", "RGB"),
        ("opaque", "Combined", "RGBA"),
        ("opaque_pass", "Combined", "RGBA"),
        ("opaque_pass", "Shadow Catcher", "RGB"),
    ):
        wanted, own = (parts(pixels(tmp_path, case, engine, name, letters)) for engine in ("CYCLES", "RAYLEAF"))
        found[case, name] = np.abs(own - wanted).max() / max(np.abs(wanted).max(), 1.0)
    assert {key: error for key, error in found.items() if error > CLOSE} == {}
    assert run.report["lamps_are_in_footage"]
