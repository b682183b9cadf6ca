"""What the sun shines through lights what lies behind it, since Blender 5.0 as in Cycles: before, after a diffuse surface light
leaves a body where it entered it, which a shadow hides."""

from pathlib import Path

import numpy as np

SCRIPT = Path(__file__).with_name("lit_through_oracle.py")


def test_translucent_walls_light_floors_since_blender_5(run_blender, tmp_path):
    report = run_blender(SCRIPT, tmp_path).report
    cycles, path, distribution = (np.array(mean) for mean in report["found"].values())
    if report["version"] < [5, 0, 0]:
        assert max(cycles.max(), path.max(), distribution.max()) < 1e-4
        return
    assert (cycles > 0.05).all()
    np.testing.assert_allclose(path, cycles, rtol=0.04)
    np.testing.assert_allclose(distribution, cycles, rtol=0.1)
