"""Headers of a Python that this Debian has not come from a Debian package, found in its release's index and checked."""

import hashlib
import importlib.util
import lzma
import subprocess

import pytest


@pytest.fixture(scope="module")
def headers(root):
    specification = importlib.util.spec_from_file_location(
        "python_headers", root / "python_addon" / "package" / "python_headers.py"
    )
    module = importlib.util.module_from_spec(specification)
    specification.loader.exec_module(module)
    return module


@pytest.fixture
def package(tmp_path):
    """A Debian package with one header, and a file that is none."""
    tree = tmp_path / "tree"
    for name, text in (("usr/include/python3.14/Python.h", "// yes"), ("usr/lib/libpython3.14.a", "no")):
        (tree / name).parent.mkdir(parents=True)
        (tree / name).write_text(text)
    (tree / "DEBIAN").mkdir()
    fields = "Package: libpython3.14-dev\nVersion: 1\nArchitecture: amd64\nMaintainer: nobody\nDescription: none\n"
    (tree / "DEBIAN" / "control").write_text(fields)
    subprocess.run(["dpkg-deb", "--build", str(tree), str(tmp_path / "it.deb")], check=True, capture_output=True)
    return (tmp_path / "it.deb").read_bytes()


def mirror(package, digest):
    """What the mirror answers."""
    entries = [
        "Package: libpython3.14-dbg\nFilename: wrong\nSHA256: 0",
        f"Package: libpython3.14-dev\nFilename: pool/it.deb\nSHA256: {digest}",
    ]
    index = lzma.compress("\n\n".join(entries).encode())
    return lambda path: package if path == "pool/it.deb" else index


def test_the_headers_alone_are_unpacked_and_fetched_once(headers, package, tmp_path, monkeypatch):
    monkeypatch.setattr(headers, "downloaded", mirror(package, hashlib.sha256(package).hexdigest()))
    folder = tmp_path / "headers"
    headers.fetch("3.14", folder)
    assert (folder / "include" / "python3.14" / "Python.h").read_text() == "// yes"
    assert not list(folder.rglob("*.a"))
    monkeypatch.setattr(headers, "downloaded", None)
    headers.fetch("3.14", folder)


def test_a_package_that_is_not_the_one_of_the_index_is_refused(headers, package, tmp_path, monkeypatch):
    monkeypatch.setattr(headers, "downloaded", mirror(package, "0" * 64))
    with pytest.raises(headers.Unavailable, match="pool/it.deb is not what Debian's index says it is"):
        headers.fetch("3.14", tmp_path / "headers")
    assert not (tmp_path / "headers" / "complete").exists()


def test_a_python_that_no_release_has_is_said(headers, package, tmp_path, monkeypatch):
    with pytest.raises(headers.Unavailable, match="no Debian release with Python 3.99 is known"):
        headers.fetch("3.99", tmp_path)
    monkeypatch.setattr(headers, "downloaded", lambda path: lzma.compress(b"Package: other\n"))
    with pytest.raises(headers.Unavailable, match="Debian forky has no libpython3.14-dev"):
        headers.fetch("3.14", tmp_path)
