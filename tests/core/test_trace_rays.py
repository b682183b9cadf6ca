"""What the tracer answers: positions at any distance, ties, visibility, bad rays, empty and degenerate shapes."""

import resource
from pathlib import Path

import numpy as np
import pytest
from core import good_arguments, shapes

trace, EVERYTHING = shapes.trace, shapes.EVERYTHING


def tracer_of(*instances):
    # A pixel this wide asks for nothing: facets are as coarse as they may be, the same wherever the eye is.
    placed = [(shape, np.asarray(matrix, float), EVERYTHING) for shape, matrix in instances]
    return trace.Tracer(placed, pixel_angle=1.0)


@pytest.mark.parametrize("offset,scale", [(1e6, 1.0), (-1e6, 1.0), (1.0, 1e-6), (0.0, 1e6)])
@pytest.mark.parametrize("name", ["cube", "nurbs_sphere", "lumpy_torus"])
def test_hits_are_the_same_at_any_distance_and_size(name, offset, scale):
    random = np.random.default_rng(21)
    shape, count = getattr(shapes, name)(), 5000
    origins = 3 * shapes.random_directions(random, count)
    directions = shapes.unit(0.8 * shapes.random_directions(random, count) - origins)
    here = tracer_of((shape, np.eye(4))).closest_hits(origins, directions)
    there = tracer_of((shape, shapes.moved(offset, scale))).closest_hits(scale * origins + offset, directions)
    same = (here["instance"] >= 0) == (there["instance"] >= 0)
    assert same.mean() > 0.999  # silhouettes move by the rounding of the origin
    both = (here["instance"] >= 0) & (there["instance"] >= 0)
    cosine = np.abs(np.sum(here["facet_normal"] * directions, axis=1))
    steep = both & (cosine > 0.1)
    difference = np.abs((there["facet_position"] - offset) / scale - here["facet_position"])[steep]
    # Far away, the rays themselves are rounded to 1e-10; facets are float in local space, about 1e-7 of the size.
    assert np.quantile(difference, 0.999) < 2e-6
    np.testing.assert_allclose(there["t"][steep] / scale, here["t"][steep], atol=2e-5)


@pytest.mark.parametrize("name", ["cube", "nurbs_sphere"])
def test_the_facet_point_lies_on_the_ray_and_t_is_its_distance(name):
    random = np.random.default_rng(22)
    origins = 100 * shapes.random_directions(random, 2000)
    directions = shapes.unit(0.5 * shapes.random_directions(random, 2000) - origins)
    hits = tracer_of((getattr(shapes, name)(), np.eye(4))).closest_hits(origins, directions)
    np.testing.assert_allclose(origins + directions * hits["t"][:, None], hits["facet_position"], atol=3e-7)


def test_of_coinciding_instances_the_first_is_hit():
    for count in (2, 9):  # without and with a tree above the instances
        tracer = tracer_of(*[(shapes.cube(), np.eye(4)) for _ in range(count)])
        random = np.random.default_rng(23)
        hits = tracer.closest_hits(np.zeros((500, 3)), shapes.random_directions(random, 500))
        assert (hits["instance"] == 0).all()


@pytest.mark.parametrize("name", ["cube", "lumpy_mesh", "nurbs_sphere", "lumpy_torus", "strands"])
def test_turned_instances_are_hit_as_each_is_alone(name):
    """Their boxes in the world are around the images of the shape's parts."""
    shape = good_arguments.strands() if name == "strands" else getattr(shapes, name)()
    random = np.random.default_rng(27)
    turned = []
    for _ in range(12):
        matrix = np.eye(4)
        matrix[:3, :3] = np.linalg.qr(random.normal(size=(3, 3)))[0] * random.uniform(0.2, 2.0, 3)
        matrix[:3, 3] = random.uniform(-4, 4, 3)
        turned.append((shape, matrix))
    count = 20_000
    towards = np.stack([matrix[:3, 3] for _, matrix in turned])[random.integers(0, len(turned), count)]
    origins = 12 * shapes.random_directions(random, count)
    directions = shapes.unit(towards + 2 * shapes.random_directions(random, count) - origins)
    together = tracer_of(*turned).closest_hits(origins, directions)
    alone = [tracer_of(one).closest_hits(origins, directions) for one in turned]
    distances = np.stack([np.where(hits["instance"] < 0, np.inf, hits["t"]) for hits in alone])
    assert np.isfinite(distances.min(axis=0)).mean() > (0.01 if name == "strands" else 0.2)
    np.testing.assert_array_equal(np.where(together["instance"] < 0, np.inf, together["t"]), distances.min(axis=0))


