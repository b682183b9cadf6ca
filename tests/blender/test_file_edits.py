"""Edits of the scenes in blend_scenes/: what a view shows after each is what a fresh export shows, to the bit."""

import os
from pathlib import Path

import pytest
from test_scenes import SCENES

HERE = Path(__file__).parent
FILES = HERE.parents[1] / "blend_scenes"
# Takes too long for each run of all tests; RAYLEAF_FILE_EDITS=40 makes so many edits of each file, those of all kinds twice.
# Without, those are left out that take longest to export anew.
COUNT = int(os.environ.get("RAYLEAF_FILE_EDITS", "3"))
LONG = ("psychedelic_dragons", "city_street", "parking_lot")
EDITED = SCENES if "RAYLEAF_FILE_EDITS" in os.environ else [name for name in SCENES if name not in LONG]


@pytest.mark.parametrize("number, name", enumerate(EDITED))
def test_after_edits_of_a_file_a_view_shows_what_a_fresh_export_does(run_blender, number, name):
    run = run_blender(HERE / "file_edits.py", FILES / f"{name}.blend", COUNT * number, COUNT, timeout=3000)
    assert len(run.report["applied"]) == COUNT
    assert run.report["different"] == []
