"""What a real Blender does with a damaged extension, and where it can write nothing: a sentence, and it stays alive."""

import zipfile
from collections.abc import Callable
from pathlib import Path

import blenders
from extension_commands import Commands

_AGAIN = "Install Rayleaf's zip again"


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


def faults(blender: blenders.Blender, extension: Path, folder: Path) -> list[str]:
    """What was said in place of a sentence."""
    folder.mkdir()
    found = []
    for number, spoil in enumerate((cut_in_half, overwritten)):
        commands = Commands(blender, folder / f"user{number}")
        damaged = spoilt(extension, folder / f"{spoil.__name__}.zip", spoil)
        said = commands.extension("install-file", "--repo", "user_default", "--enable", damaged)
        said += commands.render("bl_ext.user_default.rayleaf")
        if _AGAIN not in said or "exit code -" in said:
            found.append(f"a wheel {spoil.__name__.replace('_', ' ')}: {said}")
    commands = Commands(blender, folder / "user")
    said = commands.where_nothing_can_be_written("install-file", "--repo", "user_default", "--enable", extension)
    if "Read-only file system" not in said or "exit code -" in said:
        found.append(f"a folder of extensions that cannot be written: {said}")
    return found
