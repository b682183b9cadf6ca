"""Filled areas of curves in two dimensions: their place, their closed walls, and bad outlines."""

import numpy as np
import pytest
from core import shapes
from core import swept_support as swept
from rayleaf import _core

RAYS = 6000
STEP = 1e-12
ARC = 0.5523
UNIT = np.array([[1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0]], float)
DOWN = np.array([0.0, 0, -1])


def circle(x=0.0, y=0.0, radius=1.0, hole=False, **settings):
    """A circle of four Bezier segments, the other way round for a hole."""
    points = UNIT if hole else UNIT[::-1]
    along = np.cross([0, 0, 1.0 if hole else -1.0], points) * ARC
    handles = np.stack([points - along, points + along], axis=1)
    center = np.array([x, y, 0.0])
    return swept.splines("BEZIER", center + radius * points, center + radius * handles, cyclic=True, **settings)


def polygon(corners, **settings):
    """A closed poly spline; corners of an outline are given counter-clockwise, and go the other way."""
    points = np.concatenate([np.asarray(corners, float), np.zeros((len(corners), 1))], axis=1)[::-1]
    return swept.splines("POLY", points, cyclic=True, **settings)


def comb(teeth):
    """A comb with a spiral of notches: far from convex."""
    x = np.arange(2 * teeth)
    top = [(i, 1.0 if i % 2 else 0.1 + 0.05 * (i % 3)) for i in x]
    return np.array([(0, -1), (2 * teeth - 1, -1), *top[::-1]], float) / teeth


def star(points, inner):
    angle = np.linspace(0, 2 * np.pi, 2 * points, endpoint=False)
    return np.stack([np.cos(angle), np.sin(angle)], axis=1) * np.where(np.arange(2 * points) % 2, inner, 1.0)[:, None]


AREAS = {
    "disk": lambda: [circle()],
    "ring": lambda: [circle(), circle(radius=0.5, hole=True)],
    "island in a hole": lambda: [circle(), circle(radius=0.8, hole=True), circle(radius=0.5)],
    "holes in a row": lambda: [
        polygon([(-2, -1), (2, -1), (2, 1), (-2, 1)]),
        *(circle(x, y, 0.3, hole=True) for x in (-1.4, -0.5, 0.5, 1.4) for y in (0.5, -0.5)),
    ],
    "holes that touch": lambda: [circle(), circle(-0.4, 0, 0.4, hole=True), circle(0.4, 0, 0.4, hole=True)],
    "a hole that touches its outline": lambda: [circle(), circle(0.5, 0, 0.5, hole=True)],
    "comb": lambda: [polygon(comb(15))],
    "star with a star": lambda: [polygon(star(9, 0.4)), polygon(0.3 * star(7, 0.5)[::-1])],
    "disks apart": lambda: [circle(3 * i, (i % 2), 1.0) for i in range(5)],
    "doubled points": lambda: [polygon(np.repeat(star(5, 0.5), 2, axis=0))],
}
# How an area becomes a body, or stays a sheet.
BODIES = {
    "sheet": {},
    "moved sheet": {"offset": 0.05},
    "extruded": {"extrude": 0.3, "fill": "HALF"},
    "bevelled": {"extrude": 0.2, "bevel_depth": 0.05, "fill": "HALF"},
    "front alone": {"bevel_depth": 0.05, "fill": "FRONT"},
    "gutter": {"profile": lambda: [swept.polygon([(0.0, -0.2), (0.1, 0.0), (0.0, 0.3)], cyclic=False)], "fill": "HALF"},
}


def filled(splines, body="sheet", materials=(0,), **settings):
    """A filled curve."""
    own = {key: value() if callable(value) else value for key, value in BODIES[body].items()}
    return _core.SweptCurve("area", splines, dimensions="2D", fill_materials=materials, **own, **settings)


def tracer_of(curve, offset=0.0):
    shape = _core.trace.SweptSurface(curve)
    return _core.trace.Tracer([(shape, shapes.moved(offset), shapes.EVERYTHING)], eye=(offset, offset, offset + 4))


def is_inside(shape, places):
    """By the number of borders that a line to the right crosses, from many chords."""
    inside = np.zeros(len(places), bool)
    for border in shape:
        a, b = border, np.roll(border, -1, axis=0)
        for start in range(0, len(places), 500):
            p = places[start : start + 500, None]
            crossing = (a[:, 1] > p[..., 1]) != (b[:, 1] > p[..., 1])
            with np.errstate(divide="ignore", invalid="ignore"):
                x = a[:, 0] + (p[..., 1] - a[:, 1]) / (b[:, 1] - a[:, 1]) * (b[:, 0] - a[:, 0])
            inside[start : start + 500] ^= (crossing & (x > p[..., 0])).sum(axis=1) % 2 == 1
    return inside


