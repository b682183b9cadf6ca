"""Finds the compiled core: beside the add-on, or in the wheel of the extension; says in plain words why it does not load."""

import importlib
import importlib.machinery
import importlib.util
import os
import platform
import re
import sys
from pathlib import Path
from types import ModuleType

from . import __version__

_AGAIN = "Install Rayleaf's zip again."


class CoreError(Exception):
    """The core cannot be used here; the text is meant for people who render."""


def load() -> ModuleType:
    """The compiled core. Raises CoreError."""
    folder, package = _place()
    _check_machine()
    if not any(folder.glob("_core.*.so")):
        raise CoreError(f"Rayleaf's compiled core is missing in {folder}. {_AGAIN}")
    try:
        core = importlib.import_module(f"{package}._core")
    except ImportError as error:
        raise CoreError(_explained(error, folder)) from error
    if core.__version__ != __version__:
        raise CoreError(
            f"This add-on is Rayleaf {__version__}, its core {core.__version__}. Start Blender again; if that does not "
            "help, install Rayleaf's zip again."
        )
    return core


def loaded() -> ModuleType | None:
    """The core if it has been loaded."""
    _, package = _place()
    return sys.modules.get(f"{package}._core")


def path() -> Path:
    """The file that `load` will load, or the folder where it should be."""
    folder, _ = _place()
    candidates = [folder / f"_core{suffix}" for suffix in importlib.machinery.EXTENSION_SUFFIXES]
    return next((each for each in candidates if each.exists()), folder)


def _place() -> tuple[Path, str]:
    """The folder that holds the core, and the package that it is a part of there."""
    here = Path(__file__).parent
    if not any(here.glob("_core.*.so")) and (wheel := importlib.util.find_spec("rayleaf_core")) is not None:
        for folder in wheel.submodule_search_locations or ():
            return Path(folder), "rayleaf_core"
    return here, __package__


def _check_machine() -> None:
    system, machine = platform.system(), platform.machine()
    if (system, machine) != ("Linux", "x86_64"):
        raise CoreError(f"Rayleaf's package is for Linux on x86-64, and this is {system} on {machine}.")
    flags = _processor_flags()
    if flags and "sse4_2" not in flags:
        raise CoreError("This processor is too old for Rayleaf, which needs SSE4.2 (processors from 2009 on have it).")


def _processor_flags() -> set[str]:
    try:
        found = re.search(r"^flags\s*:(.*)$", Path("/proc/cpuinfo").read_text(), re.MULTILINE)
    except OSError:
        return set()
    return set(found[1].split()) if found else set()


def _explained(raised: ImportError, folder: Path) -> str:
    """A sentence for what Python or the loader said."""
    error = str(raised)
    if isinstance(raised, ModuleNotFoundError) and (raised.name or "").endswith("._core"):
        return _for_another_python(folder)
    if found := re.search(r"version `((GLIBC|GLIBCXX|CXXABI)_[\d.]+)' not found", error):
        library = "C library (glibc)" if found[2] == "GLIBC" else "C++ library (libstdc++)"
        has = f", this system has {os.confstr('CS_GNU_LIBC_VERSION')}" if found[2] == "GLIBC" else ""
        return (
            f"This Linux is too old for Rayleaf: its {library} lacks {found[1]}{has}. Rayleaf needs one like Debian 12."
        )
    if "needs NumPy" in error:
        return (
            "Rayleaf needs NumPy, which this Blender's Python lacks. Install it; in Debian, the package python3-numpy."
        )
    if found := re.search(r"^(\S+): cannot open shared object file", error):
        return f"Rayleaf's library {found[1]} is missing. {_AGAIN}"
    if re.search(
        r"invalid ELF header|file too short|ELF file's phentsize|ELF load command|cannot read file data", error
    ):
        return f"Rayleaf's files in {folder} are damaged. {_AGAIN}"
    return f"Rayleaf's core cannot be loaded: {error}"


def _for_another_python(folder: Path) -> str:
    versions = {found[1] for each in folder.glob("_core.*.so") if (found := re.search(r"\.cpython-(\d+)-", each.name))}
    names = " and ".join(f"{version[0]}.{version[1:]}" for version in sorted(versions))
    here = f"{sys.version_info[0]}.{sys.version_info[1]}"
    return (
        f"This package of Rayleaf is for Blenders with Python {names}; this one has {here}. Install the package for it."
    )
