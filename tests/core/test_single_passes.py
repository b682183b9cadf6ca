"""A pass shows the same whether it is asked for alone or with all others."""

import numpy as np
import pytest
import scenes
from rayleaf import passes

NAMES = [entry.identifier for entry in passes.table()]
# What is counted: how many tessellations rays needed depends on what else is rendered.
COUNTED = {"geometry_misses"}


def rendered(core, names, integrator):
    scene = scenes.small_scene(core)
    settings = core.Settings(width=12, height=10, samples=3, threads=1, passes=names, integrator=integrator)
    session = core.Session(scene, settings)
    assert session.render()
    return {name: session.pass_pixels(name) for name in names}


@pytest.mark.parametrize("integrator", ["PATH", "DISTRIBUTION"])
def test_a_pass_is_the_same_alone_and_with_all_others(core, integrator):
    together = rendered(core, NAMES, integrator)
    shown = 0
    for name in NAMES:
        alone = rendered(core, [name], integrator)[name]
        if name not in COUNTED:
            np.testing.assert_array_equal(alone, together[name], err_msg=name)
        shown += bool(np.any(alone))
    assert shown > 15
