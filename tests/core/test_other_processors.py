"""A processor of narrower vectors renders the same bits: Embree hands packets on in parts there, in lanes of their own."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

PICTURES = Path(__file__).with_name("processor_pictures.py")


def pictures(addons: Path, **environment: str) -> str:
    """The hashes that the script prints in a process of its own."""
    command = [sys.executable, str(PICTURES), str(addons)]
    done = subprocess.run(command, env=os.environ | environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def usual(addons: Path) -> str:
    """Those of this processor's widest vectors."""
    return pictures(addons)


@pytest.mark.parametrize("kernels", ["sse2", "sse4.2", "avx", "avx2"])
def test_embrees_kernels_for_other_processors_give_the_same_bits(addons, usual, kernels):
    assert pictures(addons, RAYLEAF_EMBREE=f"isa={kernels}") == usual