def borders(name):
    """The polygons of an area by themselves, from its splines' control points; dense."""
    t = np.linspace(0, 1, 400, endpoint=False)[:, None]
    found = []
    for kind, points, handles in OUTLINES[name]:
        if kind == "POLY":
            found.append(points[:, :2])
            continue
        following, next_handles = np.roll(points, -1, axis=0), np.roll(handles, -1, axis=0)
        pieces = [
            (1 - t) ** 3 * points[i]
            + 3 * t * (1 - t) ** 2 * handles[i, 1]
            + 3 * t * t * (1 - t) * next_handles[i, 0]
            + t**3 * following[i]
            for i in range(len(points))
        ]
        found.append(np.concatenate(pieces)[:, :2])
    return found


class _Recorder:
    """Notes what splines are made of while areas are built."""

    def __init__(self):
        self.found = []

    def __call__(self, kind, points, handles=None, **settings):
        self.found.append((kind, np.asarray(points), None if handles is None else np.asarray(handles)))


def _outlines():
    original, result = swept.splines, {}
    for name, make in AREAS.items():
        swept.splines = recorder = _Recorder()
        try:
            make()
        finally:
            swept.splines = original
        result[name] = recorder.found
    return result


OUTLINES = _outlines()


@pytest.mark.parametrize("name", AREAS)
def test_an_area_lies_where_its_outlines_say(name):
    random = np.random.default_rng(5)
    outlines = borders(name)
    low, high = np.min([b.min(axis=0) for b in outlines], axis=0), np.max([b.max(axis=0) for b in outlines], axis=0)
    places = random.uniform(low - 0.1, high + 0.1, (RAYS, 2))
    origins = np.column_stack([places, np.full(RAYS, 3.0)])
    hits = tracer_of(filled(AREAS[name]())).closest_hits(origins, np.tile(DOWN, (RAYS, 1)))
    hit, inside = hits["instance"] >= 0, is_inside(outlines, places)
    # Chords lie within a tenth of a pixel, 1e-3 rad of 3, and so does where they differ.
    near = np.min(
        [np.min(np.hypot(*(places[:, None] - b[None, ::8]).transpose(2, 0, 1)), axis=1) for b in outlines], axis=0
    )
    wrong = np.flatnonzero((hit != inside) & (near > 0.01))
    assert len(wrong) == 0, f"{places[wrong[:5]]!r}"
    assert inside.sum() > RAYS / 20
    np.testing.assert_allclose(hits["position"][hit, 2], 0, atol=1e-9)
    np.testing.assert_array_equal(hits["normal"][hit], np.tile([0.0, 0, 1], (hit.sum(), 1)))


@pytest.mark.parametrize("body", ["extruded", "bevelled", "gutter"])
@pytest.mark.parametrize("name", AREAS)
def test_rays_enter_a_filled_body_as_often_as_they_leave_it(name, body):
    random = np.random.default_rng(6)
    tracer = tracer_of(filled(AREAS[name](), body))
    low, high = np.array(tracer.bounds())
    size = np.linalg.norm(high - low)
    origins, directions = swept.rays_at(random.uniform(low, high, (RAYS, 3)), 2 * size, random)
    sums, hits = swept.balance(tracer, origins, directions, STEP * max(1.0, np.abs(origins).max()), most=128)
    wrong = np.flatnonzero(sums)
    assert len(wrong) == 0, f"{origins[wrong[:3]]!r} towards {directions[wrong[:3]]!r}: {sums[wrong[:3]]}"
    assert hits.sum() > RAYS / 10


def test_front_and_back_lie_at_the_ends_of_the_profile_and_face_away():
    tracer = tracer_of(filled([circle()], "bevelled"))
    for side in (1.0, -1.0):
        hit = tracer.closest_hits(np.array([[0.1, 0.2, side * 3]]), np.array([[0.0, 0, -side]]))
        np.testing.assert_allclose(hit["position"][0], [0.1, 0.2, side * 0.25], atol=1e-9)
        np.testing.assert_array_equal(hit["normal"][0], [0, 0, side])
    # The front alone: from below the ray meets its inner side.
    hit = tracer_of(filled([circle()], "front alone")).closest_hits(np.array([[0.1, 0.2, -3.0]]), -DOWN[None])
    np.testing.assert_allclose(hit["position"][0, 2], 0.05, atol=1e-9)


