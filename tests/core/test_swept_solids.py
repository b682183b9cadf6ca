"""Closed tubes are watertight: every ray that is followed through one enters as often as it leaves."""

import numpy as np
import pytest
from core import shapes
from core import swept_support as swept
from rayleaf import _core

RAYS = 8000
# What a ray is moved on behind a facet: facets closer together than this count once.
STEP = 1e-12
CIRCLE = np.array([[1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0]], float)
ARC = 0.5523
CIRCLE_HANDLES = np.array(
    [
        [[1, -ARC, 0], [1, ARC, 0]],
        [[ARC, 1, 0], [-ARC, 1, 0]],
        [[-1, ARC, 0], [-1, -ARC, 0]],
        [[-ARC, -1, 0], [ARC, -1, 0]],
    ]
)
ANGLE = np.linspace(0, 2 * np.pi, 24, endpoint=False)
KNOT = np.stack(
    [(2 + np.cos(3 * ANGLE)) * np.cos(2 * ANGLE), (2 + np.cos(3 * ANGLE)) * np.sin(2 * ANGLE), np.sin(3 * ANGLE)],
    axis=1,
)
ZIGZAG = np.array([[0, 0, 0], [1, 0, 0], [0.1, 0.05, 0.02], [1, 0.5, 0.5], [1, 0.5, 0.5], [2, 0, 0]], float)
TURNS = np.linspace(0, 2 * np.pi, 10, endpoint=False)
STAR = 0.1 * np.stack([np.cos(TURNS), np.sin(TURNS)], axis=1) * np.where(np.arange(10) % 2, 1.0, 0.3)[:, None]
# A gutter, which no point inside sees whole.
GUTTER = 0.1 * np.array([[-1, -1], [1, -1], [1, 1], [0.6, 1], [0.6, -0.6], [-0.6, -0.6], [-0.6, 1], [-1, 1]])
CUSP = (np.array([[0.0, 0, 0], [1, 0, 0]]), np.array([[[0.0, 0, 0], [1, 1, 0]], [[0, 1, 0], [1, 0, 0]]]))
HAIRPIN = (np.array([[0.0, 0, 0], [0.05, 0.02, 0]]), np.array([[[-1.0, 0, 0], [1, 0, 0]], [[1, 0.02, 0], [-1, 0, 0]]]))
ON_POINT = (np.array([[0.0, 0, 0], [1, 1, 0]]), np.array([[[0.0, 0, 0], [0, 0, 0]], [[1, 1, 0], [1, 1, 0]]]))
CORNER = np.array(
    [[[-0.3, 0, 0], [0.4, 0.5, -0.1]], [[0.7, 0.1, 0.5], [0.2, 0.9, 0.8]], [[1.5, 0.2, 1], [1.7, -0.8, 0.8]]]
)
WEIGHTS = np.random.default_rng(9).uniform(0.1, 10, (8, 1))
ROD = {"bevel_depth": 0.1, "fill_caps": True}
TAPER = swept.splines("POLY", [[0, 1, 0], [0.5, 0.2, 0], [1, 0.7, 0]])

SOLIDS = {
    "straight rod": lambda: swept.surface("POLY", [[0, 0, 0], [1, 0.2, 0.1]], **ROD),
    "bent rod": lambda: swept.bend(**ROD),
    "ring": lambda: swept.surface("BEZIER", CIRCLE, CIRCLE_HANDLES, cyclic=True, bevel_depth=0.2),
    "knot": lambda: swept.surface("NURBS", KNOT, cyclic=True, bevel_depth=0.5),
    "knot that touches itself": lambda: swept.surface("NURBS", KNOT, cyclic=True, bevel_depth=0.9),
    "star profile": lambda: swept.bend(profile=[swept.polygon(STAR)], fill_caps=True, twist="Z_UP"),
    "gutter profile": lambda: swept.bend(profile=[swept.polygon(GUTTER)], fill_caps=True),
    "clockwise gutter": lambda: swept.bend(profile=[swept.polygon(GUTTER[::-1])], fill_caps=True),
    "closed gutter": lambda: swept.surface(
        "NURBS", KNOT, cyclic=True, profile=[swept.polygon(GUTTER)], twist="TANGENT"
    ),
    "two profiles": lambda: swept.bend(profile=[swept.polygon(STAR), swept.polygon(GUTTER + 0.3)], fill_caps=True),
    "round profile object": lambda: swept.bend(
        profile=[swept.splines("BEZIER", 0.1 * CIRCLE, 0.1 * CIRCLE_HANDLES, cyclic=True)], fill_caps=True
    ),
    "extruded": lambda: swept.bend(extrude=0.2, **ROD),
    "offset": lambda: swept.bend(offset=0.3, **ROD),
    "negative depth": lambda: swept.bend(bevel_depth=-0.1, fill_caps=True),
    "pointed ends": lambda: swept.bend(radii=np.array([0.0, 1, 0]), **ROD),
    "negative radius": lambda: swept.bend(radii=np.array([1.0, -1, 1]), **ROD),
    "tilted": lambda: swept.bend(
        radii=np.array([0.5, 2, 1]),
        tilts=np.array([0, 3.0, 1]),
        radius_interpolation="CARDINAL",
        tilt_interpolation="EASE",
        profile=[swept.polygon(STAR)],
        fill_caps=True,
    ),
    "polygon": lambda: swept.surface("POLY", ZIGZAG, **ROD),
    "closed polygon": lambda: swept.surface("POLY", CIRCLE, cyclic=True, bevel_depth=0.2),
    "mitred polygon": lambda: swept.surface("POLY", CIRCLE[:3] + [0.1, 0.2, 0], dimensions="2D", extrude=0.2, **ROD),
    "outline": lambda: swept.surface(
        "BEZIER", CIRCLE, CIRCLE_HANDLES, cyclic=True, dimensions="2D", bevel_depth=0.1, extrude=0.2
    ),
    "NURBS that starts askew": lambda: swept.surface("NURBS", KNOT[:8], **ROD),
    "NURBS of order 2": lambda: swept.surface("NURBS", KNOT[:8], order=2, **ROD),
    "NURBS of order 6": lambda: swept.surface(
        "NURBS", np.concatenate([KNOT[:8], WEIGHTS], axis=1), order=6, endpoint=True, **ROD
    ),
    "cusp": lambda: swept.surface("BEZIER", *CUSP, **ROD),
    "hairpin tighter than the radius": lambda: swept.surface("BEZIER", *HAIRPIN, **ROD),
    "handles on the points": lambda: swept.surface("BEZIER", *ON_POINT, **ROD),
    "corner": lambda: swept.surface("BEZIER", swept.BEND_POINTS, CORNER, **ROD),
    "straight and curved": lambda: swept.surface(
        "BEZIER", swept.BEND_POINTS, CORNER, straight=np.array([True, False, False]), **ROD
    ),
    "part of a rod": lambda: swept.bend(bevel_start=0.7, bevel_end=0.2, end_mapping="SPLINE", **ROD),
    "part of a polygon": lambda: swept.surface("POLY", ZIGZAG, bevel_start=0.13, bevel_end=0.77, **ROD),
    "tapered": lambda: swept.bend(taper=TAPER, **ROD),
    "taper that fits the bevel": lambda: swept.bend(
        taper=TAPER, taper_fits_bevel=True, bevel_start=0.3, bevel_end=0.6, **ROD
    ),
    "far from its origin": lambda: swept.surface(
        "BEZIER", swept.BEND_POINTS + 1e6, swept.BEND_HANDLES + 1e6, bevel_depth=0.1, fill_caps=True
    ),
}


