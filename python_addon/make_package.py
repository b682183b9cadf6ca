"""Packs the built add-on for people's own Blenders. Usage: make_package.py PACKAGE_FOLDER OUTPUT_FOLDER."""

import re
import sys
import zipfile
from pathlib import Path


def version_of(package: Path) -> str:
    """The version in the extension manifest."""
    match = re.search(r'^version = "(.+)"', (package / "blender_manifest.toml").read_text(), re.MULTILINE)
    if match is None:
        raise ValueError(f"{package}/blender_manifest.toml names no version")
    return match[1]


def python_tag(package: Path) -> str:
    """Python and machine of the built module, as its file name says: cpython-311-x86_64-linux-gnu."""
    modules = sorted(package.glob("_core.*.so"))
    if len(modules) != 1:
        raise FileNotFoundError(f"{package} should hold one built module, not {len(modules)}")
    return modules[0].name.split(".")[1]


def pack(package: Path, archive: Path) -> None:
    """Write the zip: one folder `rayleaf`, links resolved, no caches, no type stubs."""
    archive.parent.mkdir(parents=True, exist_ok=True)
    with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED) as file:
        for path in sorted(package.rglob("*")):
            if path.is_file() and "__pycache__" not in path.parts and path.suffix != ".pyi":
                file.write(path.resolve(), Path("rayleaf") / path.relative_to(package))


def main() -> None:
    package, output = Path(sys.argv[1]), Path(sys.argv[2])
    archive = output / f"rayleaf-{version_of(package)}-{python_tag(package)}.zip"
    pack(package, archive)
    print(
        f"""{archive}

Install it in a Blender whose Python has the same version, on a machine with the same system libraries:
  Blender 3.4 to 4.1   Edit > Preferences > Add-ons > Install..., choose the zip, tick "Render: Rayleaf"
  Blender 4.2 and up   Edit > Preferences > Add-ons > arrow at the top right > Install from Disk..., choose the zip
Then choose Rayleaf under Render Properties > Render Engine."""
    )


if __name__ == "__main__":
    main()
