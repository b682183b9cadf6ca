"""What a shared library shows and wants, as binutils tell it."""

import subprocess
from dataclasses import dataclass
from pathlib import Path

# What every Linux that runs Blender has: the C and C++ libraries and the loader. All else is a third party's.
SYSTEM_LIBRARIES = {
    *("libc.so.6", "libm.so.6", "libpthread.so.0", "libdl.so.2", "librt.so.1", "ld-linux-x86-64.so.2"),
    *("libstdc++.so.6", "libgcc_s.so.1"),
}
# Their symbols carry these versions.
_SYSTEM_VERSIONS = ("GLIBC_", "GLIBCXX_", "CXXABI_", "GCC_")
# What the compiler asks for if somebody has it: transactional memory, profiling.
_COMPILER_HOOKS = {"_ITM_deregisterTMCloneTable", "_ITM_registerTMCloneTable", "__gmon_start__"}


@dataclass(frozen=True)
class Symbol:
    """A dynamic symbol; `version` is empty where it has none."""

    name: str
    version: str
    defined: bool

    @property
    def from_system(self) -> bool:
        """True if the system's libraries, or nobody, answer it."""
        return not self.defined and (self.version.startswith(_SYSTEM_VERSIONS) or self.name in _COMPILER_HOOKS)

    @property
    def from_python(self) -> bool:
        """True if Python itself answers it."""
        return not self.defined and self.name.startswith(("Py", "_Py"))


def symbols(library: Path) -> list[Symbol]:
    """All dynamic symbols, defined ones and wanted ones."""
    listing = subprocess.run(["nm", "-D", str(library)], check=True, capture_output=True, text=True).stdout
    found = []
    for line in listing.splitlines():
        kind, full_name = line[17:].split()
        name, _, version = full_name.partition("@")
        found.append(Symbol(name, version.lstrip("@"), kind not in "Uwv"))
    return found


def needed(library: Path) -> list[str]:
    """The names of the libraries that the loader will look for."""
    return _dynamic_entries(library, "NEEDED")


def soname(library: Path) -> str | None:
    """The name under which the loader knows it."""
    names = _dynamic_entries(library, "SONAME")
    return names[0] if names else None


def _dynamic_entries(library: Path, kind: str) -> list[str]:
    listing = subprocess.run(["readelf", "-dW", str(library)], check=True, capture_output=True, text=True).stdout
    return [line.split("[")[1].split("]")[0] for line in listing.splitlines() if f"({kind})" in line]