def test_of_coinciding_triangles_the_first_is_hit():
    twice = np.concatenate([shapes.CUBE_TRIANGLES, shapes.CUBE_TRIANGLES])
    tracer = tracer_of((trace.TriangleMesh("twice", shapes.CUBE_VERTICES, twice), np.eye(4)))
    hits = tracer.closest_hits(np.zeros((2000, 3)), shapes.random_directions(np.random.default_rng(24), 2000))
    assert hits["primitive"].max() < len(shapes.CUBE_TRIANGLES)


def test_rays_that_are_not_rays_hit_nothing():
    tracer = tracer_of((shapes.cube(), np.eye(4)), (shapes.nurbs_sphere(), np.eye(4)))
    nan, infinity = float("nan"), float("inf")
    rays = [
        ((0, 0, 0), (0, 0, 0)),
        ((nan, 0, 0), (0, 0, 1)),
        ((0, 0, 0), (0, nan, 1)),
        ((infinity, 0, 0), (-1, 0, 0)),
        ((0, 0, 0), (0, 0, infinity)),
    ]
    origins, directions = np.array([o for o, _ in rays], float), np.array([d for _, d in rays], float)
    assert (tracer.closest_hits(origins, directions)["instance"] == -1).all()
    assert not tracer.occluded(origins, directions).any()
    one = np.array([[0.0, 0.0, -5.0]]), np.array([[0.0, 0.0, 1.0]])
    for t_min, t_max in ((nan, 10.0), (0.0, nan), (5.0, 3.0)):
        assert tracer.closest_hits(*one, t_min=t_min, t_max=t_max)["instance"][0] == -1


def test_hits_lie_between_t_min_and_t_max():
    tracer = tracer_of((shapes.cube(), np.eye(4)))
    ray = np.array([[0.2, 0.3, -5.0]]), np.array([[0.0, 0.0, 1.0]])
    assert tracer.closest_hits(*ray)["t"][0] == 4.0
    assert tracer.closest_hits(*ray, t_min=4.0)["t"][0] == 4.0
    assert tracer.closest_hits(*ray, t_min=4.0 + 1e-12)["t"][0] == 6.0
    assert tracer.closest_hits(*ray, t_min=4.0 + 1e-12, t_max=6.0 - 1e-12)["instance"][0] == -1
    assert tracer.occluded(*ray, t_min=5.0, t_max=6.0)[0] and not tracer.occluded(*ray, t_min=5.0, t_max=5.9)[0]


def test_an_instance_is_seen_by_the_rays_it_is_visible_to():
    matrices = [shapes.moved(0.0), shapes.moved(0.0, 2.0), shapes.moved(0.0, 3.0), shapes.moved(0.0, 4.0)]
    tracer = trace.Tracer([(shapes.cube(), matrix, 1 << i) for i, matrix in enumerate(matrices)])
    ray = np.array([[0.0, 0.0, 0.0]]), np.array([[0.0, 0.0, 1.0]])
    for i in range(4):
        assert tracer.closest_hits(*ray, kind=1 << i)["instance"][0] == i
        assert tracer.occluded(*ray, kind=1 << i)[0]
    assert not tracer.occluded(*ray, kind=16)[0]


