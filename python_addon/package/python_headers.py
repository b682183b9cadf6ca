"""Fetches the headers of a Python that this Debian has not, from the Debian release that has it. Usage: VERSION FOLDER.

Modules need no library of Python's: what they leave undefined is answered by the Python that loads them.
"""

import hashlib
import lzma
import re
import shutil
import subprocess
import sys
import tempfile
import urllib.error
import urllib.request
from pathlib import Path

MIRROR = "https://deb.debian.org/debian"
RELEASES = {"3.13": "trixie", "3.14": "forky"}  # Debian 13 and 14
_PATIENCE = 60  # seconds without an answer


class Unavailable(Exception):
    """Why the headers cannot be had."""


def fetch(version: str, folder: Path) -> None:
    """Unpack the headers as FOLDER/include, unless they are there. Raises Unavailable."""
    if (folder / "complete").is_file():
        return
    if version not in RELEASES:
        raise Unavailable(f"no Debian release with Python {version} is known")
    try:
        path, digest = listed(downloaded(f"dists/{RELEASES[version]}/main/binary-amd64/Packages.xz"), version)
        package = downloaded(path)
    except (urllib.error.URLError, TimeoutError) as error:
        raise Unavailable(f"{MIRROR} does not answer: {error}") from error
    if hashlib.sha256(package).hexdigest() != digest:
        raise Unavailable(f"{MIRROR}/{path} is not what Debian's index says it is")
    unpack(package, folder)


def downloaded(path: str) -> bytes:
    """A file of the mirror."""
    with urllib.request.urlopen(f"{MIRROR}/{path}", timeout=_PATIENCE) as answer:
        content: bytes = answer.read()
    return content


def listed(index: bytes, version: str) -> tuple[str, str]:
    """Path and SHA-256 of the package with the headers, in a release's compressed index."""
    name = f"libpython{version}-dev"
    for entry in lzma.decompress(index).decode().split("\n\n"):
        if entry.startswith(f"Package: {name}\n"):
            fields = dict(re.findall(r"^(Filename|SHA256): (\S+)$", entry, re.MULTILINE))
            return fields["Filename"], fields["SHA256"]
    raise Unavailable(f"Debian {RELEASES[version]} has no {name}")


def unpack(package: bytes, folder: Path) -> None:
    """The folder usr/include of a Debian package."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    with tempfile.NamedTemporaryFile(suffix=".deb") as file:
        file.write(package)
        file.flush()
        with subprocess.Popen(["dpkg-deb", "--fsys-tarfile", file.name], stdout=subprocess.PIPE) as content:
            command = ["tar", "--extract", "--strip-components=2", "--directory", str(folder), "./usr/include"]
            subprocess.run(command, stdin=content.stdout, check=True)
    (folder / "complete").touch()


def main() -> None:
    version, folder = sys.argv[1:]
    try:
        fetch(version, Path(folder))
    except Unavailable as reason:
        sys.exit(f"rayleaf: no headers of Python {version}: {reason}")


if __name__ == "__main__":
    main()
