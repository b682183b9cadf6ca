"""Instances that the tree above them holds in parts: rays meet what they would meet otherwise."""

import numpy as np
import pytest
import scenes
import swept_support as swept
from core import shapes
from rayleaf import _core

trace = _core.trace


def tangle(random, bevel_depth=0.02):
    """A long thin curve, whose parts fill little of its box."""
    points = random.uniform(-1, 1, (6, 3))
    away = 0.4 * random.normal(size=points.shape)
    handles = np.stack([points - away, points + away], axis=1)
    return swept.curve("BEZIER", points, handles, bevel_depth=bevel_depth)


def traced(instances):
    resident = trace.GeometryCacheSettings(resident_megabytes=1e3)
    return trace.Tracer([(shape, matrix, shapes.EVERYTHING) for shape, matrix in instances], cache=resident)


def turned(random):
    matrix = np.eye(4)
    matrix[:3, :3] = np.linalg.qr(random.normal(size=(3, 3)))[0] * random.uniform(0.5, 1.5, 3)
    matrix[:3, 3] = random.uniform(-0.5, 0.5, 3)
    return matrix


def tangled(random, count=8):
    return [(trace.SweptSurface(tangle(random)), turned(random)) for _ in range(count)]


def some_rays(random, count=20_000):
    origins = 4 * shapes.random_directions(random, count)
    return origins, shapes.unit(1.5 * shapes.random_directions(random, count) - origins)


def test_rays_meet_opened_instances_as_each_alone():
    random = np.random.default_rng(61)
    instances = tangled(random)
    together = traced(instances)
    assert together.statistics()["opened_instances"] > len(instances) // 2
    origins, directions = some_rays(random)
    alone = [traced([instance]).closest_hits(origins, directions) for instance in instances]
    distances = np.stack([np.where(hits["instance"] < 0, np.inf, hits["t"]) for hits in alone])
    nearest = distances.min(axis=0)
    met = np.isfinite(nearest)
    assert 0.1 < met.mean() < 0.9
    one_by_one = together.closest_hits(origins, directions)
    in_packets = trace.closest_in_packets(together, origins, directions)
    for hits in (one_by_one, in_packets):
        np.testing.assert_array_equal(np.where(hits["instance"] < 0, np.inf, hits["t"]), nearest)
        np.testing.assert_array_equal(hits["instance"][met], distances.argmin(axis=0)[met])
        found = np.stack([hits["primitive"] for hits in alone])[hits["instance"][met], np.flatnonzero(met)]
        np.testing.assert_array_equal(hits["primitive"][met], found)
    np.testing.assert_array_equal(together.occluded(origins, directions), met)
    np.testing.assert_array_equal(trace.occluded_in_packets(together, origins, directions), met)


def test_of_coinciding_opened_instances_the_first_is_hit():
    random = np.random.default_rng(62)
    (shape, matrix), *_ = tangled(random, 1)
    tracer = traced([(shape, matrix)] * 6)
    assert tracer.statistics()["opened_instances"] == 6
    origins, directions = some_rays(random, 4000)
    for hits in (tracer.closest_hits(origins, directions), trace.closest_in_packets(tracer, origins, directions)):
        assert set(hits["instance"]) == {-1, 0}


def ribbon_points():
    """A narrow band that winds up, and is symmetric: its local space has the object's axes and centre."""
    t = np.linspace(-1, 1, 40)
    middle = np.stack([np.sin(6 * t), t, 0.3 * np.sin(9 * t)], axis=1)
    sides = [middle + [0.02 * side, 0, 0] for side in (-1, 0, 1, 2)]
    points = np.concatenate([np.stack(sides), np.ones((4, len(t), 1))], axis=2)
    return points


