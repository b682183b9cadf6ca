"""No ray leaves a closed shell, counted. RAYLEAF_LEAK_RAYS=1e8 counts as many rays as the long run does."""

import os

import numpy as np
import pytest
from core import shapes
from stability.measured import check_bound

RAYS = int(float(os.environ.get("RAYLEAF_LEAK_RAYS", "2e5")))
BATCH = 200_000
SHELLS = ("nurbs_sphere", "nurbs_torus", "lumpy_torus", "cube", "lumpy_mesh")
PLACES = {"at the origin": (0.0, 1.0), "at 1e3": (1e3, 1.0), "at 1e6": (1e6, 1.0), "tiny": (1.0, 1e-6),
          "huge": (0.0, 1e6)}  # fmt: skip


def parity_errors(tracer, origins, directions):
    """Rays from outside to outside that enter and leave a different number of times."""
    balance = np.zeros(len(origins), int)
    live = np.arange(len(origins))
    for _ in range(64):
        hits = tracer.closest_hits(origins, directions)
        on = hits["instance"] >= 0
        if not on.any():
            return int(np.sum(balance != 0))
        inwards = np.sum(hits["facet_normal"].astype(float) * directions, axis=1) < 0
        balance[live[on]] += np.where(inwards[on], 1, -1)
        origins = shapes.leaving(hits, directions)[on]
        directions, live = directions[on], live[on]
    raise AssertionError("a ray met more than 64 walls")


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("name", SHELLS)
def test_as_many_rays_leave_a_closed_shell_as_enter_it(name, place):
    offset, scale = PLACES[place]
    tracer = shapes.trace.Tracer([(getattr(shapes, name)(), shapes.moved(offset, scale), shapes.EVERYTHING)])
    random = np.random.default_rng(21)
    count = max(1, RAYS // (len(SHELLS) * len(PLACES)))
    wrong = 0
    for begin in range(0, count, BATCH):
        number = min(BATCH, count - begin)
        origins = 4.0 * shapes.random_directions(random, number)
        targets = random.uniform(-1, 1, (number, 3))
        directions = shapes.unit(targets - origins)
        wrong += parity_errors(tracer, origins * scale + offset, directions)
    # A ray through a sharp edge of a mesh may meet one of its two faces only: its direction is parallel to the other.
    check_bound(f"{name} {place}, {count} rays", "rays that leaked", wrong, 0, "rays")
