"""Libraries that other people's programs put before ours, as Blender's own lie before an add-on's, change nothing.

Rather than Blender's, which answer some calls rightly, a library is put in front that has every name of Embree,
OpenImageIO, OpenSubdiv and TBB and ends the process whenever one of them is called.
"""

import os
import subprocess
import sys
from pathlib import Path

import pytest

SCENE = Path(__file__).with_name("render_scene.py")


def defined(library: Path) -> set[str]:
    """The functions and data that a library shows, without versions."""
    listing = subprocess.run(["nm", "-D", "--defined-only", str(library)], check=True, capture_output=True, text=True)
    return {line.split()[-1].partition("@")[0] for line in listing.stdout.splitlines() if " A " not in line}


def needed_paths(module: Path) -> dict[str, Path]:
    """Where the loader finds each library that a module needs."""
    listing = subprocess.run(["ldd", str(module)], check=True, capture_output=True, text=True).stdout
    pairs = (line.split("=>") for line in listing.splitlines() if "=> /" in line)
    return {name.strip(): Path(path.split()[0]) for name, path in pairs}


@pytest.fixture(scope="module")
def hostile(addons: Path, root: Path, zips, tmp_path_factory) -> Path:
    """The library in front."""
    (module,) = (addons / "rayleaf").glob("_core.*.so")
    libraries = needed_paths(module)
    system = set().union(
        *(defined(libraries[name]) for name in ("libc.so.6", "libm.so.6", "libstdc++.so.6", "libgcc_s.so.1"))
    )
    wanted = [
        path for name, path in libraries.items() if name.startswith(("libembree", "libosd", "libtbb", "libOpenImageIO"))
    ]
    names = set().union(*map(defined, [*wanted, *(root / "build" / "openimageio" / "lib").glob("*.so")])) - system
    assert {"rtcIntersect1", "rtcCommitScene"} < names and len(names) > 2000
    folder = tmp_path_factory.mktemp("hostile")
    lines = "".join(
        f'.globl "{name}"\n.type "{name}", @function\n"{name}":\n' for name in sorted(names - {"_init", "_fini"})
    )
    source = folder / "hostile.s"
    source.write_text(f'.text\n{lines}ud2\n.section .note.GNU-stack,"",@progbits\n')
    library = folder / "libhostile.so"
    subprocess.run(["gcc", "-shared", "-o", str(library), str(source)], check=True)
    return library


def rendered(addons: Path, preload: Path | None) -> subprocess.CompletedProcess[str]:
    """The hash of the scene's picture, by the module in a folder."""
    environment = {name: value for name, value in os.environ.items() if name != "LD_PRELOAD"}
    if preload is not None:
        environment["LD_PRELOAD"] = str(preload)
    return subprocess.run([sys.executable, str(SCENE), str(addons)], env=environment, capture_output=True, text=True)


def test_the_package_renders_the_same_bits_with_foreign_libraries_in_front(installed, hostile):
    plain = rendered(installed / "addons", None)
    assert plain.returncode == 0, plain.stderr
    surrounded = rendered(installed / "addons", hostile)
    assert surrounded.returncode == 0, surrounded.stderr
    assert surrounded.stdout == plain.stdout


def test_a_module_linked_plainly_falls_to_the_same_libraries(addons, hostile):
    assert rendered(addons, None).returncode == 0
    assert rendered(addons, hostile).returncode < 0


def test_the_package_renders_what_the_development_build_renders(addons, installed):
    assert rendered(installed / "addons", None).stdout == rendered(addons, None).stdout
