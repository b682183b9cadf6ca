"""Strands and bevelled curves against extended precision: cusps, hairpins, folds, needles; at every size and distance and
with every kernel."""

import numpy as np
import pytest
import strand_shapes
import swept_support
from core import shapes
from stability.kernels import check_same_bits
from stability.measured import check_bound
from stability.patch_cases import bernstein, extended

trace = shapes.trace
OFFSETS = (0.0, 1e3, 1e6)
SCALES = (1e-6, 1.0, 1e6)
RAYS = 60

# Cubic axes of about size 1.
AXES = {
    "straight": [[-1, 0, 0], [-0.3, 0.1, 0.2], [0.4, 0.2, 0.4], [1, 0.3, 0.6]],
    "S": [[-1, 0, 0], [0.4, 1.3, 0.1], [-0.4, -1.3, 0.2], [1, 0, 0]],
    "hairpin": [[-1, 0, 0], [1.6, 0, 0.1], [1.6, 0.002, 0.1], [-1, 0.002, 0]],
    "cusp": [[-1, 0, 0], [1, 1, 0], [-1, 1, 0.1], [1, 0, 0]],
    "doubled end point": [[-1, 0, 0], [-1, 0, 0], [0.5, 0.8, 0.1], [1, 0, 0.3]],
    "on one line, back and forth": [[-0.8, 0, 0], [1.6, 0, 0], [-1.6, 0, 0], [0.8, 0, 0]],
    "almost on one line": [[-1, 0, 0], [-0.3, 6e-4, 0], [0.4, 0, 6e-4], [1, 0, 0]],
    "all points one": [[0.1, 0.2, 0.3]] * 4,
}
# Along these a bevelled curve has a frame everywhere, and its walls are nowhere inside it.
REGULAR_AXES = ("straight", "S", "almost on one line")


def axis_at(name, t):
    """Place and derivative in extended precision, each (n, 3)."""
    control = extended(AXES[name])
    values, slopes = bernstein(3, extended(t))
    return values.T @ control, slopes.T @ control


def distance_to_axis(name, places):
    """Least distance of each place to the axis, extended precision: in each of eight parts of it the best of many
    parameters, then of closer and closer ones. An axis may pass the same place more than once."""
    parts = 8
    middle = np.tile(extended((np.arange(parts) + 0.5) / parts), (len(places), 1))
    reach, best = extended(0.5 / parts), None
    for count in (129, 33, 33, 33, 33, 33):
        t = np.clip(middle[..., None] + reach * extended(np.linspace(-1, 1, count)), 0, 1)
        on_axis = axis_at(name, t.ravel())[0].reshape(*t.shape, 3)
        squared = np.sum((on_axis - places[:, None, None]) ** 2, axis=3)
        nearest = np.argmin(squared, axis=2)[..., None]
        middle = np.take_along_axis(t, nearest, axis=2)[..., 0]
        best = np.sqrt(np.take_along_axis(squared, nearest, axis=2)[..., 0])
        reach = reach * 2.5 / (count - 1)
    return best.min(axis=1)


def rays_at_axis(name, seed=11):
    """Rays from any direction at points of the axis; size 1, extended precision."""
    random = np.random.default_rng(seed)
    targets, _ = axis_at(name, random.uniform(0.02, 0.98, RAYS))
    towards = extended(shapes.random_directions(random, RAYS))
    towards = towards / np.sqrt(np.sum(towards**2, axis=1))[:, None]
    return targets - 4 * towards, towards


def traced(shape, offset, scale, origins, towards, **view):
    """Hits, and their places in sizes of the shape, extended precision."""
    view = {"pixel_angle": 1e-4, "eye": (offset,) * 3, **view}
    tracer = trace.Tracer([(shape, shapes.moved(offset, scale), shapes.EVERYTHING)], **view)
    hits = tracer.closest_hits(np.asarray(origins * scale + offset, float), np.asarray(towards, float))
    return hits, (extended(hits["position"]) - offset) / scale


def rounding(offset, scale):
    """Of world positions, in sizes of the shape."""
    return 4 * np.spacing(offset + scale) / scale


@pytest.mark.parametrize("scale", SCALES)
@pytest.mark.parametrize("offset", OFFSETS)
@pytest.mark.parametrize("radius", [0.1, 1e-3])
@pytest.mark.parametrize("name", AXES)
def test_hits_on_round_strands_lie_a_radius_from_the_axis(name, radius, offset, scale):
    """A strand is the union of the balls along its axis, hairpins and cusps included."""
    if rounding(offset, scale) > 0.1 * radius:
        pytest.skip("a world position has too few digits for an object that small so far away")
    strand = strand_shapes.strand(AXES[name], radius, basis="BEZIER")
    hits, places = traced(strand, offset, scale, *rays_at_axis(name))
    place = f"round strand, {name}, radius {radius:g}, offset {offset:g}, scale {scale:g}"
    check_bound(place, "rays lost", int(np.sum(hits["instance"] < 0)), 0, "rays")
    off = np.abs(distance_to_axis(name, places) - np.float32(radius)).max()
    # Roots are found in double; the strand's own radius is a float.
    check_bound(place, "distance from the wall", off, 1e-9 + 2 * rounding(offset, scale), "sizes")


