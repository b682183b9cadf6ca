"""Nodes that ask where the ray hit, and shaders, give on real surfaces what Cycles gives, pixel for pixel."""

from pathlib import Path

import pytest
from measured_nodes import keep_comparison

pytestmark = pytest.mark.nodes

# Relative where values exceed 1. Samples lie up to a hundredth of a pixel apart.
CLOSE = 5e-3
# Bumps are differences over a pixel in both engines, in directions and of a length of their own. Highlights are steep.
# Cycles makes its own tangents; those of a sheared UV map lie up to 2 % beside Blender's. The table of microfibres is coarse at
# grazing angles.
ROUGHLY = 2e-2
# Of rough glass more is missing than of other surfaces, with a film as without. Cycles approximates Beckmann's masking.
BESIDE = 1e-2
# Of the pixels of a case: edges of triangles, of cones and of what is lit fall on other sides. The highlights of
# mirrored balls, which are steep, lie on more of those.
SHARE_AT_STEPS = {"plain": 0.05, "mirrored": 0.1}


def test_nodes_and_shaders_on_surfaces_give_what_cycles_gives(run_blender, tmp_path):
    run = run_blender(Path(__file__).parent / "surface_oracle.py", tmp_path)
    wrong = {}
    for kind, share in SHARE_AT_STEPS.items():
        differences = run.report[kind]["differences"]
        assert len(differences) > 100
        for name, ordered in differences.items():
            allowed = ordered[int(len(ordered) * (1 - share)) - 1]
            rough = any(
                word in name
                for word in ("Bump", "bumped", "Displacement", "Anisotrop", "Other", "Coat IOR", "MICROFIBER")
            )
            beside = any(word in name for word in ("BsdfGlass", "BECKMANN"))
            bound, median = ROUGHLY if rough else BESIDE if beside else CLOSE, ordered[len(ordered) // 2]
            if kind == "plain":
                keep_comparison("surfaces", name, run.report["nodes"][name], allowed, median, bound)
            if allowed > bound:
                values = run.report[kind]["ranges"][name]
                wrong[f"{kind}: {name}"] = {"median": median, f"{1 - share:.0%}": allowed, "range": values}
    assert wrong == {}
