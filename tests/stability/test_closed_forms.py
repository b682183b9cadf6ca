"""Glass, mirrors and stacks whose exit rays are known in closed form: ball lens, plates, corner cube, total reflection."""

import numpy as np
import pytest
import ri_tree_support as support
import swept_support
from core import shapes
from stability.measured import check_bound

trace = shapes.trace
FACETS = 2.0**-20  # distance of facets to the surface, in sizes


def ball(ior):
    return support.tree_of(shapes.nurbs_sphere(), "GLASS", ior=ior, facet_tolerance=FACETS)


def rays_at_height(height, count, seed=3):
    """Parallel rays along -z that pass the centre of a unit ball at a distance."""
    around = np.random.default_rng(seed).uniform(0, 2 * np.pi, count)
    origins = np.column_stack([height * np.cos(around), height * np.sin(around), np.full(count, 3.0)])
    return origins, np.broadcast_to([0.0, 0.0, -1.0], origins.shape).copy()


@pytest.mark.parametrize("height", [0.0, 0.1, 0.5, 0.9, 0.99])
@pytest.mark.parametrize("ior", [1 - 1e-6, 1 + 1e-6, 1.5, 10.0])
def test_a_ball_lens_bends_rays_as_snell_says(ior, height):
    origins, directions = rays_at_height(height, 200)
    answers = ball(ior).trace(origins, directions)
    position, direction = support.through_glass_ball(origins, directions, ior)
    place = f"ball lens, index {ior:g}, height {height:g}"
    check_bound(place, "rays lost", int(np.sum(~answers["hit"])), 0, "rays")
    # Normals are exact at a hit whose place is off by a facet's distance over the cosine of incidence.
    cosine = np.sqrt(1 - height**2)
    allowed = 40 * FACETS / cosine * max(1.0, ior)
    check_bound(place, "exit direction", support.angles(answers["exit_direction"], direction).max(), allowed, "rad")
    off = np.linalg.norm(answers["exit_position"] - position, axis=1).max()
    check_bound(place, "exit position", off, allowed, "sizes")


def test_glass_of_index_one_bends_nothing():
    origins, directions = support.scattered_rays(500)
    answers = ball(1.0).trace(origins, directions)
    hit = answers["hit"]
    turned = support.angles(answers["exit_direction"][hit], directions[hit]).max()
    check_bound("ball of index 1", "exit direction", turned, 1e-7, "rad")


@pytest.mark.parametrize("excess", [1e-3, 1e-5, 1e-7])
def test_total_reflection_sets_in_at_the_critical_angle(excess):
    """A prism's slanted face met from inside at the critical angle, this much below and above it."""
    ior = 1.5
    critical = np.arcsin(1 / ior)
    for sign, reflects in ((-1, False), (1, True)):
        angle = critical + sign * excess
        # A wedge: enter the horizontal face straight down, meet a face tilted by `angle`.
        prism, actual = support.wedge(angle)
        tree = support.tree_of(prism, "GLASS", ior=ior)
        answers = tree.trace(np.array([[0.2, 0.1, 1.0]]), np.array([[0.0, 0.0, -1.0]]))
        assert answers["hit"][0]
        wanted = bool(actual > critical)
        assert wanted == reflects or abs(actual - critical) < 1e-7, "the prism is not the one meant"
        assert (answers["total_reflections"][0] > 0) == wanted, f"{actual - critical:g} rad beyond the critical angle"


