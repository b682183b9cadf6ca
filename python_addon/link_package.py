"""Link the add-on's sources and data into the build folder that Blender reads. Usage: link_package.py SOURCE_ROOT PACKAGE."""

import os
import sys
from pathlib import Path


def link_tree(source: Path, package: Path) -> None:
    """Make `package` mirror the files of `source` by symbolic links, and drop links whose file is gone."""
    wanted = {
        file.relative_to(source) for file in source.rglob("*") if file.is_file() and "__pycache__" not in file.parts
    }
    for relative in wanted:
        link = package / relative
        link.parent.mkdir(parents=True, exist_ok=True)
        if not (link.is_symlink() and os.readlink(link) == str(source / relative)):
            link.unlink(missing_ok=True)
            link.symlink_to(source / relative)
    for link in package.rglob("*"):
        if link.is_symlink() and not link.exists():
            link.unlink()


def main() -> None:
    root, package = Path(sys.argv[1]), Path(sys.argv[2])
    link_tree(root / "python_addon" / "rayleaf", package)
    table = package / "passes.def"
    table.unlink(missing_ok=True)
    table.symlink_to(root / "core" / "film" / "passes.def")


if __name__ == "__main__":
    main()
