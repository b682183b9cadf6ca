"""Facets that stay in memory: as near to the surface as the view asks, closed, and the same by single rays and packets."""

import numpy as np
import pytest
import shapes
import subdivision_cages as cages
import swept_support

NO_FACET = 2**32 - 1
RESIDENT = 1e3  # megabytes: more than any of these takes


def tube():
    points = np.array([[-0.8, 0, 0], [-0.2, 0.4, 0.3], [0.4, -0.4, -0.2], [0.8, 0.1, 0.4]])
    return swept_support.surface("NURBS", points, order=4, endpoint=True, bevel_depth=0.1, fill_caps=True)


SHAPES = {
    "sphere": shapes.nurbs_sphere,
    "torus of bicubic patches": shapes.lumpy_torus,
    "bevelled curve": tube,
    "subdivided torus": lambda: cages.torus().surface(),
    "body with poles of 64 faces": lambda: cages.double_pole(64).surface(),
    "mesh": shapes.lumpy_mesh,
}


def tracer(*made, resident=RESIDENT, **view):
    memory = shapes.trace.GeometryCacheSettings(megabytes=300.0, resident_megabytes=resident)
    instances = [(shape, matrix, shapes.EVERYTHING) for shape, matrix in made]
    return shapes.trace.Tracer(instances, cache=memory, **view)


def rays(random, count, reach=4.0):
    origins = reach * shapes.random_directions(random, count)
    return origins, shapes.unit(random.uniform(-1, 1, (count, 3)) - origins)


@pytest.mark.slow
@pytest.mark.parametrize("name", SHAPES)
def test_rays_that_cross_a_resident_shell_leave_it_as_often_as_they_enter(name):
    shell = tracer((SHAPES[name](), np.eye(4)))
    origins, directions = rays(np.random.default_rng(3), 20_000)
    width = np.full(len(origins), 1e-3, np.float32)
    found = shapes.trace.cracks(shell, origins, directions, width, width, inside=False)
    assert not found.any(), f"rays {np.flatnonzero(found)[:5]} of seed 3 leak"


@pytest.mark.parametrize("pixel_angle", [1e-2, 1e-3, 1e-4])
def test_neighbours_of_different_resolution_close_their_border(pixel_angle):
    """The eye is near one side of the torus, so that facets there are many times smaller."""
    shell = tracer((shapes.lumpy_torus(), np.eye(4)), eye=(1.3, 0.0, 0.0), pixel_angle=pixel_angle)
    origins, directions = rays(np.random.default_rng(4), 50_000)
    width = np.full(len(origins), 1e-3, np.float32)
    found = shapes.trace.cracks(shell, origins, directions, width, width, inside=False)
    assert not found.any(), f"rays {np.flatnonzero(found)[:5]} of seed 4 leak"


def edge_targets(name, shell, random):
    """Points on the facets' corners and edges, and points inside the shell from which they are seen."""
    if name == "mesh":
        points = shell.closest_hits(np.zeros((500, 3)), shapes.random_directions(random, 500))["facet_position"]
        return points, np.zeros_like(points)
    shape = SHAPES[name]()
    grids = [shapes.trace.diced_patch(shape, i).astype(float) for i in range(min(shape.element_count, 24))]
    corners = np.concatenate([grid.reshape(-1, 3) for grid in grids])
    edges = np.concatenate([(0.5 * (grid[1:] + grid[:-1])).reshape(-1, 3) for grid in grids])
    points = np.concatenate([corners, edges])
    middle = np.zeros_like(points)
    if name.startswith("torus"):
        middle[:, :2] = 0.7 * shapes.unit(points[:, :2])
    return points, middle


@pytest.mark.parametrize("packets", [False, True])
@pytest.mark.parametrize("name", ["sphere", "torus of bicubic patches", "mesh"])
def test_rays_at_the_shared_edges_and_corners_of_resident_facets_hit(name, packets):
    shell = tracer((SHAPES[name](), np.eye(4)))
    points, middle = edge_targets(name, shell, np.random.default_rng(14))
    towards = shapes.unit(points - middle)
    if packets:
        assert (shapes.trace.closest_in_packets(shell, middle, towards)["instance"] >= 0).all()
        assert shapes.trace.occluded_in_packets(shell, middle, towards).all()
    else:
        assert (shell.closest_hits(middle, towards)["instance"] >= 0).all()
        assert shell.occluded(middle, towards).all()


@pytest.mark.parametrize("name", [name for name in SHAPES if name != "mesh"])
def test_the_facet_that_a_ray_starts_on_is_not_asked_and_would_not_be_hit(name):
    random = np.random.default_rng(21)
    shell = tracer((SHAPES[name](), np.eye(4)))
    origins, directions = rays(random, 4000)
    hits = shell.closest_hits(origins, directions)
    on = hits["instance"] >= 0
    hits = {key: each[on] for key, each in hits.items()}
    starts = hits["anchors"]
    assert (starts[:, 3] != NO_FACET).all()
    forgotten = starts.copy()
    forgotten[:, 3] = NO_FACET
    directions = shapes.random_directions(random, len(starts))
    leaving = shapes.leaving(hits, directions)
    expected = shell.closest_hits(leaving, directions, starts=forgotten)
    for found in (
        shell.closest_hits(leaving, directions, starts=starts),
        shapes.trace.closest_in_packets(shell, leaving, directions, starts=starts),
    ):
        for part in ("t", "instance", "primitive"):
            np.testing.assert_array_equal(found[part], expected[part], err_msg=part)
    inwards = -hits["facet_normal"].astype(np.float64)
    before = hits["facet_position"] - 0.01 * inwards
    met = shell.closest_hits(before, inwards, starts=forgotten)["t"]
    alone = shell.closest_hits(before, inwards, starts=starts)["t"]
    together = shapes.trace.closest_in_packets(shell, before, inwards, starts=starts)["t"]
    np.testing.assert_array_equal(alone, together)
    assert (met < 0.011).all() and (alone > 0.011).mean() > 0.95  # few meet a neighbour as near as that


