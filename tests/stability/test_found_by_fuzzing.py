"""What `rayleaf fuzz` found, said in plain words; the inputs themselves are in tests/fuzz/cases."""

import numpy as np
import pytest
import strand_shapes
import swept_support
from core import shapes
from rayleaf import _core

trace = shapes.trace


@pytest.mark.parametrize("length", [1e-300, 1e-160, 1e160, 1e300])
@pytest.mark.parametrize("shape", ["cube", "nurbs_sphere"])
def test_the_length_of_a_direction_does_not_matter(shape, length):
    """The square of such a length is zero or infinite; Embree was given infinite directions, and ended the process."""
    tracer = trace.Tracer([(getattr(shapes, shape)(), np.eye(4), shapes.EVERYTHING)])
    origins = np.array([[0.1, 0.2, 3.0]])
    plain = tracer.closest_hits(origins, np.array([[0.0, 0.0, -1.0]]))
    scaled = tracer.closest_hits(origins, np.array([[0.0, 0.0, -length]]))
    assert scaled["instance"][0] == 0
    np.testing.assert_allclose(scaled["t"] * length, plain["t"], rtol=1e-6)
    np.testing.assert_allclose(scaled["position"], plain["position"], atol=1e-6)


@pytest.mark.parametrize("length", [1e-300, 1e-170, 1e170])
def test_a_hit_beside_the_edge_of_a_facet_has_a_distance_whatever_the_direction_is_long(length):
    """A hit that single precision sees inside a facet and double precision beside it was as far away as infinity."""
    tracer = trace.Tracer([(shapes.lumpy_mesh(), np.eye(4), shapes.EVERYTHING)])
    random = np.random.default_rng(8)
    steps = np.arange(1, 32) * np.pi / 32
    heights = 1 + 0.1 * np.sin(4 * steps)  # of the vertices above the x axis: rays meet the edges between them
    share, first = random.uniform(0, 1, 3000), random.integers(0, 30, 3000)
    ends = (
        np.column_stack([heights * np.sin(steps), 0 * steps, heights * np.cos(steps)]).astype(np.float32).astype(float)
    )
    targets = ends[first] * (1 - share)[:, None] + ends[first + 1] * share[:, None]
    origins = 2 * shapes.random_directions(random, 3000) + [3, 0, 0]
    directions = shapes.unit(targets - origins)
    plain, scaled = (tracer.closest_hits(origins, directions * each)["t"] for each in (1.0, length))
    np.testing.assert_allclose(scaled * length, plain, rtol=1e-9)


@pytest.mark.parametrize("distance", [1e17, 1e19, 1e30, 1e300])
def test_origins_beyond_all_bounds_are_hits_or_misses(distance):
    """After rounding, the point where such a ray enters a box may be beyond what Embree takes."""
    tracer = trace.Tracer([(shapes.cube(), np.eye(4), shapes.EVERYTHING)])
    random = np.random.default_rng(3)
    origins = distance * shapes.random_directions(random, 500)
    towards = shapes.unit(random.normal(size=(500, 3)) / distance - origins / distance)
    hits = tracer.closest_hits(origins, towards)
    assert np.isfinite(hits["position"]).all()


@pytest.mark.parametrize("size", [1e-10, 1e-25, 1e-40])
def test_embrees_round_curves_may_be_as_small_as_they_like(size):
    """Embree scales the boxes of neighbouring curves by one over their size, and ended the process at infinity."""
    strands = []
    for start, extent in (((0, 0, 0), size), ((0, 0, 1), 1.0)):
        along = np.linspace(0, 1, 4)[:, None] * np.array([extent, 0.5 * extent, 0])
        strands.append(along + start)
    points = np.concatenate(strands)
    radii = np.array([size] * 4 + [0.1] * 4, np.float32)
    offsets = np.array([0, 4, 8], np.int32)
    hair = _core.Strands("hair", points, radii, offsets, form="EMBREE_ROUND")
    hits = strand_shapes.tracer(hair).closest_hits(np.array([[0.5, 0.25, 5.0]]), np.array([[0.0, 0.0, -1.0]]))
    assert hits["instance"][0] == 0


@pytest.mark.parametrize("width, height", [(2_000_000, 2_000_000), (1_000_000, 1), (0, 5)])
def test_a_header_that_claims_any_size_is_refused_before_memory_is_taken(tmp_path, width, height):
    path = tmp_path / "claims.pgm"
    path.write_bytes(b"P5\n%d %d\n255\n" % (width, height) + bytes(100))
    with pytest.raises(_core.InputError, match="claims.pgm"):
        _core.shading.TextureStore(1 << 27).add_file("image", str(path), _core.shading.ColorSpace.SRGB)


@pytest.mark.parametrize("name, least", [("tessellation_factor", 0.01), ("irradiance_error", 0.01)])
def test_the_least_value_that_a_setting_allows_is_allowed(name, least):
    """As a float it is a little less than the double that it was compared with."""
    settings = _core.Settings(width=4, height=4, **{name: least})
    assert _core.Session(_core.SceneDescription(), settings).progress()[0] == "waiting"


@pytest.mark.parametrize("ends", ["first handle on its point", "last handle on its point", "both", "thirds"])
def test_a_straight_segment_under_tangent_twist_is_one_piece(ends):
    """Handles that lie on the line leave no direction to bend about; rounding gave one, another at every look, and the
    segment was cut for hours."""
    first, last = np.array([-5.75, -5.75, -5.75]), np.array([-0.6875, -1.6875, -1.9375])
    third, two_thirds = first + (last - first) / 3, last - (last - first) / 3
    inner = {
        "first handle on its point": (first, last),
        "last handle on its point": (third, last),
        "both": (first, last),
        "thirds": (third, two_thirds),
    }[ends]
    near = first if ends == "first handle on its point" else inner[1]
    handles = np.array([[first, inner[0]], [near, last]])
    tube = swept_support.surface("BEZIER", np.array([first, last]), handles, bevel_depth=0.1, twist="TANGENT")
    assert tube.element_count <= 16


def test_a_curve_whose_binormal_turns_wildly_has_bounded_pieces():
    """Nearly straight, by a little more than rounding."""
    random = np.random.default_rng(4)
    line = np.linspace(0, 1, 4)[:, None] * np.array([[3.0, 2.0, 1.0]])
    for size in (1e-15, 1e-12, 1e-9, 1e-6):
        points = line + size * random.normal(size=line.shape)
        handles = np.array([[points[0], points[1]], [points[2], points[3]]])
        tube = swept_support.surface("BEZIER", points[[0, 3]], handles, bevel_depth=0.1, twist="TANGENT")
        assert tube.element_count <= 3 * 4096
