"""What a real Blender does with a damaged extension, where it can write nothing, and with an upgrade while it runs.

A sentence each time, and it stays alive.
"""

import re
import zipfile
from collections.abc import Callable
from pathlib import Path

import blenders
from extension_commands import Commands

_AGAIN = "Install Rayleaf's zip again"
_MODULE = "bl_ext.user_default.rayleaf"
_NEWER = "9.8.7"
_FIRST_WITHOUT = "4.2.1"
_UPGRADE_AND_RENDER = """
import sys, bpy
scene = bpy.context.scene
scene.render.engine = "RAYLEAF"
scene.render.resolution_percentage, scene.rayleaf.samples = 5, 1
bpy.ops.render.render()
bpy.ops.extensions.package_install_files(
    filepath=sys.argv[-1], repo="user_default", enable_on_install=True, overwrite=True)
try:
    bpy.ops.render.render()
except RuntimeError as error:
    print(error)
print("STILL THERE")
"""


def spoilt(extension: Path, target: Path, spoil: Callable[[bytes], bytes]) -> Path:
    """A copy whose wheel has been spoilt."""
    with zipfile.ZipFile(extension) as source, zipfile.ZipFile(target, "w") as copy:
        for name in source.namelist():
            content = source.read(name)
            copy.writestr(name, spoil(content) if name.endswith(".whl") else content)
    return target


def cut_in_half(wheel: bytes) -> bytes:
    """As a download that broke off."""
    return wheel[: len(wheel) // 2]


def overwritten(wheel: bytes) -> bytes:
    """Some blocks of it lost."""
    middle = len(wheel) // 2
    return wheel[:middle] + bytes(4096) + wheel[middle + 4096 :]


def with_value(extension: Path, target: Path, names: str, value: str) -> Path:
    """A copy in whose manifest and `__init__` what has one of these names (a regular expression) has another value."""
    with zipfile.ZipFile(extension) as source, zipfile.ZipFile(target, "w") as copy:
        for name in source.namelist():
            content = source.read(name)
            if name in ("__init__.py", "blender_manifest.toml"):
                line = rf'^({names}) = ".+"'
                content = re.sub(line, rf'\1 = "{value}"', content.decode(), flags=re.MULTILINE).encode()
            copy.writestr(name, content)
    return target


def newer(extension: Path, target: Path) -> Path:
    """A copy of a version to come, whose core a Blender that runs the present one cannot load."""
    return with_value(extension, target, "__version__|version", _NEWER)


def for_older_blenders(extension: Path, target: Path) -> Path:
    """A copy that no Blender of today is meant to take."""
    return with_value(extension, target, "blender_version_max", _FIRST_WITHOUT)


def faults(blender: blenders.Blender, extension: Path, folder: Path) -> list[str]:
    """What was said in place of a sentence."""
    folder.mkdir()
    found = []
    for number, spoil in enumerate((cut_in_half, overwritten)):
        commands = Commands(blender, folder / f"user{number}")
        damaged = spoilt(extension, folder / f"{spoil.__name__}.zip", spoil)
        said = commands.extension("install-file", "--repo", "user_default", "--enable", damaged)
        said += commands.render(_MODULE)
        if _AGAIN not in said or "exit code -" in said:
            found.append(f"a wheel {spoil.__name__.replace('_', ' ')}: {said}")
    commands = Commands(blender, folder / "user")
    said = commands.where_nothing_can_be_written("install-file", "--repo", "user_default", "--enable", extension)
    if "Read-only file system" not in said or "exit code -" in said:
        found.append(f"a folder of extensions that cannot be written: {said}")
    commands = Commands(blender, folder / "older")
    old = for_older_blenders(extension, folder / "older.zip")
    said = commands.extension("install-file", "--repo", "user_default", "--enable", old)
    if f"must be less than the maximum version ({_FIRST_WITHOUT})" not in said or "exit code -" in said:
        found.append(f"an extension for older Blenders: {said}")
    commands = Commands(blender, folder / "upgraded")
    commands.extension("install-file", "--repo", "user_default", "--enable", extension)
    upgrade = newer(extension, folder / "newer.zip")
    said = commands.start("--background", "--addons", _MODULE, "--python-expr", _UPGRADE_AND_RENDER, "--", upgrade)
    if f"This add-on is Rayleaf {_NEWER}, its core" not in said or "STILL THERE" not in said or "exit code -" in said:
        found.append(f"an upgrade over a running one: {said}")
    return found
