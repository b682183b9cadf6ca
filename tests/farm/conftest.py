"""Gives the tests here `run_blender` and a Slurm cluster."""

from collections.abc import Iterator

import pytest
from blender_runner import run_blender  # noqa: F401
from farm.slurm_cluster import PROGRAMS, Cluster, program


@pytest.fixture
def cluster() -> Iterator[Cluster]:
    """Two nodes; `rayleaf test` has installed Slurm."""
    if missing := [name for name in PROGRAMS if program(name) is None]:
        pytest.skip(f"Slurm is not installed: no {', '.join(missing)}")
    made = Cluster()
    try:
        made.start()
        yield made
    finally:
        made.stop()
