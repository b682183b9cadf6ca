"""The rivals of ray caches see the same surfaces, and sets of objects answer like their members."""

import numpy as np
import pytest
import rayleaf_rivals
from core import ri_tree_support as support
from core import shapes
from core.ri_tree_support import INTERPOLATED
from rayleaf import _core

OPEN = (4, False, False, False)


def sheet(center=(0.0, 0.0, 0.0)):
    """A waved sheet of 4 x 4 bicubic patches."""
    place = np.linspace(-1.75, 1.75, 7)
    x, y = np.meshgrid(place, place)
    points = np.stack([x, y, 0.2 * np.sin(2 * x) * np.cos(1.5 * y), np.ones_like(x)], axis=2)
    points[..., :3] += center
    return shapes.trace.PatchSurface("sheet", [(points, OPEN, OPEN, True, 0)])


def lens():
    """Two sheets of one cubic patch that meet in their borders, bulging: a closed pillow."""
    place = np.linspace(-1, 1, 4)
    x, y = np.meshgrid(place, place)
    bulge = np.zeros((4, 4))
    bulge[1:3, 1:3] = 0.6
    above = np.stack([x, y, bulge, np.ones_like(x)], axis=2)
    below = np.stack([x, y, -bulge, np.ones_like(x)], axis=2)
    bezier = (4, False, True, True)
    # The outside is the side of P_v x P_u.
    splines = [(above.transpose(1, 0, 2).copy(), bezier, bezier, True, 0), (below, bezier, bezier, True, 0)]
    return shapes.trace.PatchSurface("lens", splines)


@pytest.mark.parametrize("kind", ["SIMPLE", "MIRROR", "GLASS", "VOLUME"])
@pytest.mark.parametrize("method", ["TRIANGLES", "NEWTON"])
def test_rivals_answer_as_the_sample_tracer(kind, method):
    shape = lens() if kind in ("GLASS", "VOLUME") else sheet()
    origins, directions = support.scattered_rays(600, spread=0.7)
    truth = support.tree_of(shape, kind).trace(origins, directions)
    rival = rayleaf_rivals.RivalTracer([(shape, kind, 1.45)], method)
    got = rival.trace(origins, directions)
    same = truth["hit"] == (got["object"] == 0)
    # Facets of 16 x 16 cells lack slivers at silhouettes.
    assert same.mean() > 0.99
    hit = truth["hit"] & same
    assert hit.sum() > 200
    if kind == "VOLUME":
        # Facets are inside the surface at grazing rays.
        off = np.abs(got["length"] - truth["length"])[hit]
        assert np.median(off) < 0.008 and (off > 0.02).mean() < 0.04, np.sort(off)[-20:]
        return
    off = support.angles(got["exit_direction"][hit].astype(float), truth["exit_direction"][hit])
    assert np.median(off) < 2e-3 and (off > 0.05).mean() < 0.03, np.sort(off)[-20:]
    np.testing.assert_allclose(np.median(np.abs(got["exit_position"][hit] - truth["exit_position"][hit])), 0, atol=2e-3)


@pytest.mark.parametrize("kind", ["MIRROR", "GLASS", "VOLUME"])
def test_packets_answer_as_single_rays(kind):
    rival = rayleaf_rivals.RivalTracer([(lens(), kind, 1.45)], "TRIANGLES")
    origins, directions = support.scattered_rays(1003, spread=0.7)
    single, packets = rival.trace(origins, directions), rival.trace(origins, directions, packets=True)
    np.testing.assert_array_equal(single["object"], packets["object"])
    hit = single["object"] == 0
    assert hit.sum() > 300
    # Embree's packet kernels round differently; near a border of total reflection that changes the path.
    off = np.linalg.norm(single["exit_direction"] - packets["exit_direction"], axis=1)[hit]
    assert (off > 1e-3).mean() < 0.01
    assert (np.abs(single["length"] - packets["length"])[hit] > 1e-3).mean() < 0.01


def test_rivals_name_what_they_cannot_trace():
    with pytest.raises(_core.InputError, match="sphere.*degree 3"):
        rayleaf_rivals.RivalTracer([(shapes.nurbs_sphere(), "MIRROR", 1.5)], "NEWTON")
    with pytest.raises(_core.InputError, match="method"):
        rayleaf_rivals.RivalTracer([(sheet(), "MIRROR", 1.5)], "GUESSING")
    with pytest.raises(_core.InputError, match="packets"):
        rayleaf_rivals.RivalTracer([(sheet(), "MIRROR", 1.5)], "NEWTON").trace(*support.scattered_rays(4), packets=True)