@pytest.mark.parametrize("name", SOLIDS)
def test_rays_enter_a_closed_tube_as_often_as_they_leave_it(name):
    random = np.random.default_rng(21)
    tracer = _core.trace.Tracer([(SOLIDS[name](), np.eye(4), shapes.EVERYTHING)], eye=(0, 0, 5))
    low, high = np.array(tracer.bounds())
    size = np.linalg.norm(high - low)
    origins, directions = swept.rays_at(random.uniform(low, high, (RAYS, 3)), 2 * size, random)
    step = STEP * max(1.0, np.abs(origins).max())
    sums, hits = swept.balance(tracer, origins, directions, step)
    wrong = np.flatnonzero(sums)
    assert len(wrong) == 0, f"{origins[wrong[:3]]!r} towards {directions[wrong[:3]]!r}: {sums[wrong[:3]]}"
    assert hits.sum() > RAYS / 10
    first = tracer.closest_hits(origins, directions)
    for value in ("position", "normal", "derivatives", "uv"):
        assert np.isfinite(first[value]).all(), value
    found = first["instance"] >= 0
    np.testing.assert_allclose(np.linalg.norm(first["normal"][found], axis=1), 1, atol=1e-6)
    # The exact point belongs to the facet that was hit: they lie within the tolerance and the facets' own size.
    assert np.linalg.norm(first["position"] - first["facet_position"], axis=1)[found].max() < 0.01 * size


@pytest.mark.parametrize("name", ["bent rod", "gutter profile", "pointed ends", "polygon"])
def test_a_ray_that_leaves_a_wall_to_the_inside_finds_the_next_one(name):
    random = np.random.default_rng(22)
    tracer = _core.trace.Tracer([(SOLIDS[name](), np.eye(4), shapes.EVERYTHING)], eye=(0, 0, 5))
    low, high = np.array(tracer.bounds())
    hits = tracer.closest_hits(*swept.rays_at(random.uniform(low, high, (RAYS, 3)), 5.0, random))
    found = hits["instance"] >= 0
    hits = {key: value[found] for key, value in hits.items()}
    for _ in range(4):
        normals = hits["facet_normal"].astype(float)
        directions = shapes.random_directions(random, len(normals))
        directions *= -np.sign(np.sum(normals * directions, axis=1))[:, None]
        hits = tracer.closest_hits(shapes.leaving(hits, directions), directions)
        assert (hits["instance"] == 0).all()
        # Met from inside, but for rays that start where walls cross or meet: they may be inside one and outside another.
        inside = np.sum(hits["facet_normal"] * directions, axis=1) > 0
        if name in ("bent rod", "pointed ends"):
            assert inside.mean() > 0.999
        hits = {key: value[inside] for key, value in hits.items()}


@pytest.mark.parametrize("target", ["EMU128", "SCALAR", "SSE2", "SSE4", "AVX2", "AVX3", "AVX3_ZEN4"])
def test_every_vector_width_finds_the_same_hits(target):
    if target not in _core.trace.simd_targets():
        pytest.skip("not on this machine, or not compiled in")
    random = np.random.default_rng(23)
    rays = swept.rays_at(
        swept.along(swept.segments(swept.BEND_POINTS, swept.BEND_HANDLES), random.uniform(0, 1, 2000))[0], 3.0, random
    )
    found = []
    for chosen in ("", target):
        assert _core.trace.use_simd_target(chosen)
        try:
            tracer = _core.trace.Tracer([(SOLIDS["bent rod"](), np.eye(4), shapes.EVERYTHING)])
            found.append(tracer.closest_hits(*rays))
        finally:
            _core.trace.use_simd_target("")
    for key, value in found[0].items():
        np.testing.assert_array_equal(value, found[1][key], err_msg=key)
