"""Writes a wheel: a zip of files with a table of their hashes, as Python's packaging standard has it."""

import base64
import hashlib
import zipfile
from pathlib import Path

_METADATA = """Metadata-Version: 2.1
Name: rayleaf-core
Version: {version}
Summary: The compiled core of Rayleaf, a render engine for Blender
License: GPL-3.0-or-later
"""
_WHEEL = """Wheel-Version: 1.0
Generator: rayleaf package
Root-Is-Purelib: false
"""


def wheel_name(version: str, pythons: list[str], platform: str) -> str:
    """`pythons`: those that the modules inside fit, like cp311."""
    return f"rayleaf_core-{version}-{'.'.join(pythons)}-none-{platform}.whl"


def write_wheel(core: Path, version: str, pythons: list[str], platform: str, folder: Path) -> Path:
    """A wheel with the package `rayleaf_core`: the files of `core`, and an empty __init__.py."""
    information = f"rayleaf_core-{version}.dist-info"
    tags = "".join(f"Tag: {python}-none-{platform}\n" for python in pythons)
    contents = {
        "rayleaf_core/__init__.py": b'"""The compiled core of Rayleaf."""\n',
        f"{information}/METADATA": _METADATA.format(version=version).encode(),
        f"{information}/WHEEL": (_WHEEL + tags).encode(),
    }
    for path in sorted(core.rglob("*")):
        if path.is_file():
            contents[f"rayleaf_core/{path.relative_to(core)}"] = path.read_bytes()
    record = "".join(f"{name},{_digest(content)},{len(content)}\n" for name, content in contents.items())
    contents[f"{information}/RECORD"] = (record + f"{information}/RECORD,,\n").encode()
    wheel = folder / wheel_name(version, pythons, platform)
    with zipfile.ZipFile(wheel, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as archive:
        for name, content in contents.items():
            archive.writestr(name, content)
    return wheel


def _digest(content: bytes) -> str:
    digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).decode().rstrip("=")
    return f"sha256={digest}"
