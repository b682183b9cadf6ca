"""Blenders of other Debian releases: a bare system of each in a folder, and a launcher that runs its Blender there. Wants root."""

import os
import shutil
import stat
import subprocess
from pathlib import Path

MIRROR = "http://deb.debian.org/debian"
# The launcher mounts these there, in a file system tree of its own that ends with it.
SHARED = ("/tmp", "/proc", "/dev")

_LAUNCHER = """#!/bin/bash
# Blender of Debian {release}, which sees the folders of this machine that tests use at their own paths.
mount_and_run() {{
    for folder in {shared}; do
        mkdir -p "{system}$folder"
        mount --rbind "$folder" "{system}$folder"
    done
    exec chroot "{system}" /usr/bin/env --chdir="$PWD" /usr/bin/blender "$@"
}}
export -f mount_and_run
exec unshare --mount /bin/bash -c 'mount_and_run "$@"' blender "$@"
"""


class Unavailable(Exception):
    """Why there is no such Blender here."""


def installed(release: str, cache: Path, folders: list[Path]) -> Path:
    """A launcher of the release's Blender; `folders`: what it is to see besides SHARED. Raises Unavailable."""
    system = cache / f"debian-{release}"
    if os.geteuid() != 0:
        raise Unavailable(f"Debian {release} is set up by root alone")
    if not (system / "complete").is_file():
        make(release, system)
    launcher = cache / f"blender-of-{release}"
    shared = " ".join([*SHARED, *(f"'{folder}'" for folder in folders)])
    launcher.write_text(_LAUNCHER.format(release=release, system=system, shared=shared))
    launcher.chmod(launcher.stat().st_mode | stat.S_IXUSR)
    return launcher


def make(release: str, system: Path) -> None:
    """Fetch a minimal system and its Blender. Raises Unavailable with the last words of what failed."""
    if shutil.which("debootstrap") is None:
        raise Unavailable("debootstrap is not installed")
    system.parent.mkdir(parents=True, exist_ok=True)
    keys = ["--no-check-gpg"] if release == "sid" else []  # signed by keys that Debian 12 need not know
    # The extensions of Debian's 5.2 import the next two, which its package does not ask for; tests of windows
    # press keys, and later Blenders load OpenGL when they first draw.
    packages = ["blender", "python3-numpy", "python3-cattr", "python3-requests", "xdotool"]
    packages += ["libegl1", "libgl1", "libgl1-mesa-dri"]
    install = ["apt-get", "-q", "-y", "install", "--no-install-recommends", *packages]
    for command in (
        ["debootstrap", "--variant=minbase", *keys, release, str(system), MIRROR],
        ["chroot", str(system), "/usr/bin/env", "DEBIAN_FRONTEND=noninteractive", *install],
    ):
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode != 0:
            raise Unavailable(f"{command[0]}: {(done.stdout + done.stderr).strip()[-300:]}")
        resolver = system / "etc" / "resolv.conf"
        resolver.unlink(missing_ok=True)
        shutil.copyfile("/etc/resolv.conf", resolver)
        starts = system / "usr" / "sbin" / "policy-rc.d"  # nothing that is installed there is started
        starts.write_text("#!/bin/sh\nexit 101\n")
        starts.chmod(0o755)
    (system / "complete").touch()
