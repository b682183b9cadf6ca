"""Motion against Cycles: objects, instances and cameras, every setting of the shutter, and the Vector pass."""

from pathlib import Path

HERE = Path(__file__).resolve().parent


def test_motion_is_blurred_and_has_vectors_as_in_cycles(run_blender, tmp_path):
    report = run_blender(HERE / "motion_oracle.py", tmp_path, timeout=300).report
    assert len(report["result"]) == 22 and len(report["vectors"]) >= 6
    for name, found in report["result"].items():
        assert found["apart"] < 0.01, (name, found)
        assert abs(found["brighter"]) < 0.004, (name, found)
        assert found["frame"] == 10, (name, found)
        assert found["blurred"] > 4 * found["apart"] or name in ("still_cube", "still_mesh"), (name, found)
    for name, found in report["vectors"].items():
        assert found["pixels"] > 100 and found["largest"] > 1, (name, found)
        assert found["apart"] < 0.03 * found["largest"], (name, found)  # of one sample; Cycles' mean of all
        assert found["frame"] == 10, (name, found)