def test_any_hit_agrees_with_closest_hit():
    random = np.random.default_rng(25)
    shapes_used = [shapes.cube(), shapes.nurbs_torus(), shapes.lumpy_mesh(), shapes.lumpy_torus()]
    places = [shapes.moved(3.0 * i - 4.0, 1.0 + 0.3 * i) for i in range(8)]
    tracer = tracer_of(*[(shapes_used[i % 4], places[i]) for i in range(8)])
    origins = random.uniform(-20, 30, (20_000, 3))
    directions = shapes.unit(random.uniform(-5, 20, (20_000, 3)) - origins)
    closest = tracer.closest_hits(origins, directions)
    hit = closest["instance"] >= 0
    assert 0.05 < hit.mean() < 0.95
    np.testing.assert_array_equal(tracer.occluded(origins, directions), hit)
    # What is nearer than the nearest hit hides nothing.
    before = np.where(hit, closest["t"] * (1 - 1e-9), 1.0)
    assert not tracer.occluded(origins, directions, t_max=before).any()


def test_normals_of_a_mirrored_instance_stay_outside():
    for shape in (shapes.cube(), shapes.nurbs_sphere()):
        for matrix in (np.diag([-1.0, 1, 1, 1]), np.diag([-2.0, 1, 0.5, 1]), np.eye(4)):
            directions = shapes.random_directions(np.random.default_rng(26), 500)
            hits = tracer_of((shape, matrix)).closest_hits(np.zeros((500, 3)), directions)
            assert (np.sum(hits["facet_normal"] * directions, axis=1) > 0).all()
            assert (np.sum(hits["normal"] * hits["facet_normal"], axis=1) > 0).all()


def test_triangles_without_area_are_never_hit():
    vertices = np.array([[0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 1, 0]], np.float32)
    triangles = np.array([[0, 1, 2], [1, 1, 3], [0, 0, 0], [0, 1, 3]], np.int32)
    tracer = tracer_of((trace.TriangleMesh("slivers", vertices, triangles), np.eye(4)))
    random = np.random.default_rng(27)
    origins = np.column_stack([random.uniform(0, 1, (5000, 2)), np.ones(5000)])
    origins[:1000, 1] = 0.0  # along the edge that the slivers share
    hits = tracer.closest_hits(origins, np.broadcast_to([0.0, 0.0, -1.0], origins.shape))
    assert set(np.unique(hits["primitive"])) == {-1, 3}
    assert (hits["facet_normal"][hits["primitive"] == 3] == [0, 0, 1]).all()


def test_empty_scenes_and_shapes_are_hit_by_nothing():
    nothing = trace.TriangleMesh("nothing", np.zeros((0, 3), np.float32), np.zeros((0, 3), np.int32))
    ray = np.array([[0.0, 0.0, -5.0]]), np.array([[0.0, 0.0, 1.0]])
    for tracer in (
        trace.Tracer([]),
        tracer_of((nothing, np.eye(4))),
        tracer_of((trace.PatchSurface("none", []), np.eye(4))),
        tracer_of(*[(nothing, np.eye(4))] * 9),
    ):
        assert tracer.closest_hits(*ray)["instance"][0] == -1 and not tracer.occluded(*ray)[0]
    among = tracer_of(*[(nothing, np.eye(4))] * 5, (shapes.cube(), np.eye(4)))
    assert among.closest_hits(*ray)["instance"][0] == 5


def test_instances_far_apart_are_found_through_the_tree_above_them():
    random = np.random.default_rng(28)
    centers = random.uniform(-1000, 1000, (3000, 3))
    cube = shapes.cube()
    tracer = tracer_of(*[(cube, np.block([[np.eye(3), c[:, None]], [np.zeros((1, 3)), 1]])) for c in centers])
    origins = centers + 50 * shapes.random_directions(random, 3000)
    directions = shapes.unit(centers - origins)
    hits = tracer.closest_hits(origins, directions)
    assert (hits["instance"] >= 0).all()
    blocked = hits["instance"] != np.arange(3000)
    assert blocked.mean() < 0.01 and (hits["t"] < 50).all()


def resident_bytes():
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * resource.getpagesize()


