"""Bevelled curves with bad or extreme data: a clear message, or the right picture."""

import numpy as np
import pytest
from core import shapes
from core import swept_support as swept
from rayleaf import _core

LINE = np.array([[0.0, 0, 0], [1, 0, 0]])


def tracer_of(shape):
    """A tracer of one shape at the origin."""
    return _core.trace.Tracer([(shape, np.eye(4), shapes.EVERYTHING)])


BAD_SPLINES = {
    "points": lambda: swept.splines("POLY", [[0, 0, np.nan], [1, 0, 0]]),
    "handles": lambda: swept.splines("BEZIER", LINE, np.full((2, 2, 3), np.inf)),
    "radii": lambda: swept.splines("POLY", LINE, radii=np.array([1, np.inf])),
    "tilts": lambda: swept.splines("POLY", LINE, tilts=np.array([1.0, 2, 3])),
    "weight": lambda: swept.splines("NURBS", np.array([[0.0, 0, 0, 1], [1, 0, 0, 0]]), order=2),
    "order": lambda: swept.splines("NURBS", LINE, order=1),
    "resolution": lambda: swept.splines("POLY", LINE, resolution=0),
    "material_slot": lambda: swept.splines("POLY", LINE, material_slot=-1),
    "type": lambda: swept.splines("CATMULL", LINE),
    "counts": lambda: swept.splines("POLY", LINE, counts=[-2]),
    "radius_interpolation": lambda: swept.splines("BEZIER", LINE, np.zeros((2, 2, 3)), radius_interpolation="CUBIC"),
}
BAD_CURVES = {
    "bevel_depth": {"bevel_depth": np.nan},
    "bevel_start": {"bevel_start": -0.1},
    "bevel_end": {"bevel_end": 1.5},
    "twist": {"twist": "MAXIMUM"},
    "fill": {"fill": "BOTH"},
    "bevel_resolution": {"bevel_resolution": -1},
    "taper_radius": {"taper_radius": "DIVIDE"},
    "start_mapping": {"start_mapping": "LENGTH"},
}


@pytest.mark.parametrize("argument", BAD_SPLINES)
def test_bad_splines_are_named(argument):
    with pytest.raises(_core.InputError, match=argument):
        BAD_SPLINES[argument]()


@pytest.mark.parametrize("argument", BAD_CURVES)
def test_bad_settings_are_named_with_their_object(argument):
    with pytest.raises(_core.InputError, match=f"curve.*{argument}"):
        swept.curve("POLY", LINE, **BAD_CURVES[argument])


def test_sums_that_no_number_holds_are_refused():
    with pytest.raises(_core.InputError, match="curve"):
        swept.surface("POLY", LINE, radii=np.full(2, 1e99), bevel_depth=1e99)


NOTHING = {
    "no bevel": lambda: swept.surface("POLY", LINE),
    "an empty bevel object": lambda: swept.surface("POLY", LINE, profile=[]),
    "a bevel object of one point": lambda: swept.surface("POLY", LINE, profile=[swept.splines("POLY", LINE[:1])]),
    "one point": lambda: swept.surface("POLY", LINE[:1], bevel_depth=0.1),
    "coincident points": lambda: swept.surface("BEZIER", np.ones((3, 3)), np.ones((3, 2, 3)), bevel_depth=0.1),
    "no splines": lambda: _core.trace.SweptSurface(_core.SweptCurve("curve", [], bevel_depth=0.1)),
    "an empty range": lambda: swept.surface("POLY", LINE, bevel_depth=0.1, bevel_start=0.5, bevel_end=0.5),
    "too few points for the order": lambda: swept.surface("NURBS", LINE, order=4, bevel_depth=0.1),
}


@pytest.mark.parametrize("what", NOTHING)
def test_what_blender_draws_nothing_for_is_an_empty_shape(what):
    shape = NOTHING[what]()
    assert shape.element_count == 0
    hits = tracer_of(shape).closest_hits(np.array([[0.5, 0, 5]]), np.array([[0.0, 0, -1]]))
    assert hits["instance"][0] == -1


@pytest.mark.parametrize("what", ["radius", "taper"])
def test_a_tube_without_width_is_met_by_no_ray(what):
    nothing = {"radius": {"radii": np.zeros(2)}, "taper": {"taper": swept.splines("POLY", [[1, 1, 0], [1, 2, 0]])}}
    shape = swept.surface("POLY", LINE, bevel_depth=0.1, fill_caps=True, **nothing[what])
    random = np.random.default_rng(41)
    rays = swept.rays_at(random.uniform(0, 1, (2000, 3)) * [1, 0, 0], 3.0, random)
    assert (tracer_of(shape).closest_hits(*rays)["instance"] == -1).all()


