"""The geometry cache's benchmark runs, in small."""

import pytest
from benchmark_runs import run_quickly


@pytest.mark.slow
def test_the_benchmark_of_the_geometry_cache_prints_its_tables(root, addons, tmp_path):
    printed, measured = run_quickly("geometry", root, addons, tmp_path)
    for title in (
        *(
            "multi, by size: ",
            "multi, by default: ",
            "single: ",
            "nothing kept",
            "Embree's full grid",
            "A scene that fits",
        ),
        *("Reach by size", "Reach by default"),
    ):
        assert title in printed, printed
    rows = {row["name"]: row["values"][0] for row in measured}
    for rule in ("by size", "by default"):
        assert rows[f"{rule}: vertices computed again, single over multi"] > 300
    assert all(value == 0 for name, value in rows.items() if name.startswith("parity errors"))
    assert min(value for name, value in rows.items() if name.endswith("speed")) > 0