def test_the_border_is_the_curve_at_any_distance():
    """From near and from afar, the border of a disk is round to half a pixel of 1e-3 rad."""
    angle = np.linspace(-np.pi, np.pi, 2000)
    spline = swept.splines(
        "NURBS",
        np.array([[1, 0, 0, 1], [1, 1, 0, 0.5**0.5], [0, 1, 0, 1], [-1, 1, 0, 0.5**0.5], [-1, 0, 0, 1]]).tolist()
        + np.array([[-1, -1, 0, 0.5**0.5], [0, -1, 0, 1], [1, -1, 0, 0.5**0.5]]).tolist(),
        order=3,
        cyclic=True,
        bezier=True,
        endpoint=True,
    )
    shape = _core.trace.SweptSurface(filled([spline]))
    for near, spread in ((1.0, angle), (0.1, 0.03 * angle)):
        step = 5e-4 * near
        tracer = _core.trace.Tracer([(shape, np.eye(4), shapes.EVERYTHING)], eye=(1, 0, near))
        ring = np.column_stack([np.cos(spread), np.sin(spread), np.full(len(spread), near)])
        for factor, wanted in ((1 - step, 0), (1 + step, -1)):
            hits = tracer.closest_hits(ring * [factor, factor, 1], np.tile(DOWN, (len(ring), 1)))
            assert (hits["instance"] == wanted).all()


def test_groups_are_filled_by_themselves_with_their_own_material():
    """Two disks that overlap: in one group there would be a hole where they do."""
    curve = filled([circle(fill_group=0), circle(0.5, 0.1, fill_group=1)], materials=(3, 5))
    assert not curve.borders_cross()
    shape = _core.trace.SweptSurface(curve)
    assert shape.element_count == 2
    hits = tracer_of(curve).closest_hits(np.array([[0.25, 0, 3.0], [-0.7, 0, 3], [1.3, 0, 3]]), np.tile(DOWN, (3, 1)))
    assert (hits["instance"] == 0).all()


@pytest.mark.parametrize(
    ("splines", "crosses"),
    [
        ([circle()], False),
        ([circle(), circle(radius=0.5, hole=True)], False),
        ([circle(), circle(0.7, 0)], True),
        ([polygon([(0, 0), (1, 1), (1, 0), (0, 1)])], True),
        ([polygon(comb(20))], False),
        ([polygon([(0, 0), (2, 0), (2, 1), (1, 0), (0, 1)])], False),
    ],
)
def test_outlines_that_cross_are_found(splines, crosses):
    assert filled(splines).borders_cross() == crosses


def test_crossing_outlines_are_filled_somehow():
    random = np.random.default_rng(8)
    outlines = [polygon([(0, 0), (1, 1), (1, 0), (0, 1)]), circle(0.5, 0.5, 0.4), circle(0.2, 0.2, 0.4, hole=True)]
    tracer = tracer_of(filled(outlines, "extruded"))
    hits = tracer.closest_hits(*swept.rays_at(random.uniform(-0.3, 1.2, (RAYS, 3)), 4.0, random))
    assert (hits["instance"] == 0).sum() > RAYS / 10 and np.isfinite(hits["position"]).all()


def test_a_thousand_holes_are_soon_cut_out():
    side = 32
    holes = [circle(2 * i + 1, 2 * j + 1, 0.6, hole=True) for i in range(side) for j in range(side)]
    frame = polygon([(0, 0), (2 * side, 0), (2 * side, 2 * side), (0, 2 * side)])
    tracer = tracer_of(filled([frame, *holes]))
    random = np.random.default_rng(9)
    places = random.uniform(0, 2 * side, (RAYS, 2))
    hits = tracer.closest_hits(np.column_stack([places, np.full(RAYS, 3.0)]), np.tile(DOWN, (RAYS, 1)))
    far = np.hypot(*(places % 2 - 1).T)
    clear = np.abs(far - 0.6) > 0.01
    np.testing.assert_array_equal((hits["instance"] >= 0)[clear], (far > 0.6)[clear])


@pytest.mark.parametrize(
    ("argument", "settings"),
    [
        ("fill_materials", {"dimensions": "3D", "fill_materials": [0]}),
        ("fill_materials", {"dimensions": "2D", "fill_materials": [-1]}),
        ("fill_group", {"dimensions": "2D", "fill_materials": [0], "splines": [circle(fill_group=1)]}),
    ],
)
def test_bad_fills_are_named(argument, settings):
    with pytest.raises(_core.InputError, match=f"area.*{argument}"):
        _core.SweptCurve("area", settings.pop("splines", [circle()]), **settings)


@pytest.mark.parametrize("splines", [[], [circle(radius=0.0)], [polygon([(0, 0)])], [polygon([(0, 0), (1, 0)])]])
def test_outlines_without_area_are_no_problem(splines):
    hits = tracer_of(filled(splines, "extruded")).closest_hits(np.array([[0.3, 0.2, 3.0]]), DOWN[None])
    assert hits["instance"][0] < 0
