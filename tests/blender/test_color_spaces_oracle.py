"""Images in every colour space of Blender's configuration, and of another, against Cycles."""

from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parent
# Cycles holds images of bytes as bytes, encoded as sRGB, and floats of such spaces as half floats.
BYTES, FLOATS = 0.006, 0.002
# Bytes that it multiplies by alpha are rounded once more.
WITH_ALPHA = 0.015


def compare(found):
    """What differs, by case."""
    wrong = []
    for case, pictures in found.items():
        cycles, own = (np.array(picture) for picture in pictures)
        shown = [np.clip(each, 0.0, None) ** (1 / 2.4) for each in (cycles, own)]
        apart = np.abs(shown[0] - shown[1]).max() / shown[0].max()
        kind = case.partition(",")[0]
        if apart > {"floats": FLOATS, "with alpha": WITH_ALPHA}.get(kind, BYTES):
            wrong.append(f"{case}: {apart:.4f}\n  {cycles[:6].round(4)}\n  {own[:6].round(4)}")
    return wrong


def test_images_of_every_space_look_as_in_cycles(run_blender, tmp_path):
    found = run_blender(HERE / "color_spaces_oracle.py", tmp_path).report["found"]
    # The inverse of this transform, of Blender 5.0 and later, is not known to OpenColorIO before 2.4.
    found = {case: pictures for case, pictures in found.items() if "ACES 2.0" not in case}
    assert len(found) > 20
    assert not compare(found), "\n".join(compare(found))
    pictures = {case: np.array(each[1]) for case, each in found.items()}
    other = next(case for case in found if case.startswith("bytes, ") and "XYZ" in case)
    assert np.abs(pictures[other] - pictures["bytes, sRGB"]).max() > 0.1  # the space shows


OTHER = """ocio_profile_version: 1
search_path: ""
strictparsing: false
luma: [0.2126, 0.7152, 0.0722]
roles:
  reference: Linear
  scene_linear: Linear
  default_byte: sRGB
  default_float: Linear
  default_sequencer: sRGB
  color_picking: sRGB
  texture_paint: Linear
  data: Numbers
displays:
  sRGB:
    - !<View> {name: Standard, colorspace: sRGB}
active_displays: [sRGB]
active_views: [Standard]
colorspaces:
  - !<ColorSpace>
    name: Linear
    isdata: false
  - !<ColorSpace>
    name: Numbers
    isdata: true
  - !<ColorSpace>
    name: sRGB
    isdata: false
    to_reference: !<ExponentTransform> {value: [1.7, 1.7, 1.7, 1]}
  - !<ColorSpace>
    name: Swapped
    isdata: false
    to_reference: !<MatrixTransform> {matrix: [0.1, 0.9, 0, 0, 0.8, 0, 0.2, 0, 0, 0.3, 0.5, 0, 0, 0, 0, 1]}
"""


def test_another_configuration_says_what_its_names_mean(run_blender, tmp_path):
    config = tmp_path / "other.ocio"
    config.write_text(OTHER)
    run = run_blender(HERE / "color_spaces_oracle.py", tmp_path, env={"OCIO": str(config)})
    found = run.report["found"]
    assert {"bytes, Swapped", "bytes, sRGB", "bytes, Numbers", "floats, Swapped"} <= found.keys()
    assert not compare(found), "\n".join(compare(found))
