"""The benchmark of whole scenes runs, in small."""

import pytest
from benchmark_runs import run_quickly


@pytest.mark.slow
def test_the_benchmark_of_whole_scenes_builds_one_and_prints_what_was_asked_of_each_level(
    root, addons, tmp_path, monkeypatch
):
    monkeypatch.setenv("BLENDER_USER_SCRIPTS", str(addons.parent))
    printed, measured = run_quickly("scenes", root, addons, tmp_path)
    assert all(word in printed for word in ("coarse", "medium", "fine", "misses", "computed again")), printed
    rows = {row["name"]: row["values"][0] for row in measured}
    title = "parking_lot 1 diffuse"
    assert rows[f"{title}: subpatches"] > 5_000
    assert rows[f"{title}: multi, computed again"] < rows[f"{title}: single, computed again"]
