"""The ray cache's benchmark runs, on a stamp of a picture."""

import json
import os
import subprocess
import sys

import pytest


@pytest.mark.slow
def test_the_benchmark_of_ray_caches_prints_its_tables(root, addons, tmp_path):
    script, out = root / "tests" / "bench" / "run_benchmarks.py", tmp_path / "rows.json"
    environment = {**os.environ, "RAYLEAF_PACKAGE_DIR": str(addons)}
    run = subprocess.run(
        [sys.executable, script, "rays", "--quick", "--json", out], env=environment, capture_output=True, text=True
    )
    assert run.returncode == 0, run.stdout + run.stderr
    for title in ("mirror sheet, 24 x 24", "gentle glass", "Reach", "scattered", "Table 1", "Table 2"):
        assert title in run.stdout, run.stdout
    rows = {row["name"]: row["values"] for row in json.loads(out.read_text())["cases"]["rays"]}
    for method in ("tracing", "triangles", "packets", "Newton", "image plane", "reference", "fast"):
        for frame in ("first frame", "repeated frame", "orbit frame"):
            assert min(rows[f"mirror sheet, 24 x 24: {method}, {frame}"]) > 0
        # Both pictures show the same; a wrong answer would be off by tenths.
        assert rows[f"mirror sheet, 24 x 24: {method}, error"][0] < 0.06, method
