"""The finished module and the libraries beside it answer each other, and nobody else in the process answers them."""

import re
import subprocess
from pathlib import Path

import pytest

PREFIX = "rayleaf_"
SYSTEM_LIBRARIES = r"lib(c|m|dl|rt|pthread|stdc\+\+|gcc_s)\.so\.\d+|ld-linux-x86-64\.so\.2"
SYSTEM_VERSIONS = ("GLIBC_", "GLIBCXX_", "CXXABI_", "GCC_")
COMPILER_HOOKS = {"_ITM_deregisterTMCloneTable", "_ITM_registerTMCloneTable", "__gmon_start__"}
OLDEST = {"GLIBC": (2, 36), "GLIBCXX": (3, 4, 30), "CXXABI": (1, 3, 13)}  # Debian 12's


def dynamic_symbols(library: Path) -> list[tuple[str, str, bool]]:
    """Name, version and whether it is defined, of every symbol that the loader sees."""
    command = ["readelf", "--dyn-syms", "--wide", str(library)]
    found = []
    for line in subprocess.run(command, check=True, capture_output=True, text=True).stdout.splitlines():
        fields = line.split()
        if len(fields) >= 8 and fields[0].rstrip(":").isdigit() and fields[4] != "LOCAL":
            name, _, version = fields[7].partition("@")
            found.append((name, version.lstrip("@"), fields[6] != "UND"))
    return found


def needed(library: Path) -> list[str]:
    """What the loader looks for."""
    listing = subprocess.run(
        ["readelf", "--dynamic", "--wide", str(library)], check=True, capture_output=True, text=True
    )
    return re.findall(r"\(NEEDED\).*\[(.+)\]", listing.stdout)


def foreign(files: list[Path]) -> list[str]:
    """Each symbol and library that somebody else in the process could answer for these files."""
    symbols = {path: dynamic_symbols(path) for path in files}
    own = {name for each in symbols.values() for name, _, defined in each if defined and name.startswith(PREFIX)}
    strange = []
    for path, each in symbols.items():
        is_module = path.name.startswith("_core.")
        for name, version, defined in each:
            if defined:
                fine = name.startswith(PREFIX) or is_module and name == "PyInit__core"
            else:
                from_python = is_module and name.startswith(("Py", "_Py"))
                # Weak ones that nobody answers are private too: their name is nobody's.
                fine = name in own or name.startswith(PREFIX) or version.startswith(SYSTEM_VERSIONS) or from_python
            if not fine and name not in COMPILER_HOOKS:
                strange.append(f"{path.name}: {name}")
        names = {other.name for other in files}
        strange += [f"{path.name} needs {name}" for name in needed(path)
                    if not re.fullmatch(SYSTEM_LIBRARIES, name) and name not in names]  # fmt: skip
    return strange


@pytest.fixture(scope="module")
def files(installed: Path) -> list[Path]:
    """The module and its libraries."""
    add_on = installed / "addons" / "rayleaf"
    found = [*add_on.glob("_core.*.so"), *(add_on / "libraries").glob("*.so")]
    assert len(found) > 5
    return found


def test_no_third_party_symbol_can_be_answered_by_blender(files):
    assert foreign(files) == []


def test_the_check_sees_what_a_module_linked_plainly_wants_from_others(addons):
    (module,) = (addons / "rayleaf").glob("_core.*.so")
    strange = foreign([module])
    for wanted in ("rtcIntersect1", "OpenImageIO", "OpenSubdiv", "3tbb", "needs libembree"):
        assert any(wanted in each for each in strange), wanted


def test_the_package_asks_for_no_newer_system_than_it_says(files):
    newest = {}
    for path in files:
        for _, version, defined in dynamic_symbols(path):
            name, _, number = version.partition("_")
            if not defined and name in OLDEST and number[:1].isdigit():
                newest[name] = max(newest.get(name, (0,)), tuple(int(part) for part in number.split(".")))
    assert newest.keys() == OLDEST.keys()
    assert {name: number for name, number in newest.items() if number > OLDEST[name]} == {}


def test_no_library_has_a_name_that_another_could_have(files):
    assert [
        path.name for path in files if not re.fullmatch(rf"_core\..*|{PREFIX}\S+-[0-9a-f]{{8}}\.so", path.name)
    ] == []
