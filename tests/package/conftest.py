"""The finished zips, made once a session by `rayleaf package`, and what is in them."""

import os
import subprocess
import zipfile
from dataclasses import dataclass
from pathlib import Path

import pytest
from blender_runner import run_blender  # noqa: F401


@dataclass(frozen=True)
class Zips:
    """What `rayleaf package` has written."""

    extension: Path
    add_on: Path


@pytest.fixture(scope="session")
def zips(root: Path) -> Zips:
    """Both zips of this checkout."""
    # The module of one Python: those of others are made of the same core.
    environment = {**os.environ, "RAYLEAF_PACKAGE_PYTHONS": "3.11"}
    command = [str(root / "rayleaf"), "package"]
    made = subprocess.run(command, capture_output=True, text=True, timeout=1800, env=environment)
    assert made.returncode == 0, made.stderr
    paths = [Path(line.split("  (")[0]) for line in made.stdout.splitlines() if ".zip" in line and line.startswith("/")]
    return Zips(*paths)


@pytest.fixture(scope="session")
def installed(zips: Zips, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder for BLENDER_USER_SCRIPTS in which the add-on zip has been unpacked."""
    scripts = tmp_path_factory.mktemp("installed") / "scripts"
    with zipfile.ZipFile(zips.add_on) as archive:
        archive.extractall(scripts / "addons")
    return scripts
