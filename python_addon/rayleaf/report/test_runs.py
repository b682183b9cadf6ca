"""Tests that the report runs for the figures they measure."""

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any


def figures(
    root: Path, selection: list[str], variable: str, path: Path, more: dict[str, str] | None = None
) -> tuple[list[dict[str, Any]], str]:
    """Runs pytest on a selection of the project's tests. Their lines, which they add to the file that an environment variable
    names, and pytest's last line. `more` environment, where they need it."""
    path.unlink(missing_ok=True)
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "--rootdir", str(root), "-c"]
    command += [str(root / "pyproject.toml"), *selection]
    environment = {**os.environ, **(more or {}), variable: str(path.resolve())}
    done = subprocess.run(command, capture_output=True, text=True, cwd=root, env=environment, check=False)
    summary = (done.stdout.strip().splitlines() or ["no tests were run"])[-1]
    lines = path.read_text(encoding="utf-8").splitlines() if path.exists() else []
    return [json.loads(line) for line in lines], summary
