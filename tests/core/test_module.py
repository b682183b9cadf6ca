"""The extension module as plain Python sees it."""

import os
import subprocess
import sys

import pytest


def test_the_module_imports_without_blender(core):
    assert core.__name__ == "rayleaf._core"


def test_an_input_error_is_a_value_error(core):
    assert issubclass(core.InputError, ValueError)


WITHOUT_NUMPY = """
import sys
sys.modules["numpy"] = None
for _ in range(2):
    try:
        import rayleaf._core
        print("imported")
    except ImportError as error:
        print(error)
del sys.modules["numpy"]
import rayleaf._core
print(rayleaf._core.Program("a").name)
"""


def test_an_import_without_numpy_says_so_every_time_and_a_later_one_succeeds(addons):
    done = subprocess.run(
        [sys.executable, "-c", WITHOUT_NUMPY],
        env={**os.environ, "PYTHONPATH": str(addons)},
        capture_output=True,
        text=True,
    )
    *without, name = done.stdout.splitlines()
    assert done.returncode == 0, done.stderr
    assert len(without) == 2 and all("numpy" in text for text in without), without
    assert name == "a"


def test_an_input_error_shows_bytes_that_are_no_text_as_numbers(core, tmp_path):
    path = bytes(tmp_path / "K\udce4fer.png")
    with pytest.raises(core.InputError, match=r"'Beetle'.*K\\xe4fer\.png"):
        core.SceneDescription().add_image_file("Beetle", path, "SRGB")