@pytest.mark.parametrize("coherent", [False, True])
@pytest.mark.parametrize("count", [1, 3, 40])
@pytest.mark.parametrize("resident", [0.0, 7.0, RESIDENT])
def test_packets_find_the_very_hits_of_single_rays(coherent, count, resident):
    """One instance, as many as are asked one by one, and a tree of them; all cached, some resident, all."""
    random = np.random.default_rng(count)
    made = [make() for make in SHAPES.values()]
    placed = []
    for i in range(count):
        matrix = np.eye(4)
        matrix[:3, :3] *= random.uniform(0.2, 1.0)
        matrix[:3, 3] = random.uniform(-2, 2, 3) * (0.0, 0.3, 1.0)[[1, 3, 40].index(count)]
        placed.append((made[i % len(made)], matrix))
    scene = tracer(*placed, resident=resident)
    origins, directions = rays(random, 5003)
    origins[:1000] = origins[0]  # a thousand that start at one point, as a camera's do
    directions[:1000] = shapes.unit(-origins[0] + random.uniform(-1, 1, (1000, 3)))
    alone = scene.closest_hits(origins, directions)
    together = shapes.trace.closest_in_packets(scene, origins, directions, coherent)
    for part in ("t", "instance", "primitive"):
        np.testing.assert_array_equal(together[part], alone[part], err_msg=part)
    on = alone["instance"] >= 0
    assert 500 < on.sum() < 5000
    np.testing.assert_array_equal(together["position"][on], alone["position"][on])
    for reach in (1.0, np.inf):
        np.testing.assert_array_equal(
            shapes.trace.occluded_in_packets(scene, origins, directions, np.array(reach), coherent),
            scene.occluded(origins, directions, t_max=reach),
        )


@pytest.mark.parametrize("place", [1.0, 1e6])
def test_packets_find_the_same_on_all_instruction_sets(place, any_target):
    """Facets met at their edges, short rays and such that start on facets: where single precision cannot be sure."""
    random = np.random.default_rng(21)
    matrix = np.eye(4)
    matrix[:3, 3] = place
    results = []
    for target in shapes.trace.simd_targets():
        assert shapes.trace.use_simd_target(target)
        shell = tracer((shapes.lumpy_torus(), matrix), (tube(), matrix), eye=(place, place, place + 3.0))
        if not results:
            points, middle = edge_targets("torus of bicubic patches", shell, random)
            outer = middle + 2.0 * shapes.random_directions(random, len(middle))
            on = shell.closest_hits(outer + place, shapes.unit(points - outer))
            hit = np.flatnonzero(on["instance"] >= 0)
            starts = np.concatenate([outer + place, on["facet_position"][hit]])
            towards = np.concatenate([shapes.unit(points - outer), shapes.random_directions(random, len(hit))])
        found = shapes.trace.closest_in_packets(shell, starts, towards)
        reach = np.where(np.isfinite(found["t"]), found["t"], 1.0)
        shadows = [shapes.trace.occluded_in_packets(shell, starts, towards, reach * part) for part in (0.5, 1.0, 2.0)]
        results.append({**found, **dict(enumerate(shadows))})
    alone = shell.closest_hits(starts, towards)
    for part in ("t", "instance", "primitive"):
        np.testing.assert_array_equal(results[0][part], alone[part], err_msg=part)
    for part, reach_of in enumerate((0.5, 1.0, 2.0)):
        np.testing.assert_array_equal(results[0][part], shell.occluded(starts, towards, t_max=reach * reach_of))
    for other in results[1:]:
        for key, value in results[0].items():
            np.testing.assert_array_equal(value, other[key], err_msg=str(key))


def test_what_does_not_fit_the_memory_goes_through_the_cache():
    """The torus takes more than the sphere."""
    both = [(shapes.nurbs_sphere(), np.eye(4)), (shapes.lumpy_torus(), np.eye(4))]
    lookups = {}
    for resident in (0.0, 7.0, RESIDENT):
        scene = tracer(*both, resident=resident)
        scene.closest_hits(*rays(np.random.default_rng(8), 2000))
        lookups[resident] = sum(level["lookups"] for level in scene.statistics()["geometry_cache"]["levels"].values())
    assert lookups[0.0] > lookups[7.0] > lookups[RESIDENT] == 0


@pytest.mark.parametrize("pixel_angle", [1e-2, 1e-3])
def test_resident_facets_lie_as_near_to_the_surface_as_the_view_asks(pixel_angle):
    """A tenth of a pixel, seen from where the eye is nearest to any part."""
    eye = np.array([0.0, 0.0, 3.0])
    shell = tracer((shapes.nurbs_sphere(), np.eye(4)), eye=tuple(eye), pixel_angle=pixel_angle)
    hits = shell.closest_hits(*rays(np.random.default_rng(9), 20_000))
    on = hits["instance"] >= 0
    facets = hits["facet_position"][on]
    distance = 1.0 - np.linalg.norm(facets, axis=1)
    away = np.linalg.norm(facets - eye, axis=1)
    assert (distance <= 0.1 * pixel_angle * away).all()
    assert distance.max() > 1e-4 * pixel_angle, "facets many times finer than asked"
