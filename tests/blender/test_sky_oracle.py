"""The sun of a Sky Texture is where Cycles has it, as bright, and as dark towards its edge."""

from pathlib import Path


def test_the_suns_disc_is_cycles(run_blender, tmp_path):
    run = run_blender(Path(__file__).parent / "sky_oracle.py", tmp_path)
    for ordered, share in run.report["found"]:
        assert 0.05 < share < 0.4  # the camera sees the disc, and the sky around it
        # The table is half floats; at the edge, samples lie up to a hundredth of a pixel apart.
        assert ordered[int(len(ordered) * 0.5)] < 1e-3 and ordered[int(len(ordered) * 0.95)] < 5e-3