def test_a_set_of_objects_answers_with_the_nearest():
    near, far = sheet((0, 0, 1.0)), sheet((0, 0, -1.0))
    parts = [(shape, support.tree_of(shape, "MIRROR")) for shape in (far, near)]
    objects = rayleaf_rivals.ObjectSet(parts, traced=True)
    random = np.random.default_rng(3)
    origins = np.concatenate([random.uniform(-2.5, 2.5, (500, 2)), np.full((500, 1), 4.0)], axis=1)
    directions = shapes.unit(random.normal(0, 0.3, (500, 3)) - [0, 0, 1])
    got = objects.ask(origins, directions)
    each = [tree.trace(origins, directions) for _, tree in parts]
    expected = np.where(each[1]["hit"], 1, np.where(each[0]["hit"], 0, -1))
    assert {-1, 0, 1} <= set(expected)
    np.testing.assert_array_equal(got["object"], expected)
    left = np.ones(500, np.int32)
    np.testing.assert_array_equal(objects.ask(origins, directions, left=left)["object"] == 0, each[0]["hit"])
    lengths = rayleaf_rivals.ObjectSet(
        [(lens(), support.tree_of(lens(), "VOLUME"))] * 2, traced=True, sum_of_lengths=True
    )
    once = support.tree_of(lens(), "VOLUME").trace(origins, directions)["length"]
    np.testing.assert_allclose(lengths.ask(origins, directions)["length"], 2 * once, rtol=1e-6)


EYE, SIDE = np.array([0.4, -3.5, 2.0]), 192


def picture(order=None):
    """A camera's frame, and rays with their points in the picture."""
    forward = shapes.unit(-EYE[None])[0]
    right = shapes.unit(np.cross(forward, [0, 0, 1])[None])[0] * 0.9 / SIDE
    up = np.cross(right, forward)
    corner = forward - SIDE / 2 * (right + up)
    x, y = np.meshgrid(np.arange(SIDE) + 0.5, np.arange(SIDE) + 0.5)
    points = np.stack([x.ravel(), y.ravel()], axis=1)
    if order is not None:
        points = points[order]
    directions = shapes.unit(corner + points[:, :1] * right + points[:, 1:] * up)
    return (EYE, corner, right, up), np.broadcast_to(EYE, directions.shape).copy(), directions, points


@pytest.mark.parametrize("kind", ["SIMPLE", "MIRROR", "GLASS", "VOLUME"])
def test_the_image_plane_interpolates_camera_rays(kind):
    shape = lens() if kind in ("GLASS", "VOLUME") else sheet()
    camera, origins, directions, points = picture()
    plane = rayleaf_rivals.ImagePlane(shape, kind)
    plane.look(*camera)
    objects = rayleaf_rivals.ObjectSet([(shape, plane)])
    got = objects.ask(origins, directions, points=points)
    truth = support.tree_of(shape, kind, facet_tolerance=2.0**-16).trace(origins, directions)
    interpolated = got["answered_by"] == INTERPOLATED
    assert interpolated.sum() > 0.35 * truth["hit"].sum() and plane.statistics()["samples_taken"] < 0.5 * len(origins)
    assert ((got["object"] == 0) != truth["hit"]).mean() < 0.002
    both = interpolated & truth["hit"]
    if kind == "VOLUME":
        assert np.abs(got["length"] - truth["length"])[both].mean() < np.radians(1)
    else:
        off = support.angles(got["exit_direction"].astype(float), truth["exit_direction"])[both]
        assert off.mean() < np.radians(1), np.degrees(off.mean())
    traced = np.char.startswith(np.array(support.ANSWERS)[got["answered_by"]], "traced")
    assert traced.any()
    np.testing.assert_array_equal(
        got["exit_direction"][traced], truth["exit_direction"][traced].astype(np.float32), err_msg=kind
    )


def test_the_image_plane_does_not_depend_on_the_order_of_rays():
    camera, origins, directions, points = picture()
    order = np.random.default_rng(8).permutation(len(points))
    answers = []
    for chosen in (slice(None), order):
        plane = rayleaf_rivals.ImagePlane(lens(), "GLASS")
        plane.look(*camera)
        objects = rayleaf_rivals.ObjectSet([(lens(), plane)])
        answers.append(objects.ask(origins[chosen], directions[chosen], points=points[chosen]))
    for name in ("object", "answered_by", "position", "normal", "exit_position", "exit_direction"):
        np.testing.assert_array_equal(answers[0][name][order], answers[1][name], err_msg=name)


def test_the_image_plane_bears_points_and_cameras_without_meaning():
    camera, origins, directions, points = picture()
    plane = rayleaf_rivals.ImagePlane(sheet(), "MIRROR")
    objects = rayleaf_rivals.ObjectSet([(sheet(), plane)])
    with pytest.raises(_core.InputError, match="look"):
        objects.ask(origins[:4], directions[:4], points=points[:4])
    plane.look(*camera)
    with pytest.raises(_core.InputError, match="points"):
        objects.ask(origins[:4], directions[:4])
    middle = len(points) // 2 + SIDE // 2
    odd = np.array([[np.nan, 1.0], [np.inf, 1.0], [1e30, 1.0], points[middle]])
    got = objects.ask(origins[:4], directions[[middle] * 4], points=odd)
    np.testing.assert_array_equal(got["object"], 0)
    plane.look(camera[0], (np.nan, 0, 0), (0, 0, 0), (0, 0, 0))
    assert (objects.ask(origins[:4], directions[:4], points=points[:4])["object"] == -1).all()
    for argument in ("angle_threshold", "distance_threshold"):
        with pytest.raises(_core.InputError, match=f"sheet.*{argument}"):
            rayleaf_rivals.ImagePlane(sheet(), "MIRROR", **{argument: 0.0}).look(*camera)
