"""Panoramic cameras against Cycles: every type, in pictures of every shape."""

from pathlib import Path

HERE = Path(__file__).resolve().parent


def test_panoramas_show_what_they_show_in_cycles(run_blender, tmp_path):
    result = run_blender(HERE / "panorama_oracle.py", tmp_path, timeout=300).report["result"]
    assert len(result) == 9
    for name, found in result.items():
        assert found["mean"] < 0.005, (name, found)  # noise of pixels at borders; colours range from 0 to 1
        assert abs(found["empty"][0] - found["empty"][1]) < 0.02, (name, found)
        assert found["depth"] is None or found["depth"] < 0.2, (name, found)  # of one sample in each
    assert result["mirror ball"]["empty"][1] > 0.1 and result["all around"]["empty"][1] == 0
