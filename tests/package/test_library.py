"""The installed C++ library: found by CMake, free of Python, and enough for a program that renders."""

import os
import subprocess
from pathlib import Path

import numpy as np
import pytest

CACHED = (
    ("-G", "Ninja", "-DCMAKE_CXX_COMPILER_LAUNCHER=ccache") if os.path.exists("/usr/bin/ccache") else ("-G", "Ninja")
)


def run(*command: str | Path, folder: Path) -> str:
    """What a command says; fails with it if the command does."""
    done = subprocess.run([str(word) for word in command], cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.fixture(scope="session")
def installed_library(addons: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where `cmake --install` put the library."""
    prefix = tmp_path_factory.mktemp("library")
    run("cmake", "--install", addons.parents[1], "--prefix", prefix, folder=prefix)
    return prefix


def test_a_program_that_finds_the_library_renders_the_gallery(root: Path, installed_library: Path, tmp_path: Path):
    source = root / "examples" / "gallery"
    run("cmake", "-S", source, "-B", tmp_path, f"-DCMAKE_PREFIX_PATH={installed_library}", *CACHED, folder=tmp_path)
    run("cmake", "--build", tmp_path, folder=tmp_path)
    run(tmp_path / "gallery", folder=tmp_path)
    header, pixels = (tmp_path / "gallery.ppm").read_bytes().split(b"255\n", 1)
    assert header.split() == [b"P6", b"1240", b"280"]
    picture = np.frombuffer(pixels, np.uint8).reshape(280, 1240, 3).astype(float)
    red = picture[..., 0] > picture[..., 2]  # copper under a sky that is bluer
    seen = [float(red[:, 20 + 240 * i : 220 + 240 * i].mean()) for i in range(5)]
    assert min(seen) > 0.3, seen
    sheets = [picture[:, 240 * i + 20 : 240 * i + 260] for i in range(5)]
    assert all(np.abs(a - b).mean() > 1 for a, b in zip(sheets, sheets[1:])), "every order has its own shape"


def test_headers_and_the_library_come_without_python(installed_library: Path):
    headers = {path.name for path in installed_library.rglob("*.h")}
    assert {"session.h", "description.h", "patch_surface.h"} <= headers
    assert not [path for path in installed_library.rglob("*.h") if "pybind11" in path.read_text()]


def test_the_core_is_configured_without_python(root: Path, tmp_path: Path):
    run("cmake", "-S", root, "-B", tmp_path, "-DRAYLEAF_PYTHON=OFF", *CACHED, folder=tmp_path)
    targets = run("ninja", "-t", "targets", "all", folder=tmp_path)
    assert "librayleaf.a:" in targets and "core/python" not in targets
    assert "Python_EXECUTABLE" not in (tmp_path / "CMakeCache.txt").read_text()
    assert "-Werror" not in (tmp_path / "build.ninja").read_text(), "warnings end only the project's own builds"
