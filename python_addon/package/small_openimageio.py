"""Fetches the OpenImageIO that the package carries.

Debian's links a hundred libraries, among them video codecs and computer vision. The one of Python's package index has its
formats inside, but comes without headers; those are in the source archive of the same version. They go into the
folders lib, include and licences.
"""

import re
import shutil
import tarfile
import tempfile
import zipfile
from pathlib import Path

import package_index

VERSION = "3.2.2.0"
REQUIREMENT = (
    f"openimageio=={VERSION}"
    " --hash=sha256:1133b6a6c04270398c419804e0d293b2bb3ce2d7607a17724cc45f385036b05b"  # manylinux_2_28_x86_64, cp311
    " --hash=sha256:d66c829016b4f092c443b7f7896f06d0ab6af02a103d635d1b0b841c14bfd7c1"  # sources
)
_SOURCES = ("--no-binary=openimageio",)
# What CMake writes into oiioversion.h where the wheel is built.
_MAJOR, _MINOR, _PATCH, _TWEAK = VERSION.split(".")
_CONFIGURED = {
    "PROJECT_VERSION_MAJOR": _MAJOR,
    "PROJECT_VERSION_MINOR": _MINOR,
    "PROJECT_VERSION_PATCH": _PATCH,
    "PROJECT_VERSION_TWEAK": _TWEAK,
    "PROJECT_VERSION_RELEASE_TYPE": "",
    "OIIO_USE_COMPILED_FMT_VALUE": "0",
    "PROJ_NAMESPACE": "OpenImageIO",
    "PROJ_VERSION_NAMESPACE": f"v{_MAJOR}_{_MINOR}",
    "Imath_VERSION_MAJOR": "3",
    "Imath_VERSION_MINOR": "1",
    "CMAKE_CXX_STANDARD": "17",
}
_FMT = Path("/usr/include/fmt")  # libfmt-dev: OpenImageIO's headers use it as headers alone


def unpack_library(wheel: Path, folder: Path) -> None:
    """The two libraries, under the names that the linker looks for, and the licences of what is inside them."""
    (folder / "lib").mkdir()
    (folder / "licences").mkdir()
    with zipfile.ZipFile(wheel) as archive:
        for name in archive.namelist():
            if re.search(r"/lib/libOpenImageIO[^/]*\.so", name):
                library = folder / "lib" / Path(name).name
                library.write_bytes(archive.read(name))
                (folder / "lib" / (library.name.split(".")[0] + ".so")).symlink_to(library.name)
            elif re.search(r"/licenses/[^/]+$", name):
                (folder / "licences" / Path(name).name).write_bytes(archive.read(name))


def configured(template: str) -> str:
    """The header that CMake makes of its template."""
    text = re.sub(r"#cmakedefine01 (\w+)", r"#define \1 0", template)
    return re.sub(r"@(\w+)@", lambda name: _CONFIGURED[name[1]], text)


def unpack_headers(sources: Path, folder: Path) -> None:
    """The public headers, oiioversion.h as it was configured, and fmt where OpenImageIO looks for its own copy."""
    include = folder / "include"
    with tarfile.open(sources) as archive:
        for member in archive:
            found = re.search(r"/src/include/(OpenImageIO/.+\.h)(\.in)?$", member.name)
            content = archive.extractfile(member) if found else None
            if found is None or content is None:
                continue
            header = include / found[1]
            header.parent.mkdir(parents=True, exist_ok=True)
            text = content.read().decode()
            header.write_text(configured(text) if found[2] else text)
    (include / "OpenImageIO/detail/fmt").symlink_to(_FMT)


def fetch(folder: Path) -> None:
    """Fill `folder`, unless it holds this version."""
    stamp = folder / "requirement"
    if stamp.is_file() and stamp.read_text() == REQUIREMENT:
        return
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    with tempfile.TemporaryDirectory() as downloads:
        unpack_library(package_index.download(REQUIREMENT, package_index.WHEEL, Path(downloads) / "wheel"), folder)
        unpack_headers(package_index.download(REQUIREMENT, _SOURCES, Path(downloads) / "sources"), folder)
    (folder / "version").write_text(VERSION)
    stamp.write_text(REQUIREMENT)
