"""The benchmark of target errors runs, in small."""

import pytest
from benchmark_runs import run_quickly


@pytest.mark.slow
def test_the_benchmark_of_target_errors_prints_what_was_achieved(root, addons, tmp_path, monkeypatch):
    monkeypatch.setenv("BLENDER_USER_SCRIPTS", str(addons.parent))
    printed, measured = run_quickly("target", root, addons, tmp_path)
    assert all(word in printed for word in ("target", "achieved", "bezier_sheet", "of fixed")), printed
    share = next(row["values"][0] for row in measured if row["unit"] == "of the target")
    assert 0.2 < share < 1.3
