"""Runs a benchmark in small, as `rayleaf bench CASE --quick` does."""

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any


def run_quickly(case: str, root: Path, addons: Path, folder: Path) -> tuple[str, list[dict[str, Any]]]:
    """What it printed, and its rows; fails with its output if it does."""
    script, out = root / "tests" / "bench" / "run_benchmarks.py", folder / "rows.json"
    environment = {**os.environ, "RAYLEAF_PACKAGE_DIR": str(addons)}
    command = [sys.executable, str(script), case, "--quick", "--json", str(out)]
    run = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stdout + run.stderr
    return run.stdout, json.loads(out.read_text())["cases"][case]
