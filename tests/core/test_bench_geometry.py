"""The geometry cache's benchmark runs, in small."""

import json
import os
import subprocess
import sys

import pytest


@pytest.mark.slow
def test_the_benchmark_of_the_geometry_cache_prints_its_tables(root, addons, tmp_path):
    script, out = root / "tests" / "bench" / "run_benchmarks.py", tmp_path / "rows.json"
    environment = {**os.environ, "RAYLEAF_PACKAGE_DIR": str(addons)}
    run = subprocess.run(
        [sys.executable, script, "geometry", "--quick", "--json", out], env=environment, capture_output=True, text=True
    )
    assert run.returncode == 0, run.stdout + run.stderr
    for title in ("multi: ", "single: ", "nothing is kept", "Embree's full grid", "Reach", "A scene that fits"):
        assert title in run.stdout, run.stdout
    rows = {row["name"]: row["values"][0] for row in json.loads(out.read_text())["cases"]["geometry"]}
    assert rows["vertices computed again, single over multi"] > 300
    assert rows["parity errors of 100000 rays through a shell of mixed levels"] == 0
    assert min(value for name, value in rows.items() if name.endswith("speed")) > 0