@pytest.mark.parametrize("plates", [1, 4, 16])
def test_a_stack_of_plates_shifts_rays_and_keeps_their_direction(plates):
    """Thin plates of glass over each other as one shape, crossed at 45 degrees by rays that are traced on and on."""
    thickness, gap, ior = 0.01, 0.02, 1.5
    plate = support.cuboid((1, 1, thickness / 2))
    tree = support.tree_of(plate, "GLASS", ior=ior)
    angle = np.pi / 4
    directions = np.array([[np.sin(angle), 0.0, -np.cos(angle)]])
    position = np.array([[-0.6, 0.1, 0.0]])
    travelled = 0.0
    for number in range(plates):
        top = -number * (thickness + gap)
        origins = position.copy()
        origins[:, 2] -= top - thickness / 2  # into the plate's own space, just above it
        answers = tree.trace(origins - 0.001 * directions, directions)
        assert answers["hit"][0]
        directions = answers["exit_direction"]
        position = answers["exit_position"].copy()
        position[:, 2] += top - thickness / 2
        position += directions * (gap / -directions[0, 2])
        travelled += thickness * np.tan(np.arcsin(np.sin(angle) / ior)) + gap * np.tan(angle)
    place = f"stack of {plates} plates"
    check_bound(place, "direction", np.abs(directions - [np.sin(angle), 0, -np.cos(angle)]).max(), 1e-7 * plates, "rad")
    check_bound(place, "shift", abs(position[0, 0] + 0.6 - travelled), 1e-6 * plates, "sizes")


def test_a_corner_cube_sends_rays_back_where_they_came_from():
    """Three mirrors at right angles: three bounces turn a direction round, from any side."""
    corner = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], np.float32)
    faces = np.array([[0, 1, 2], [0, 2, 3], [0, 3, 1]], np.int32)
    tracer = trace.Tracer([(trace.TriangleMesh("corner", corner, faces), np.eye(4), shapes.EVERYTHING)])
    random = np.random.default_rng(4)
    targets = np.zeros((4000, 3))
    targets[:, :2] = random.uniform(0.02, 0.2, (4000, 2))
    into = -shapes.unit(random.uniform(0.5, 1.5, (4000, 3)))
    origins, directions = targets - 2 * into, into.copy()
    bounced = np.zeros(4000, int)
    for _ in range(4):
        hits = tracer.closest_hits(origins, directions)
        on = hits["instance"] >= 0
        normals = hits["facet_normal"].astype(float)
        turned = support.reflected(directions, normals)
        directions = np.where(on[:, None], turned, directions)
        origins = np.where(on[:, None], shapes.leaving(hits, turned), origins)
        bounced += on
    back = bounced == 3
    assert back.sum() > 1000, "too few rays met all three mirrors"
    assert bounced.max() <= 3
    check_bound("corner cube", "direction", np.abs(directions[back] + into[back]).max(), 1e-6, "rad")


CHAINS = [2, 4, 8, 16, 32, 64]
STEEP = 0.9  # angle of rays to a pipe's or a rod's axis, outside
INDEX = 1.5


@pytest.mark.parametrize("hits", CHAINS)
def test_total_reflections_between_plane_walls_keep_the_direction(hits):
    """A light pipe of such a length that the last hit from inside is at its end; each adds its rounding only."""
    half_length = (hits - 0.5) * 0.1 / (2 * np.tan(np.arcsin(np.sin(STEEP) / INDEX)))
    tree = support.tree_of(support.cuboid((0.05, 0.05, half_length)), "GLASS", ior=INDEX)
    directions = np.array([[np.sin(STEEP), 0.0, -np.cos(STEEP)]])
    origins = np.array([[-0.02, 0.01, half_length]]) - 0.01 * directions
    answers = tree.trace(origins, directions)
    assert answers["hit"][0] and answers["interior_hits"][0] == hits
    turned = np.abs(np.abs(answers["exit_direction"]) - np.abs(directions)).max()
    check_bound(f"light pipe, {hits} interior hits", "exit direction", turned, 1e-7 * hits, "rad")


def through_rod(origin, radius, half_length, hits):
    """Where a ray leaves the far end of a round glass rod along z that it entered at the near end, and whither, after
    hits - 1 total reflections; extended precision."""
    long = np.longdouble
    across = np.array([np.sin(long(STEEP)), long(0)]) / long(INDEX)
    fall = np.sqrt(1 - np.sum(across**2))  # of z, per unit of way inside
    place, left = origin.astype(long), 2 * long(half_length) / fall
    for _ in range(hits - 1):
        along, squared = np.sum(place * across), np.sum(across**2)
        way = (-along + np.sqrt(along**2 - squared * (np.sum(place**2) - long(radius) ** 2))) / squared
        place, left = place + way * across, left - way
        normal = place / np.sqrt(np.sum(place**2))
        across = across - 2 * np.sum(across * normal) * normal
    outside = across * long(INDEX)
    return place + left * across, np.array([*outside, -np.sqrt(1 - np.sum(outside**2))])


