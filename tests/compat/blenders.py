"""The Blenders that the package is tried in, brought here as they are asked for: Debian's, and `bpy` of Python's package index."""

import os
import stat
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import debian_releases

ROOT = Path(__file__).resolve().parents[2]
CACHE = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "rayleaf" / "compat"
LAUNCHER = Path(__file__).with_name("blender_of_module.py")
# Blender as a Python module: version -> the Python that it needs. The newest patch is taken.
MODULES = {"4.2": "3.11", "4.5": "3.11", "5.0": "3.11", "5.2": "3.13", "5.3": "3.13"}
# Of other Debian releases, those whose Blender there is.
RELEASES = ("trixie", "sid")
# Blender's libraries that have the names of ours, in the global scope of its official programs.
FOREIGN = ("libembree", "libtbb", "libOpenImageIO", "libosdCPU", "libImath")


@dataclass(frozen=True)
class Blender:
    """One Blender: what starts it, and its libraries that may answer in place of ours."""

    name: str
    program: Path
    libraries: tuple[Path, ...] = ()
    has_commands: bool = False  # `blender --command`, which the module lacks
    is_module: bool = False

    @property
    def has_extensions(self) -> bool:
        """Extensions came with 4.2."""
        return tuple(int(part) for part in self.name.split(".")[:2]) >= (4, 2)


def debian() -> Blender:
    """Debian's own."""
    program = Path(os.environ.get("BLENDER") or "/usr/bin/blender")
    version = subprocess.run([str(program), "--version"], check=True, capture_output=True, text=True).stdout.split()[1]
    return Blender(version, program)


def of_release(release: str) -> Blender:
    """The Blender of another Debian. Raises debian_releases.Unavailable."""
    program = debian_releases.installed(release, CACHE, [ROOT])
    said = subprocess.run([str(program), "--version"], check=True, capture_output=True, text=True).stdout
    version = next(line.split()[1] for line in said.splitlines() if line.startswith("Blender "))
    return Blender(f"{version} (Debian {release})", program, has_commands=True)


def called(name: str) -> Blender:
    """The Blender that `rayleaf test compat` knows by this name."""
    if name == "debian":
        return debian()
    return of_release(name) if name in RELEASES else module(name)


def module(version: str) -> Blender:
    """`bpy` of a version in a virtual environment, with a launcher that takes Blender's arguments."""
    folder = CACHE / f"bpy-{version}"
    python = folder / "bin" / "python"
    if not (folder / "complete").is_file():
        subprocess.run([interpreter(MODULES[version]), "-m", "venv", "--clear", str(folder)], check=True)
        subprocess.run([str(python), "-m", "pip", "install", "--quiet", f"bpy=={version}.*"], check=True)
        (folder / "complete").touch()
    package = next(folder.glob("lib/python*/site-packages/bpy"))
    launcher = folder / "blender"
    launcher.write_text(f'#!/bin/sh\nexport BLENDER_OF_MODULE="{launcher}"\nexec "{python}" "{LAUNCHER}" "$@"\n')
    launcher.chmod(launcher.stat().st_mode | stat.S_IXUSR)
    libraries = sorted(each for each in (package / "lib").glob("*.so*") if each.name.startswith(FOREIGN))
    (information,) = package.parent.glob("bpy-*.dist-info")
    return Blender(
        information.name.removeprefix("bpy-").removesuffix(".dist-info"), launcher, tuple(libraries), is_module=True
    )


def interpreter(version: str) -> str:
    """A Python of a version that can make virtual environments."""
    candidates = [
        "/usr/bin/python3",
        f"python{version}",
        *map(str, Path.home().glob(f".pyenv/versions/{version}.*/bin/python")),
    ]
    question = "import sys, ensurepip; print('%d.%d' % sys.version_info[:2])"
    for candidate in candidates:
        try:
            found = subprocess.run([candidate, "-c", question], capture_output=True, text=True).stdout.strip()
        except FileNotFoundError:
            continue
        if found == version:
            return candidate
    sys.exit(f"bpy wants Python {version} with venv, which is not here (Debian: python{version}-venv; or pyenv)")