def test_a_ray_at_an_edge_meets_the_facet_of_an_opened_instance_that_it_meets_in_the_whole():
    """Facets that meet there are as far, on whichever parts they are: the lower one counts."""
    band = trace.PatchSurface("band", [(ribbon_points(), (4, False, False, False), (4, False, True, False), True, 0)])
    center, scale = band.frame
    corners = np.concatenate([trace.diced_patch(band, i).reshape(-1, 3) for i in range(band.element_count)])
    origins = corners.astype(float) * scale + np.asarray(center) + [0, 0, 4]
    directions = np.broadcast_to([0.0, 0.0, -1.0], origins.shape).copy()
    alone = traced([(band, np.eye(4))])
    opened = traced([(band, np.eye(4))] + [(band, shapes.moved(50.0 * (i + 1), 1.0)) for i in range(4)])
    assert opened.statistics()["opened_instances"] == 5
    expected = alone.closest_hits(origins, directions)
    assert (expected["instance"] >= 0).all()
    np.testing.assert_array_equal(opened.closest_hits(origins, directions)["anchors"], expected["anchors"])
    expected = trace.closest_in_packets(alone, origins, directions)
    found = trace.closest_in_packets(opened, origins, directions)
    for name in ("t", "primitive", "position"):
        np.testing.assert_array_equal(found[name], expected[name])


def test_what_fills_its_box_is_held_whole():
    balls = [(shapes.nurbs_sphere(), shapes.moved(3.0 * i, 1.0)) for i in range(8)]
    assert traced(balls).statistics()["opened_instances"] == 0


PLACES = 6


def scene_of(model, parts=None):
    scene = _core.SceneDescription(parts)
    red = scene.add_material_list([scene.add_material("red", scenes.diffuse(_core, "red", (0.8, 0.3, 0.2)))])
    for i, (seed, place) in enumerate(model):
        curve = scene.add_curve(tangle(np.random.default_rng(seed)))
        scene.add_instance(f"curve {i}", curve, scenes.matrix(place), red)
    scene.add_lamp("lamp", "POINT", scenes.matrix((2, -3, 6)), [300.0] * 3, radius=0.3)
    scene.set_world(scenes.background(_core, (0.3, 0.3, 0.4)))
    scenes.look_down(scene, 6.0, 0.6)
    return scene


def rendered(scene, **more):
    session = _core.Session(scene, _core.Settings(width=24, height=16, samples=2, **more))
    assert session.render()
    return session.pass_pixels("combined"), session.statistics()["geometry"]["opened_instances"]


@pytest.mark.parametrize("change", ["place", "shape", "shape of one part"])
def test_an_edited_opened_instance_shows_what_a_scene_made_anew_shows(change):
    model = [(seed, (0.2 * seed, 0.0, 0.0)) for seed in range(PLACES)]
    scene = scene_of(model, _core.SceneParts())
    _, opened = rendered(scene)
    assert opened == PLACES
    for step in range(1, 4):
        scene = scene.copy()
        seed, (x, y, z) = model[2]
        if change == "place":
            model[2] = (seed, (x, y + 0.3, z + 0.1 * step))
            scene.place_instances(np.int32([2]), scenes.matrix(model[2][1])[None])
            expected = scene_of(model)
        elif change == "shape":
            model[2] = (70 + step, (x, y, z))
            scene.replace_shape(2, scene_of(model).shape(2))
            expected = scene_of(model)
        else:
            other = _core.SceneDescription()
            other.add_surface("ball", [scenes.sphere_spline(_core, radius=0.3 * step)])
            scene.replace_shape(2, other.shape(0))
            expected = scene_of(model)
            expected.replace_shape(2, other.shape(0))
        np.testing.assert_array_equal(rendered(scene)[0], rendered(expected)[0])


def test_instances_with_ray_caches_are_held_whole_and_others_in_parts():
    """A cache is told of every ray that meets the box, wherever the parts are."""
    scene = scene_of([(seed, (0.2 * seed, 0.0, 0.0)) for seed in range(PLACES)])
    band = scene.add_surface("band", [_core.NurbsSpline(ribbon_points(), 4, 4)])
    for i in range(2):
        scene.add_instance(f"band {i}", band, scenes.matrix((0.3 * i, 0.1, 1.0)), 0)
    interpolated = {"ray_interpolation": _core.RayInterpolation("ON", 0.01)}
    assert rendered(scene)[1] == PLACES + 2
    picture, opened = rendered(scene, threads=2, **interpolated)
    assert opened == PLACES
    np.testing.assert_array_equal(rendered(scene, threads=1, **interpolated)[0], picture)
    assert rendered(scene)[1] == PLACES + 2
