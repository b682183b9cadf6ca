"""Where the tests find the module, and how Hypothesis behaves. RAYLEAF_PACKAGE_DIR names the folder that holds `rayleaf`."""

import importlib
import os
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import hypothesis
import pytest

ROOT = Path(__file__).resolve().parents[1]
ADDONS = Path(os.environ.get("RAYLEAF_PACKAGE_DIR") or ROOT / "build" / "release" / "scripts" / "addons").resolve()
RIVALS = ADDONS.parents[1] / "rivals"  # the folder of the module rayleaf_rivals
sys.path[:0] = [str(ADDONS), str(RIVALS)]

# The same examples in every run, so that a test fails for everyone or for no one. To look for new ones, set
# RAYLEAF_EXPLORE=1: a failure prints the line that repeats it.
hypothesis.settings.register_profile(
    "rayleaf",
    deadline=None,
    derandomize=not os.environ.get("RAYLEAF_EXPLORE"),
    print_blob=True,
    suppress_health_check=[hypothesis.HealthCheck.too_slow],
)
hypothesis.settings.load_profile("rayleaf")


def pytest_report_header() -> str:
    """Say which module is under test."""
    return f"rayleaf: {ADDONS}"


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Tests that share a folder of the checkout or a Slurm controller run in one process, one after the other."""
    for item in items:
        folder = item.path.relative_to(ROOT / "tests").parts[0]
        if folder in ("farm", "package"):
            item.add_marker(pytest.mark.xdist_group(folder))


@pytest.fixture(scope="session")
def root() -> Path:
    """The folder of the checkout."""
    return ROOT


@pytest.fixture(scope="session")
def addons() -> Path:
    """The folder with the built package `rayleaf`."""
    return ADDONS


@pytest.fixture(scope="session")
def core() -> ModuleType:
    """The extension module rayleaf._core."""
    return importlib.import_module("rayleaf._core")


@pytest.fixture
def any_target(core: ModuleType) -> Iterator[None]:
    """Lets a test choose the kernels' instruction set; afterwards the machine's best is used again."""
    yield
    core.trace.use_simd_target("")