def test_a_doubled_point_changes_nothing():
    doubled = np.array([[0.0, 0, 0], [0.4, 0.2, 0], [0.4, 0.2, 0], [1, 0, 0]])
    random = np.random.default_rng(42)
    rays = swept.rays_at(random.uniform(0, 1, (2000, 3)) * [1, 0.2, 0], 3.0, random)
    hits = [
        tracer_of(swept.surface("POLY", points, bevel_depth=0.1, fill_caps=True)).closest_hits(*rays)
        for points in (doubled, doubled[[0, 1, 3]])
    ]
    np.testing.assert_allclose(hits[0]["t"], hits[1]["t"], atol=1e-7)


@pytest.mark.slow
def test_a_million_splines_are_one_object_of_bounded_size():
    count = 1_000_000
    random = np.random.default_rng(43)
    roots = random.uniform(-1, 1, (count, 1, 3))
    points = np.concatenate([roots, roots + random.normal(0, 0.02, (count, 1, 3))], axis=1).reshape(-1, 3)
    splines = swept.splines("POLY", points, counts=np.full(count, 2), material_slot=3)
    shape = _core.trace.SweptSurface(_core.SweptCurve("many", [splines], bevel_depth=1e-3))
    assert shape.bytes < 500 * count
    tracer = tracer_of(shape)
    chosen = random.integers(0, count, 2000)
    ends = points.reshape(-1, 2, 3)[chosen]
    across = shapes.unit(np.cross(ends[:, 1] - ends[:, 0], random.normal(size=(2000, 3))))
    assert tracer.occluded(ends.mean(axis=1) + 1e-2 * across, -across, t_max=np.array([1e-2])).all()


@pytest.mark.slow
def test_one_spline_of_a_million_points_is_found_everywhere():
    count = 1_000_000
    angle = np.linspace(0, 200 * np.pi, count)
    points = np.stack([np.cos(angle), np.sin(angle), angle / 300], axis=1)
    shape = swept.surface("POLY", points, bevel_depth=1e-3)
    assert shape.element_count == count - 1
    tracer = tracer_of(shape)
    random = np.random.default_rng(44)
    targets = points[random.integers(1, count - 1, 2000)]
    outwards = targets * [1, 1, 0]
    hits = tracer.closest_hits(targets + outwards, -outwards)
    np.testing.assert_allclose(hits["t"], 1 - 1e-3, atol=1e-4)


@pytest.mark.parametrize("degenerate", ["handles on the points", "handles on the line"])
def test_a_straight_bezier_segment_is_one_piece_however_slowly_it_begins(degenerate):
    ends = np.array([[0.0, 0, 0], [1, 1, 0.5]])
    step = (ends[1] - ends[0]) * (0.0 if degenerate == "handles on the points" else 0.01)
    handles = np.stack([ends - step, ends + step], axis=1)
    assert swept.surface("BEZIER", ends, handles, bevel_depth=0.1).element_count == 1


def test_each_spline_has_its_material_and_flat_ones_the_normals_of_facets():
    groups = [swept.splines("POLY", LINE + [0, i, 0], material_slot=i, smooth=bool(i)) for i in range(2)]
    shape = _core.trace.SweptSurface(_core.SweptCurve("curve", groups, bevel_depth=0.1))
    x = np.linspace(0.1, 0.9, 50)
    for i in range(2):
        origins = np.stack([x, np.full(50, i + 0.05), np.full(50, 5.0)], axis=1)
        hits = tracer_of(shape).closest_hits(origins, np.tile([0.0, 0, -1], (50, 1)))
        same = np.sum(hits["normal"] * hits["facet_normal"], axis=1)
        assert (same > 1 - 1e-6).all() == (i == 0)


@pytest.mark.slow
def test_more_cells_than_32_bits_count_become_fewer():
    # 2^16 segments that each want the most cells a segment may have: 2^32 of them, which 32 bits take for none.
    count = 1 << 16
    angle = np.arange(count) * 2 * np.pi / count
    points = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    along = np.stack([-np.sin(angle), np.cos(angle), 0 * angle], axis=1) * (2 * np.pi / count / 3)
    handles = np.stack([points - along, points + along], axis=1)
    handles[..., 2] = np.array([-1e-3, 1e-3])[None, :]
    ring = swept.surface("BEZIER", points, handles, cyclic=True, bevel_depth=0.1, bevel_resolution=0)
    tracer = _core.trace.Tracer([(ring, np.eye(4), 31)], pixel_angle=1e-30)
    # One cell along each segment at least, and as many around as so small a pixel asks for.
    assert count // 16 <= tracer.statistics()["subpatches"] < 1 << 23
    hits = tracer.closest_hits(np.zeros((2, 3)), np.array([[1.0, 0.1, 0], [-0.3, 0.9, 0]]))
    np.testing.assert_allclose(np.linalg.norm(hits["position"], axis=1), 0.9, atol=0.05)
