"""Surfaces displaced by as much as their own size, against extended precision: at every size and distance and with every
kernel."""

import numpy as np
import pytest
from core import shapes
from core import subdivision_cages as cages
from rayleaf import _core
from stability.kernels import check_same_bits
from stability.measured import check_bound
from stability.patch_cases import REGULAR, extended

trace = shapes.trace
OFFSETS = (0.0, 1e3, 1e6)
SCALES = (1e-6, 1.0, 1e6)
PATCH = next(case for case in REGULAR if case.name == "bicubic")
CAGE = cages.cube()


def doubled(shape):
    """Every point displaced by its own place in object space, so the surface becomes twice as large."""
    program = _core.Program("displacement")
    place = program.operation("object_coordinates")
    moved = program.operation("vector_math", [place, program.constant(1, 1, 1, 1)], text="MULTIPLY")
    return _core.displaced(shape, program, object=moved)


def patch_points():
    """Places on the patch and unit normals there."""
    aims = PATCH.aims()
    return PATCH.evaluate(aims[:, 0], aims[:, 1])[0], PATCH.normals(aims[:, 0], aims[:, 1])


def subdivision_points():
    """The same on each face of the limit of a subdivided cube, which is known in double precision."""
    surface = CAGE.surface()
    at = np.stack(np.meshgrid([0.13, 0.5, 0.81], [0.2, 0.6, 0.9]), axis=-1).reshape(-1, 2)
    elements = np.repeat(np.arange(surface.element_count, dtype=np.int32), len(at))
    values = surface.points(elements, np.tile(at, (surface.element_count, 1)))
    center, size = surface.frame
    return extended(values[:, 0] * size + center), extended(shapes.unit(np.cross(values[:, 2], values[:, 1])))


SURFACES = {
    "spline surface": (PATCH.surface, patch_points),
    "subdivision surface": (CAGE.surface, subdivision_points),
}


def hits_at(name, offset, scale):
    """Hits of rays that meet the doubled surface squarely, and where they should be, size 1."""
    make, points = SURFACES[name]
    places, normals = points()
    tracer = trace.Tracer([(doubled(make()), shapes.moved(offset, scale), shapes.EVERYTHING)], eye=(offset,) * 3)
    origins = np.asarray((2 * places + 0.5 * normals) * scale + offset, float)
    return tracer.closest_hits(origins, np.asarray(-normals, float)), 2 * places, normals


@pytest.mark.parametrize("scale", SCALES)
@pytest.mark.parametrize("offset", OFFSETS)
@pytest.mark.parametrize("name", SURFACES)
def test_a_surface_displaced_by_its_own_size_is_met_where_extended_precision_says(name, offset, scale):
    if offset >= 1e9 * scale:
        pytest.skip("a world position has too few digits for an object that small so far away")
    hits, places, normals = hits_at(name, offset, scale)
    case = f"{name} displaced by its size, offset {offset:g}, scale {scale:g}"
    check_bound(case, "rays lost", int(np.sum(hits["instance"] < 0)), 0, "rays")
    rounding = 4 * np.spacing(offset + scale) / scale
    off = np.sqrt(np.sum(((extended(hits["position"]) - offset) / scale - places) ** 2, axis=1)).max()
    # Facets are the displaced surface: within a tenth of a pixel of 1/1000 rad, for an eye in the middle of the object.
    check_bound(case, "position", float(off), 4e-5 + rounding, "sizes")
    turned = np.sqrt(np.sum((extended(hits["normal"]) - normals) ** 2, axis=1)).max()
    # Slopes are differences of what was computed in single precision, a thousandth of an element apart.
    check_bound(case, "normal", float(turned), 5e-5 + 1e3 * rounding, "rad")


@pytest.mark.parametrize("name", SURFACES)
def test_every_kernel_meets_displaced_surfaces_in_the_same_bits(name, any_target):
    check_same_bits(f"{name} displaced by its size", lambda: hits_at(name, 1e3, 1.0)[0])
