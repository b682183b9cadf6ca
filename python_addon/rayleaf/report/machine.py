"""What figures depend on: the machine, the versions, the commit."""

import os
import platform
import subprocess
from importlib import metadata
from pathlib import Path


def _first_line(command: list[str], folder: Path) -> str:
    try:
        done = subprocess.run(command, capture_output=True, text=True, cwd=folder, check=False)
    except OSError:
        return "unknown"
    return (done.stdout.splitlines() or ["unknown"])[0].strip()


def processor() -> str:
    """Its name as the system tells it."""
    for line in Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines():
        if line.startswith("model name"):
            return line.split(":", 1)[1].strip()
    return platform.machine()


def _version(package: str) -> str:
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return "absent"


def blender_version(blender: str) -> str:
    """As Blender tells it."""
    return _first_line([blender, "--version"], Path.cwd())


def describe(root: Path, blender: str) -> dict[str, str]:
    """One line each. `root` is the project's folder; outside a clone the commit is unknown."""
    changed = _first_line(["git", "status", "--porcelain"], root)
    commit = _first_line(["git", "rev-parse", "--short", "HEAD"], root)
    return {
        "processor": processor(),
        "cores": str(os.cpu_count()),
        "load before": f"{os.getloadavg()[0]:.2f}",
        "system": platform.platform(),
        "commit": commit + (" with changes" if changed not in ("", "unknown") else ""),
        "Blender": blender_version(blender),
        "NumPy": _version("numpy"),
        "scikit-image": _version("scikit-image"),
    }