@pytest.mark.parametrize("scale", SCALES)
@pytest.mark.parametrize("offset", OFFSETS)
@pytest.mark.parametrize("share", [0.1, 1e-3, 1e-6])
@pytest.mark.parametrize("name", REGULAR_AXES)
def test_hits_on_bevelled_curves_lie_a_radius_from_the_axis(name, share, offset, scale):
    if rounding(offset, scale) > 0.1 * share:
        pytest.skip("a world position has too few digits for an object that thin so far away")
    points = np.array(AXES[name])
    handles = np.stack([[2 * points[0] - points[1], points[1]], [points[2], 2 * points[3] - points[2]]])
    tube = swept_support.surface("BEZIER", points[[0, 3]], handles, bevel_depth=share, fill_caps=True)
    hits, places = traced(tube, offset, scale, *rays_at_axis(name))
    place = f"bevelled curve, {name}, radius {share:g}, offset {offset:g}, scale {scale:g}"
    check_bound(place, "rays lost", int(np.sum(hits["instance"] < 0)), 0, "rays")
    found = (hits["instance"] >= 0) & np.isfinite(places[:, 0].astype(float))
    # Parameters of a hit are floats, along and around: an error along does not change the distance, one around neither.
    # A cap is flat: nearer to the axis than its wall.
    beyond = distance_to_axis(name, places[found]) - share
    check_bound(place, "distance beyond the wall", float(beyond.max()), 2e-7 + 2 * rounding(offset, scale), "sizes")


@pytest.mark.parametrize("offset", OFFSETS)
@pytest.mark.parametrize("name", REGULAR_AXES)
def test_every_kernel_meets_bevelled_curves_in_the_same_bits(name, offset, any_target):
    points = np.array(AXES[name])
    handles = np.stack([[2 * points[0] - points[1], points[1]], [points[2], 2 * points[3] - points[2]]])
    rays = rays_at_axis(name)

    def hits():
        tube = swept_support.surface("BEZIER", points[[0, 3]], handles, bevel_depth=0.01)
        return traced(tube, offset, 1.0, *rays)[0]

    check_same_bits(f"bevelled curve, {name}, offset {offset:g}", hits)


# How far outlines may be off, in radii: 1e-4 of a pixel's angle times a tenth of a pixel seen from 3 away, and its chord.
ROUND_SHAPES = {
    "NURBS sphere": (shapes.nurbs_sphere, 1e-4),
    "round strand": (lambda: strand_shapes.strand([[0, 0, -3], [0, 0, 3]], 1.0, basis="LINEAR"), 1e-6),
    "bevelled curve": (lambda: swept_support.surface("POLY", [[0, 0, -3], [0, 0, 3]], bevel_depth=1.0), 1e-4),
}


@pytest.mark.parametrize("scale", SCALES)
@pytest.mark.parametrize("offset", OFFSETS)
@pytest.mark.parametrize("name", ROUND_SHAPES)
def test_rays_past_a_silhouette_miss_and_rays_inside_it_hit(name, offset, scale):
    """At a silhouette both roots are one. Rays pass the axis at the radius, a little more and a little less."""
    make, tolerance = ROUND_SHAPES[name]
    if rounding(offset, scale) > 0.1 * tolerance:
        pytest.skip("a world position has too few digits for an object that small so far away")
    random = np.random.default_rng(5)
    around = random.uniform(0, 2 * np.pi, 400)
    out = np.stack([np.cos(around), np.sin(around), np.zeros(400)], axis=1)
    along = np.stack([-np.sin(around), np.cos(around), np.zeros(400)], axis=1)
    eye = {"eye": (offset, offset, offset + 3 * scale)}
    for share, meant in ((1 - tolerance, True), (1 + tolerance, False), (1.0, None)):
        origins = extended(share * out - 3 * along)
        hits, places = traced(make(), offset, scale, origins, extended(along), **eye)
        found = hits["instance"] >= 0
        assert np.isfinite(hits["position"]).all() and np.isfinite(hits["normal"]).all()
        place = f"silhouette of {name}, {share - 1:+.0e} of the radius, offset {offset:g}, scale {scale:g}"
        if meant is not None:
            check_bound(place, "rays that are wrong", int(np.sum(found != meant)), 0, "rays")
        if found.any():
            lengths = np.sqrt(np.sum(places[found, :2] ** 2, axis=1)).astype(float)
            off = np.abs(lengths - 1).max()
            check_bound(place, "distance from the surface", off, 1e-6 + 2 * rounding(offset, scale), "radii")
