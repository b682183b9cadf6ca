"""What an image's alpha is set to be (Straight, Premultiplied, Channel Packed, None) means what it means in Cycles."""

from pathlib import Path

import numpy as np

# Cycles rounds bytes once more where it multiplies them by alpha, and Blender where it divides those of packed files.
BYTES, FLOATS = 0.02, 0.002
# Since 5.0 Cycles shows other colours of such a file than of the same file packed. Ours are those of both as it shows the
# packed one.
SINCE_5_0 = {"floats, file, STRAIGHT, colours, Color", "floats, file, PREMUL, colours, Color"}


def test_alphas_are_those_of_cycles(run_blender, tmp_path):
    report = run_blender(Path(__file__).with_name("image_alpha_oracle.py"), tmp_path).report
    found, known = report["found"], SINCE_5_0 if report["version"] >= [5, 0, 0] else set()
    assert len(found) == 2 * 4 * 2 * 3 * 2
    wrong = []
    for case, pictures in found.items():
        cycles, own = (np.clip(np.array(picture), 0.0, None) ** (1 / 2.4) for picture in pictures)
        apart = np.abs(cycles - own).max()
        if case not in known and apart > (FLOATS if case.startswith("floats") else BYTES):
            wrong.append(f"{case}: {apart:.4f}")
    assert not wrong, "\n".join(wrong)
