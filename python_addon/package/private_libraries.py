"""Makes a module and the libraries that it needs a set of their own, which no other library of the process can meddle with.

A Blender from blender.org has its own Embree, OpenImageIO, OpenSubdiv and TBB in the global scope. The loader looks
there first, so names alone decide whose function is called. Hence every dynamic symbol of the copies, and every library's
name, gets a name that nobody else has.
"""

import hashlib
import shutil
import subprocess
import tempfile
from pathlib import Path

import elf

PREFIX = "rayleaf_"
FOLDER = "libraries"  # beside the module
# TBB looks for these among the libraries of the process and on disk, by name, and would call what it finds.
_COMPANIONS_OF_TBB = {b"libtbbmalloc": b"no-allocator", b"libtbbbind": b"no-binding"}


def library_path(name: str, folders: list[Path]) -> Path:
    """Where a library lies: in one of the folders, or where the compiler finds it."""
    for folder in folders:
        if (folder / name).is_file():
            return (folder / name).resolve()
    found = subprocess.run(
        ["g++", f"-print-file-name={name}"], check=True, capture_output=True, text=True
    ).stdout.strip()
    if not Path(found).is_absolute():
        raise FileNotFoundError(f"{name}, which Rayleaf's module needs, is not on this machine")
    return Path(found).resolve()


def closure(modules: list[Path], folders: list[Path]) -> dict[str, Path]:
    """Every library that the modules need, directly or not, without the system's; by the name that it is needed by."""
    found: dict[str, Path] = {}
    waiting = list(modules)
    while waiting:
        for name in elf.needed(waiting.pop()):
            if name not in elf.SYSTEM_LIBRARIES and name not in found:
                found[name] = library_path(name, folders)
                waiting.append(found[name])
    return found


def private_names(modules: list[Path], libraries: list[Path]) -> dict[str, str]:
    """New names of all symbols that the set defines or wants, except what the system, Python or Blender must see."""
    own: set[str] = set()
    shared: set[str] = set()
    for library in [*modules, *libraries]:
        for symbol in elf.symbols(library):
            public = symbol.from_system or library in modules and (symbol.defined or symbol.from_python)
            (shared if public else own).add(symbol.name)
    return {name: PREFIX + name for name in sorted(own - shared)}


def private_soname(name: str, library: Path) -> str:
    """A name that tells the library and its content: two versions of Rayleaf in one process never share one by mistake."""
    digest = hashlib.sha256(library.read_bytes()).hexdigest()[:8]
    return f"{PREFIX}{name.split('.so')[0]}-{digest}.so"


def cut_off_companions(library: Path) -> None:
    """Leave TBB without the libraries that it looks for at run time; it works without, as it does where they are missing."""
    content = library.read_bytes()
    for name, nothing in _COMPANIONS_OF_TBB.items():
        content = content.replace(name, nothing)
    library.write_bytes(content)


def make_private(modules: list[Path], folders: list[Path], patchelf: Path, output: Path) -> None:
    """Write the modules and their `libraries` into `output`. `folders` are searched for libraries first."""
    libraries = closure(modules, folders)
    sonames = {name: private_soname(name, library) for name, library in libraries.items()}
    (output / FOLDER).mkdir(parents=True)
    with tempfile.NamedTemporaryFile("w") as table:
        for old, new in private_names(modules, list(libraries.values())).items():
            table.write(f"{old} {new}\n")
        table.flush()
        command = [str(patchelf), "--rename-dynamic-symbols", table.name]
        for pair in sonames.items():
            command += ["--replace-needed", *pair]
        for name, library in libraries.items():
            copy = stripped_copy(library, output / FOLDER / sonames[name])
            subprocess.run([*command, "--set-soname", sonames[name], "--set-rpath", "$ORIGIN", str(copy)], check=True)
            if name.startswith("libtbb.so"):
                cut_off_companions(copy)
        for module in modules:
            copy = stripped_copy(module, output / module.name)
            subprocess.run([*command, "--set-rpath", f"$ORIGIN/{FOLDER}", str(copy)], check=True)


def stripped_copy(library: Path, copy: Path) -> Path:
    """A copy without what only debuggers read."""
    shutil.copyfile(library, copy)
    subprocess.run(["strip", "--strip-unneeded", str(copy)], check=True)
    return copy