@pytest.mark.parametrize("hits", CHAINS)
def test_the_error_of_a_chain_of_total_reflections_in_a_round_rod_is_measured(hits):
    """Skew rays in a cylinder: each reflection turns them by the same angle, so an error of it adds up."""
    radius, start = float(np.float32(0.1)), np.array([-0.02, 0.05])
    # The first wall is nearer than the others, which are a chord apart.
    chord = 2 * np.sqrt(radius**2 - start[1] ** 2) / np.tan(np.arcsin(np.sin(STEEP) / INDEX))
    half_length = (hits - 1) * chord / 2
    rod = swept_support.surface("POLY", [[0, 0, -half_length], [0, 0, half_length]], bevel_depth=radius, fill_caps=True)
    directions = np.array([[np.sin(STEEP), 0.0, -np.cos(STEEP)]])
    origins = np.array([[*start, half_length]]) - 0.01 * directions
    answers = support.tree_of(rod, "GLASS", ior=INDEX).trace(origins, directions)
    assert answers["hit"][0] and answers["interior_hits"][0] == hits
    place, towards = through_rod(start, radius, half_length, hits)
    off = np.linalg.norm(answers["exit_position"][0, :2] - place.astype(float))
    turned = np.linalg.norm(answers["exit_direction"][0] - towards.astype(float))
    # Facets of the wall lie within 2^-20 of the rod's half length, so longer rods are coarser. Over the radius, that
    # turns a hit's normal, and by twice as much the ray; the errors of angles add up along the chain.
    bound = FACETS * max(half_length, radius) / radius * hits**2
    check_bound(f"glass rod, {hits} interior hits", "exit direction", turned, bound, "rad")
    check_bound(f"glass rod, {hits} interior hits", "exit position", off / radius, bound, "radii")


@pytest.mark.parametrize("hits", CHAINS)
def test_the_growth_of_errors_in_a_ball_of_total_reflections_is_measured(hits):
    """Nearly tangent rays in a curved mirror pipe: an angle's error is carried on once a hit, so it grows by the number of
    hits and no faster. A torus of glass seen along its ring gives such chains; here a sphere's great circle, in mirrors.
    """
    tracer = trace.Tracer([(shapes.nurbs_sphere(), np.eye(4), shapes.EVERYTHING)], pixel_angle=1e-6)
    random = np.random.default_rng(6)
    origins = 0.9 * shapes.random_directions(random, 200)
    directions = shapes.unit(np.cross(origins, shapes.random_directions(random, 200)))
    exact_origin, exact_direction = origins.astype(np.longdouble), directions.astype(np.longdouble)
    for _ in range(hits):
        found = tracer.closest_hits(origins, directions)
        assert (found["instance"] >= 0).all(), "a ray left the closed ball"
        directions = support.reflected(directions, found["normal"].astype(float))
        directions = shapes.unit(directions)
        origins = shapes.leaving(found, directions)
        b = np.sum(exact_origin * exact_direction, axis=1)
        t = -b + np.sqrt(b * b - np.sum(exact_origin**2, axis=1) + 1)
        exact_origin = exact_origin + t[:, None] * exact_direction
        normal = exact_origin / np.sqrt(np.sum(exact_origin**2, axis=1))[:, None]
        exact_direction = exact_direction - 2 * np.sum(exact_direction * normal, axis=1)[:, None] * normal
    # Normals are floats: 1e-7 each; the place of a hit is off by the facet's distance over the cosine, and turns the
    # normal by as much, twice in a reflection. Chords of a circle keep their angle: the error adds up along the circle.
    turned = np.sqrt(np.sum((directions - exact_direction) ** 2, axis=1)).astype(float)
    check_bound(f"mirror ball, {hits} hits", "direction", turned.max(), 1e-5 * hits**2, "rad")
