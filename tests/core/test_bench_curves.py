"""The benchmark of curves runs, in small."""

import json
import os
import subprocess
import sys


def test_the_benchmark_of_curves_prints_its_tables(root, addons, tmp_path):
    script, out = root / "tests" / "bench" / "run_benchmarks.py", tmp_path / "rows.json"
    environment = {**os.environ, "RAYLEAF_PACKAGE_DIR": str(addons)}
    run = subprocess.run(
        [sys.executable, script, "curves", "--quick", "--json", out], env=environment, capture_output=True, text=True
    )
    assert run.returncode == 0, run.stdout + run.stderr
    for title in (
        "swept patch",
        "Embree's round curve",
        "triangles, 32 sides",
        "equal silhouette error",
        "aimed at the axis",
    ):
        assert title in run.stdout, run.stdout
    rows = {(row["name"], row["unit"]): row["values"] for row in json.loads(out.read_text())["cases"]["curves"]}
    assert max(rows["lost axis hits: round", "share"] + rows["lost axis hits: ribbon", "share"]) == 0
    assert rows["quads, 32 sides", "radii, median error"][0] < rows["quads, 8 sides", "radii, median error"][0]
    assert rows["degree 40, de Casteljau", "rounding units"][0] < 50


def test_the_benchmark_of_axes_finds_no_lost_ray(root, addons, tmp_path):
    script = root / "tests" / "bench" / "run_benchmarks.py"
    environment = {**os.environ, "RAYLEAF_PACKAGE_DIR": str(addons)}
    run = subprocess.run([sys.executable, script, "axis", "--quick"], env=environment, capture_output=True, text=True)
    assert run.returncode == 0, run.stdout + run.stderr
    assert "round strand, 1e+06" in run.stdout and "touching itself" in run.stdout, run.stdout
