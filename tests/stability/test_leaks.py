"""No ray leaves a closed shell, counted. RAYLEAF_LEAK_RAYS=1e8 counts as many rays as the long run does."""

import os

import numpy as np
import pytest
import strand_shapes
import swept_support
import test_displacement
from core import shapes
from core import subdivision_cages as cages
from stability.measured import check_bound

RAYS = int(float(os.environ.get("RAYLEAF_LEAK_RAYS", "2e5")))
BATCH = 200_000
KNOT = strand_shapes.torus_knot() / 4.0


def tube(**settings):
    """The trefoil as a bevelled curve."""
    return swept_support.surface("NURBS", KNOT, order=4, cyclic=True, **settings)


def capped_star():
    """An open curve with a sharp profile, closed by caps."""
    angle = np.arange(10) * np.pi / 5
    star = np.stack([np.cos(angle), np.sin(angle)], axis=1) * np.where(np.arange(10) % 2, 0.1, 0.25)[:, None]
    points = np.array([[-0.8, 0, 0], [-0.2, 0.4, 0.3], [0.4, -0.4, -0.2], [0.8, 0.1, 0.4]])
    star_profile = [swept_support.polygon(star)]
    return swept_support.surface("NURBS", points, order=4, endpoint=True, profile=star_profile, fill_caps=True)


def displaced(shape):
    """By noise, from half its radius inwards to half outwards."""
    return test_displacement.displaced(shape, test_displacement.noise(3.0, 1.0))


def strand(basis, cyclic):
    radii = 0.06 + 0.04 * np.cos(np.arange(len(KNOT)))
    closed = np.array([int(cyclic)], np.uint8)
    return strand_shapes.strand(KNOT, radii, basis=basis, cyclic=closed)


SHELLS = {
    "NURBS sphere": shapes.nurbs_sphere,
    "NURBS torus": shapes.nurbs_torus,
    "dented torus of bicubic patches": shapes.lumpy_torus,
    "cube of triangles": shapes.cube,
    "dented mesh": shapes.lumpy_mesh,
    "bevelled knot": lambda: tube(bevel_depth=0.1),
    "thin bevelled knot": lambda: tube(bevel_depth=1e-3),
    "curve with a star's profile and caps": capped_star,
    "subdivided torus": lambda: cages.torus().surface(),
    "half sharp subdivided cube": lambda: cages.creased(cages.cube(), [(0, 1), (1, 3), (4, 5)], 2.5).surface(),
    "subdivided body with poles of 64 faces": lambda: cages.double_pole(64).surface(),
    "sphere displaced by as much as its size": lambda: displaced(shapes.nurbs_sphere()),
    "torus displaced by as much as its size": lambda: displaced(shapes.lumpy_torus()),
    "subdivided cube displaced by as much as its size": lambda: displaced(cages.cube().surface()),
    "round strand": lambda: strand("CATMULL_ROM", False),
    "closed round strand": lambda: strand("BSPLINE", True),
}
SPLINE_SHELLS = list(SHELLS)[:3]  # those that have levels
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


def placed(name, place):
    """A tracer of one shell. Nothing is diced twice: at a pole of 64 faces, that would take most of the time."""
    cache = shapes.trace.GeometryCacheSettings(megabytes=1500.0)
    return shapes.trace.Tracer([(SHELLS[name](), shapes.moved(*PLACES[place]), shapes.EVERYTHING)], cache=cache)


def batches(place, shells, seed):
    """Rays through a box around a shell, from outside, as many as there are for each of `shells` in each place: random
    numbers, origins and directions of each batch."""
    offset, scale = PLACES[place]
    random = np.random.default_rng(seed)
    count = rays_for(shells)
    for begin in range(0, count, BATCH):
        number = min(BATCH, count - begin)
        origins = 4.0 * shapes.random_directions(random, number)
        directions = shapes.unit(random.uniform(-1, 1, (number, 3)) - origins)
        yield random, origins * scale + offset, directions


def rays_for(shells):
    return max(1, RAYS // (len(shells) * len(PLACES)))


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("name", SHELLS)
def test_as_many_rays_leave_a_closed_shell_as_enter_it(name, place):
    tracer = placed(name, place)
    wrong = sum(parity_errors(tracer, *rays) for _, *rays in batches(place, SHELLS, 21))
    # A ray through a sharp edge of a mesh may meet one of its two faces only: its direction is parallel to the other.
    check_bound(f"{name}, {place}, {rays_for(SHELLS)} rays", "rays that leaked", wrong, 0, "rays")


@pytest.mark.parametrize("radius", [1e-3, 1e-5])
def test_no_ray_that_grazes_the_ridges_at_a_pole_is_lost(radius):
    """They are lower there than single precision tells apart: it may see a ray below a ridge that passes above it."""
    tracer, random = placed("subdivided body with poles of 64 faces", "at the origin"), np.random.default_rng(1)
    pole = tracer.closest_hits(np.array([[0, 0, 4.0]]), np.array([[0, 0, -1.0]]))["position"][0]
    targets = pole + radius * random.normal(size=(20_000, 3)) * [1, 1, 0.02]
    directions = shapes.unit(random.normal(size=targets.shape) * [1, 1, 0.1])
    wrong = parity_errors(tracer, targets - 4 * directions, directions)
    check_bound(f"ridges at a pole, within {radius:g}", "rays that leaked", wrong, 0, "rays")


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("name", SPLINE_SHELLS)
def test_rays_of_all_widths_cross_a_shell_of_mixed_levels_as_often_inwards_as_outwards(name, place):
    tracer, scale, wrong = placed(name, place), PLACES[place][1], 0
    for random, origins, directions in batches(place, SPLINE_SHELLS, 22):
        width, spread = (10 ** random.uniform(-6, 0, len(origins)) for _ in range(2))
        found = shapes.trace.cracks(tracer, origins, directions, (width * scale).astype(np.float32),
                                    spread.astype(np.float32), inside=False, merge=1e-6 * scale)  # fmt: skip
        wrong += int(found.sum())
    check_bound(f"{name}, {place}, {rays_for(SPLINE_SHELLS)} rays of all widths", "parity errors", wrong, 0, "rays")
