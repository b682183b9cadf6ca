"""Movies and sequences of images against Cycles: which picture is seen when."""

from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parent
# Of 1: what two decoders make of the same colours.
CLOSE = 0.02


def test_the_same_picture_is_seen_as_in_cycles(run_blender, tmp_path):
    found = run_blender(HERE / "movies_oracle.py", tmp_path, timeout=300).report["found"]
    assert len(found) == 16
    wrong = {}
    for case, pictures in found.items():
        cycles, own = np.array(pictures)
        if np.abs(cycles - own).max() > CLOSE:
            wrong[case] = (cycles.round(3).tolist(), own.round(3).tolist())
    assert not wrong, "\n".join(f"{case}: {values}" for case, values in wrong.items())
    assert len({tuple(np.round(own, 2)) for _, own in found.values()}) >= 5
