"""The sun of a Sky Texture is where Cycles has it, as bright, and as dark towards its edge; and it lights as much."""

from pathlib import Path

import pytest
from measured_nodes import keep_comparison

pytestmark = pytest.mark.nodes


def test_the_suns_disc_and_its_light_are_cycles(run_blender, tmp_path):
    run = run_blender(Path(__file__).parent / "sky_oracle.py", tmp_path)
    for number, (ordered, share) in enumerate(run.report["found"], 1):
        assert 0.05 < share < 0.4  # the camera sees the disc, and the sky around it
        # At the edge, samples lie up to a hundredth of a pixel apart. Since 5.0 Cycles' sky of single scattering is another
        # than 3.4's, see ANOTHER_SKY in test_nodes_oracle, and its sun differs from ours by up to so much; why is not known.
        is_known = run.report["kinds"][number - 1] != "SINGLE_SCATTERING"
        half, most = (1e-3, 5e-3) if is_known else (1e-2, 0.15)
        median, allowed = ordered[int(len(ordered) * 0.5)], ordered[int(len(ordered) * 0.95)]
        keep_comparison("the sun's disc", f"sun {number}", run.report["nodes"][f"sun {number}"], allowed, median, most)
        assert median < half and allowed < most
    for kind, (cycles, rayleaf) in zip(run.report["kinds"], run.report["ground"], strict=True):
        allowed = 0.1 if kind == "SINGLE_SCATTERING" else 0.01
        assert min(cycles) > 0.1 and rayleaf == pytest.approx(cycles, rel=allowed)
