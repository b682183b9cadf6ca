"""Input of strands: invalid data is named, empty input renders, and a million strands fit."""

import numpy as np
import pytest
from core.strand_shapes import S_CURVE, strand, tracer

GOOD = {
    "name": "Beard",
    "points": np.zeros((4, 3)) + np.arange(4)[:, None],
    "radii": np.full(4, 0.1, np.float32),
    "offsets": np.array([0, 4], np.int32),
}


@pytest.mark.parametrize(
    "change, words",
    [
        ({"points": np.array([[0, 0, 0], [np.nan, 0, 0], [2, 0, 0], [3, 0, 0]])}, r"points\[1\].*finite"),
        ({"radii": np.array([0.1, 0.1, np.nan, 0.1], np.float32)}, r"radii\[2\].*nan"),
        ({"radii": np.array([0.1, -0.5, 0.1, 0.1], np.float32)}, r"radii\[1\].*-0.5"),
        ({"radii": np.array([0.1], np.float32)}, "radii.*1 numbers.*4"),
        ({"offsets": np.array([0, 3], np.int32)}, "offsets"),
        ({"offsets": np.array([], np.int32)}, "offsets is empty"),
        ({"offsets": np.array([0, 3, 2, 4], np.int32)}, r"offsets\[2\]"),
        ({"offsets": np.array([1, 4], np.int32)}, "offsets"),
        ({"basis": "CUBIC"}, "basis.*CUBIC.*CATMULL_ROM"),
        ({"form": "SQUARE"}, "form.*SQUARE.*RIBBON"),
        ({"basis": "BEZIER", "points": np.zeros((3, 3)), "radii": np.zeros(3, np.float32),
          "offsets": np.array([0, 3], np.int32)}, "strand 0.*3 points"),
        ({"material_slots": np.array([-1], np.int32)}, "material_slots.*-1"),
        ({"cyclic": np.array([0, 1], np.uint8)}, "cyclic.*2 numbers"),
        ({"attributes": {0: np.zeros((2, 3), np.float32)}}, r"attributes\[0\]"),
        ({"point_attributes": {0: np.full((4, 1), np.inf, np.float32)}}, r"attributes\[0\].*inf"),
        ({"attributes": {0: np.zeros((1, 5), np.float32)}}, "channels.*5"),
        ({"spheres_per_segment": 0}, "spheres_per_segment"),
        ({"info": {"COLOUR": 1}}, "info.*COLOUR"),
    ],
)  # fmt: skip
def test_bad_strands_are_named(core, change, words):
    with pytest.raises(core.InputError, match="Beard.*" + words):
        core.Strands(**(GOOD | change))


@pytest.mark.parametrize("form", ["ROUND", "RIBBON", "SPHERES", "EMBREE_ROUND"])
@pytest.mark.parametrize("counts", [[], [0], [1], [0, 1, 0]])
def test_strands_of_less_than_two_points_are_nothing(core, counts, form):
    total = sum(counts)
    offsets = np.concatenate([[0], np.cumsum(counts)]).astype(np.int32)
    shape = core.Strands("none", np.ones((total, 3)), np.ones(total, np.float32), offsets, form=form)
    assert shape.element_count == 0
    assert not tracer(shape).occluded([[0, 0, -5]], [[0, 0, 1]]).any()


@pytest.mark.parametrize("form", ["ROUND", "RIBBON", "SPHERES"])
def test_a_strand_without_radius_is_never_hit(form):
    scene = tracer(strand(S_CURVE, 0.0, basis="BEZIER", form=form))
    assert not scene.occluded([[0, 0, -5], [0.5, 0, -5]], [[0, 0, 1], [0, 0, 1]]).any()


def test_points_that_coincide_are_a_ball():
    hits = tracer(strand([[1, 2, 3]] * 5, 0.5)).closest_hits([[1, 2, 0]], [[0, 0, 1]])
    assert np.allclose(hits["t"], 2.5)


def test_attributes_of_strands_points_and_the_strand_itself_reach_shading(core):
    from core import scenes

    def rendered(identifier, **arguments):
        """The emission of two vertical strands, left and right, where they show the attribute."""
        scene = core.SceneDescription()
        program = core.Program("show")
        value = program.operation("attribute", ints=[identifier])
        one = program.constant(1, 1, 1, 1)
        program.operation("emission", [one, value, one])
        materials = scene.add_material_list([scene.add_material("show", program)])
        points = np.array([[-0.5, -1, 0], [-0.5, 1, 0], [0.5, -1, 0], [0.5, 1, 0]], float)
        shape = core.Strands(
            "two", points, np.full(4, 0.2, np.float32), np.array([0, 2, 4], np.int32), basis="LINEAR", **arguments
        )
        scene.add_instance("two", scene.add_shape(shape), scenes.matrix(), materials)
        scenes.look_down(scene, 5.0, 0.2)
        picture = scenes.render(core, scene, width=8, height=8, samples=1, filter="BOX")["combined"]
        return picture[:, [2, 5], 0]

    per_strand = rendered(3, attributes={3: np.array([[0.25], [0.75]], np.float32)})
    assert np.allclose(per_strand, [0.25, 0.75])
    per_point = rendered(3, point_attributes={3: np.array([[0], [1], [1], [0]], np.float32)})
    # A sample lies anywhere in its pixel, so neighbours may swap places.
    rising = per_point * [1, -1] + [0, 1]
    assert np.all(rising[0] < 0.25) and np.all(rising[-1] > 0.75) and np.all(np.diff(rising[::2], axis=0) > 0)
    assert np.allclose(rendered(4, info={"IS_STRAND": 4}), 1) and np.allclose(rendered(4, info={"LENGTH": 4}), 2)
    assert np.allclose(rendered(4, info={"THICKNESS": 4}), 0.4)
    intercept = rendered(4, info={"INTERCEPT": 4})
    assert np.allclose(intercept, rising[:, :1], atol=0.15)


def test_a_million_strands_take_little_more_than_their_points(core):
    count, points = 1_000_000, 3
    random = np.random.default_rng(0)
    roots = random.random((count, 1, 3))
    shape = core.Strands(
        "fur",
        (roots + np.linspace(0, 0.02, points)[None, :, None] * np.array([0.1, 0.2, 1])).reshape(-1, 3),
        np.full(count * points, 1e-4, np.float32),
        np.arange(0, count * points + 1, points, dtype=np.int32),
    )
    # 32 bytes a point, and 4 each for the strand of a segment and where strands begin.
    assert shape.bytes < count * (points * 32 + (points - 1) * 4 + 8) * 1.05
