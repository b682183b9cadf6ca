"""The ray cache's benchmark runs, on a stamp of a picture."""

import pytest
from benchmark_runs import run_quickly


@pytest.mark.slow
def test_the_benchmark_of_ray_caches_prints_its_tables(root, addons, tmp_path):
    printed, measured = run_quickly("rays", root, addons, tmp_path)
    for title in ("mirror sheet, 24 x 24", "gentle glass", "Reach", "scattered", "Table 1", "Table 2"):
        assert title in printed, printed
    rows = {row["name"]: row["values"] for row in measured}
    for method in ("tracing", "triangles", "packets", "Newton", "image plane", "reference", "fast"):
        for frame in ("first frame", "repeated frame", "orbit frame"):
            assert min(rows[f"mirror sheet, 24 x 24: {method}, {frame}"]) > 0
        # Both pictures show the same; a wrong answer would be off by tenths.
        assert rows[f"mirror sheet, 24 x 24: {method}, error"][0] < 0.06, method
