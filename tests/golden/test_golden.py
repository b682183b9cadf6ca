"""The scenes look as they did. The page out/golden/index.html shows new pictures, references and differences.

RAYLEAF_UPDATE_GOLDEN=1 takes the new pictures as references, in place of those that they were compared with: look at the page
first, and say in the commit why they changed. Of a scene that a newer Blender shows otherwise, copy the reference into the folder
of its version first.
"""

import os
import shutil
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from golden.golden import RENDER, SAMPLES, SIZE, Comparison, write_page, write_pictures

REFERENCES = Path(__file__).resolve().parent / "references"
SCENES = sorted(path.stem for path in (Path(__file__).resolve().parents[2] / "blend_scenes").glob("*.blend"))


@pytest.fixture(scope="module")
def comparisons(root: Path) -> Iterator[list[Comparison]]:
    """Gathers what the tests compare, and writes the page in the end."""
    gathered: list[Comparison] = []
    yield gathered
    if gathered:
        write_page(gathered, root / "out" / "golden")


@pytest.mark.parametrize("name", SCENES)
def test_a_scene_looks_as_it_did(run_blender, root, comparisons, name):
    folder = root / "out" / "golden" / name
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    reference = REFERENCES / f"{name}.exr"
    run = run_blender(RENDER, root / "blend_scenes" / f"{name}.blend", reference, folder, SIZE, SAMPLES)
    new = np.load(folder / "new.npy")
    has_reference = (folder / "reference.npy").exists()
    old = np.load(folder / "reference.npy") if has_reference else np.zeros_like(new)
    comparison = Comparison(name, new, old, run.report["later"])
    comparisons.append(comparison)
    write_pictures(comparison, folder)
    if os.environ.get("RAYLEAF_UPDATE_GOLDEN"):
        shutil.copyfile(folder / "new.exr", run.report["reference"])
        return
    assert has_reference, f"{reference} is missing; RAYLEAF_UPDATE_GOLDEN=1 makes it"
    assert comparison.verdict == ""