@pytest.mark.slow
def test_a_million_instances_share_one_shape():
    count = 1_000_000
    matrices = np.broadcast_to(np.eye(4), (count, 4, 4)).copy()
    matrices[:, :3, 3] = np.random.default_rng(32).uniform(-1000, 1000, (count, 3))
    before = resident_bytes()
    tracer = trace.Tracer(shapes.cube(), matrices)
    # 320 bytes an instance, and Embree's tree of about 100 bytes for each box, more while it is built.
    assert resident_bytes() - before < 700 * count
    statistics = tracer.statistics()
    assert statistics["instances"] == count and statistics["shapes"] == 1 and statistics["triangles"] == 12
    chosen = np.arange(0, count, 997)
    centers = matrices[chosen, :3, 3]
    hits = tracer.closest_hits(centers + [0.0, 0.0, 1.5], np.broadcast_to([0.0, 0.0, -1.0], centers.shape))
    direct = hits["instance"] == chosen
    assert direct.mean() > 0.95  # few cubes overlap
    np.testing.assert_allclose(hits["t"][direct], 0.5, atol=1e-9)


def test_answers_do_not_depend_on_how_rays_are_dealt_to_threads():
    tracer = tracer_of((shapes.lumpy_torus(), np.eye(4)), (shapes.lumpy_mesh(), shapes.moved(0.5)))
    random = np.random.default_rng(29)
    origins = 3 * shapes.random_directions(random, 4000)
    directions = shapes.unit(shapes.random_directions(random, 4000) - origins)
    first = tracer.closest_hits(origins, directions)
    order = random.permutation(4000)
    again = tracer.closest_hits(origins[order], directions[order])
    for key, value in first.items():
        np.testing.assert_array_equal(value[order], again[key], err_msg=key)


def test_grids_are_counted_and_kept():
    tracer = tracer_of((shapes.nurbs_sphere(), np.eye(4)))
    before = tracer.statistics()
    tracer.closest_hits(np.zeros((1000, 3)), shapes.random_directions(np.random.default_rng(30), 1000))
    after = tracer.statistics()
    assert before["subpatches"] >= 8 and after["geometry_cache"]["levels"]["fine"]["diced"] > 0
    assert after["geometry_cache"]["bytes"] >= 4 * 3 * 289


def test_a_near_eye_makes_finer_facets_than_a_far_one():
    near = trace.Tracer([(shapes.nurbs_sphere(), np.eye(4), EVERYTHING)], pixel_angle=1e-4, eye=(0, 0, 1.1))
    far = trace.Tracer([(shapes.nurbs_sphere(), np.eye(4), EVERYTHING)], pixel_angle=1e-4, eye=(0, 0, 1000.0))
    assert near.statistics()["subpatches"] > far.statistics()["subpatches"]
    directions = shapes.random_directions(np.random.default_rng(31), 2000)
    hits = far.closest_hits(np.zeros((2000, 3)), directions)
    # kCoarsestCachedTolerance; local units are world's.
    assert np.abs(hits["facet_position"] - hits["position"]).max() < 1e-4


@pytest.mark.parametrize("coherent", [False, True])
def test_packets_aimed_at_edges_of_a_mesh_find_what_single_rays_find(coherent):
    """Rays from the middle of a mesh to its edges, of which two facets are equally near."""
    columns, rows, random = 48, 32, np.random.default_rng(0)
    theta, phi = np.meshgrid(np.arange(1, rows) * np.pi / rows, np.arange(columns) * 2 * np.pi / columns, indexing="ij")
    radius = 1 + 0.1 * np.sin(4 * theta) * np.cos(3 * phi)
    ring = np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], 2) * radius[..., None]
    ring = ring.astype(np.float32).astype(float)
    to_world = shapes.moved(0.5, 2.0)
    i, j = np.sort(random.integers(0, rows - 2, 20_000)), random.integers(0, columns, 20_000)
    share = random.random((20_000, 1))
    local = ring[i, j] * share + ring[i + 1, j] * (1 - share)
    middle = to_world[:3, 3]
    directions = shapes.unit(local @ to_world[:3, :3].T)
    origins = np.tile(middle, (len(directions), 1))
    tracer = shapes.trace.Tracer([(shapes.lumpy_mesh(), to_world, 31)])
    alone = tracer.closest_hits(origins, directions)
    together = shapes.trace.closest_in_packets(tracer, origins, directions, coherent)
    for name in ("t", "instance", "primitive"):
        np.testing.assert_array_equal(together[name], alone[name])
