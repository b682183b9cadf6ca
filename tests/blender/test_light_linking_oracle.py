"""Lights shine on the objects, and have the shadows of the objects, that they are linked to in Cycles."""

from pathlib import Path

import numpy as np
import pytest

SCRIPT = Path(__file__).parent / "light_linking_oracle.py"
# Of a tile's brightness, and of the whole picture's.
ALLOWED = 0.02
# Light goes through this tile as in test_spread_oracle.py: up to 4.3 so much more, with links or without.
SKIN, MORE_SKIN = 6, 0.08
# Rough glass focuses lamps: rare bright paths, with links or without. And where only some objects are included as blockers,
# Cycles lets the others hide a light from rays that are scattered, though not from shadow rays.
GLASS, MORE_GLASS = 4, 0.15
# Distribution ray tracing is as much brighter where bounced light is mirrored, with links or without.
MIRRORED = 0.004


def by_tile(means):
    return np.array(means).reshape(-1, 3).mean(1)


@pytest.mark.parametrize("integrator", ["path", "distribution"])
def test_linked_lights_light_and_shade_as_in_cycles(run_blender, tmp_path, integrator):
    run = run_blender(SCRIPT, tmp_path, integrator, timeout=400)
    if tuple(run.report["version"]) < (4, 0):
        pytest.skip("light linking came with Blender 4.0")
    found = run.report["found"]
    assert len(found) > 25
    wrong = {}
    for name, means in found.items():
        tiles = {key: by_tile(values) for key, values in means.items()}
        cycles, rayleaf = ((tiles[f"{engine} 1"] + tiles[f"{engine} 2"]) / 2 for engine in ("CYCLES", "RAYLEAF"))
        noise = sum(abs(tiles[f"{engine} 1"] - tiles[f"{engine} 2"]) for engine in ("CYCLES", "RAYLEAF"))
        allowed = ALLOWED * cycles + ALLOWED * cycles.mean() + noise
        allowed[SKIN] += MORE_SKIN * cycles[SKIN] if tuple(run.report["version"]) < (4, 4) else 0.0
        allowed[GLASS] += MORE_GLASS * cycles[GLASS]
        allowed += MIRRORED if integrator == "distribution" else 0.0
        if (abs(rayleaf - cycles) > allowed).any():
            wrong[name] = (cycles.round(4).tolist(), rayleaf.round(4).tolist(), noise.round(4).tolist())
        assert np.median(noise / cycles) < 0.1, name
    assert wrong == {}
