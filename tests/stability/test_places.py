"""Cases of glass, mirrors, needles, grazing rays and whole renders at every distance and size, with every kernel. Where a
case alone has no answer better than rounding, the bound says by how much more a far place may be off."""

import numpy as np
import pytest
import ri_tree_support as support
import scenes
from core import shapes
from path_scenes import material
from stability.measured import check_bound
from stability.patch_cases import REGULAR, PatchCase

trace = shapes.trace
SCALES = (1e-6, 1.0, 1e6)
# An object of size 1e-6 has no digits left at 1e6, and at 1e3 too few for its thin parts.
PLACES = [(offset, scale) for offset in (0.0, 1e3, 1e6) for scale in SCALES if offset < 1e9 * scale]
EVERY_PLACE = pytest.mark.parametrize("offset, scale", PLACES)
EVERY_KERNEL = pytest.mark.parametrize("kernel", trace.simd_targets())

pytestmark = pytest.mark.usefixtures("any_target")


def rounding(offset, scale):
    """Of world positions, in sizes of the object."""
    return 8 * np.spacing(offset + scale) / scale


def named(case, offset, scale, kernel):
    return f"{case}, offset {offset:g}, scale {scale:g}, {kernel}"


def tracer_of(shape, offset, scale, kernel, **view):
    assert trace.use_simd_target(kernel)
    return trace.Tracer([(shape, shapes.moved(offset, scale), shapes.EVERYTHING)], eye=(offset,) * 3, **view)


def hits_at(tracer, offset, scale, origins, directions):
    """Hits; positions in sizes of the object."""
    hits = tracer.closest_hits(origins * scale + offset, directions)
    for name in ("position", "normal", "facet_normal", "facet_position"):
        assert np.isfinite(hits[name]).all(), name
    return hits, (hits["position"] - offset) / scale


@EVERY_KERNEL
@EVERY_PLACE
def test_a_patch_whose_points_are_one_is_missed_and_makes_no_nonsense(offset, scale, kernel):
    points = np.zeros((4, 4, 4))
    points[..., 3] = 1.0
    tracer = tracer_of(PatchCase("one point", points).surface(), offset, scale, kernel)
    origins = np.array([[0, 0, 1], [1e-3, 0, 1], [0.5, 0, 1.0]])
    hits, _ = hits_at(tracer, offset, scale, origins, np.array([[0, 0, -1.0]] * 3))
    wrong = int(np.sum(hits["instance"] >= 0))
    check_bound(named("all points one", offset, scale, kernel), "rays that hit it", wrong, 0, "rays")


@EVERY_KERNEL
@EVERY_PLACE
@pytest.mark.parametrize("name, factors", [("needle", (1, 1e-6, 1e-6)), ("sheet", (1, 1e-6, 1))])
def test_needles_and_sheets_of_aspect_a_million_are_hit_wherever_they_are(name, factors, offset, scale, kernel):
    bicubic = next(case for case in REGULAR if case.name == "bicubic")
    case = PatchCase(name, bicubic.points * [*factors, 1])
    aims = case.aims()
    position = np.asarray(case.evaluate(aims[:, 0], aims[:, 1])[0], float)
    normal = np.asarray(case.normals(aims[:, 0], aims[:, 1]), float)
    tracer = tracer_of(case.surface(), offset, scale, kernel, pixel_angle=1e-8)
    hits, found = hits_at(tracer, offset, scale, position + normal * 1e-3, -normal)
    place = named(f"{name} of aspect 1e6", offset, scale, kernel)
    check_bound(place, "rays lost", int(np.sum(hits["instance"] < 0)), 0, "rays")
    off = np.linalg.norm(found - position, axis=1).max()
    check_bound(place, "position", off, 4e-6 + rounding(offset, scale), "sizes")  # chords: see test_patches


@EVERY_KERNEL
@EVERY_PLACE
@pytest.mark.parametrize("angle", [1e-3, 1e-5, 1e-7])
def test_grazing_rays_meet_a_flat_patch_wherever_it_is(angle, offset, scale, kernel):
    flat = PatchCase("flat", np.array([[[-1, -1, 0, 1], [1, -1, 0, 1]], [[-1, 1, 0, 1], [1, 1, 0, 1.0]]]))
    tracer = tracer_of(flat.surface(), offset, scale, kernel)
    target = np.random.default_rng(5).uniform(-0.5, 0.5, (300, 3)) * [1, 1, 0]
    directions = np.broadcast_to([np.cos(angle), 0.0, -np.sin(angle)], target.shape)
    hits, found = hits_at(tracer, offset, scale, target - 0.4 * directions, directions)
    place = named(f"grazing by {angle:g}", offset, scale, kernel)
    check_bound(place, "rays lost", int(np.sum(hits["instance"] < 0)), 0, "rays")
    off = np.linalg.norm(found - target, axis=1).max()
    check_bound(place, "position", off, 2.0**-23 + (1e-15 + rounding(offset, scale)) / angle, "sizes")


@EVERY_KERNEL
@EVERY_PLACE
def test_rays_along_edges_and_within_faces_hit_the_body_or_miss_it(offset, scale, kernel):
    """Along an edge either is right; a hit must lie on the body, and what runs through the middle must hit."""
    lumps, cube = shapes.lumpy_torus(), shapes.cube()
    origins = np.array([[-3, 1, 1], [-3, 0.2, 1], [-3, -1, 0.5], [-3, -3, 1], [-2, 1, 1], [-3, 0, 0]], float)
    directions = shapes.unit(np.array([[1, 0, 0], [1, 0, 0], [1, 0, 0], [1, 1, 0], [1, 0, 0], [1, 0, 0]], float))
    hits, found = hits_at(tracer_of(cube, offset, scale, kernel), offset, scale, origins, directions)
    on = hits["instance"] >= 0
    off = np.abs(np.abs(found[on]).max(axis=1) - 1).max()
    place = named("along edges of a cube", offset, scale, kernel)
    check_bound(place, "rays lost", int(not on[-1]), 0, "rays")
    check_bound(place, "position", off, 1e-6 + rounding(offset, scale), "sizes")
    # Along the border of two patches: the seam of a torus at y = 0.
    seam = np.column_stack([np.linspace(0.42, 0.98, 50), np.zeros(50), np.full(50, 2.0)])
    hits, _ = hits_at(tracer_of(lumps, offset, scale, kernel), offset, scale, seam, np.tile([0, 0, -1.0], (50, 1)))
    check_bound(named("along a seam", offset, scale, kernel), "rays lost", int(np.sum(hits["instance"] < 0)), 0, "rays")


@EVERY_KERNEL
@EVERY_PLACE
def test_a_corner_cube_sends_rays_back_wherever_it_is(offset, scale, kernel):
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], np.float32)
    faces = np.array([[0, 1, 2], [0, 2, 3], [0, 3, 1]], np.int32)
    tracer = tracer_of(trace.TriangleMesh("corner", corners, faces), offset, scale, kernel)
    random = np.random.default_rng(4)
    into = -shapes.unit(random.uniform(0.5, 1.5, (1000, 3)))
    origins = (np.column_stack([random.uniform(0.02, 0.2, (1000, 2)), np.zeros(1000)]) - 2 * into) * scale + offset
    directions, bounced = into.copy(), np.zeros(1000, int)
    for _ in range(4):
        hits = tracer.closest_hits(origins, directions)
        on = (hits["instance"] >= 0)[:, None]
        turned = support.reflected(directions, hits["facet_normal"].astype(float))
        origins = np.where(on, shapes.leaving(hits, turned), origins)
        directions = np.where(on, turned, directions)
        bounced += on[:, 0]
    back = bounced == 3
    assert back.sum() > 250 and bounced.max() <= 3
    place = named("corner cube", offset, scale, kernel)
    check_bound(place, "exit direction", np.abs(directions[back] + into[back]).max(), 1e-6, "rad")


@EVERY_KERNEL
@EVERY_PLACE
@pytest.mark.parametrize("ior", [1 - 1e-6, 1.0, 1 + 1e-6, 1.5, 10.0])
def test_a_ball_lens_bends_rays_as_snell_says_wherever_it_is(ior, offset, scale, kernel):
    pixel_angle = 1e-5
    tracer = tracer_of(shapes.nurbs_sphere(), offset, scale, kernel, pixel_angle=pixel_angle)
    random = np.random.default_rng(7)
    origins = np.column_stack([random.uniform(-0.6, 0.6, (200, 2)), np.full(200, 3.0)])
    directions = np.tile([0.0, 0.0, -1.0], (200, 1))
    position, direction = support.through_glass_ball(origins, directions, ior)
    started, lost = origins * scale + offset, 0
    for eta, side in ((1 / ior, 1.0), (ior, -1.0)):
        hits = tracer.closest_hits(started, directions)
        lost += int(np.sum(hits["instance"] < 0))
        directions = support.snell(directions, side * hits["normal"].astype(float), eta)
        started = shapes.leaving(hits, directions)
    place = named(f"ball lens traced on, index {ior:g}", offset, scale, kernel)
    check_bound(place, "rays lost", lost, 0, "rays")
    # Facets within a tenth of a pixel of an eye in the middle, over the cosine of incidence (0.5 at least), and floats'
    # rounding of normals; the index enlarges both.
    allowed = (40 * 0.1 * pixel_angle + 2e-6 + 8 * rounding(offset, scale)) * max(1.0, ior)
    check_bound(place, "exit direction", support.angles(directions, direction).max(), allowed, "rad")
    off = np.linalg.norm((hits["position"] - offset) / scale - position, axis=1).max()
    check_bound(place, "exit position", off, allowed, "sizes")


@EVERY_KERNEL
@EVERY_PLACE
def test_a_stack_of_plates_keeps_directions_wherever_it_is(offset, scale, kernel):
    """Sixteen plates of glass as instances, crossed at 45 degrees: 32 refractions."""
    thickness, gap, ior, plates = 0.01, 0.02, 1.5, 16
    assert trace.use_simd_target(kernel)
    matrices = [shapes.moved(offset, scale) for _ in range(plates)]
    for number, matrix in enumerate(matrices):
        matrix[2, 3] -= number * (thickness + gap) * scale
    plate = support.cuboid((1, 1, thickness / 2))
    tracer = trace.Tracer([(plate, matrix, shapes.EVERYTHING) for matrix in matrices], eye=(offset,) * 3)
    along = np.sqrt(0.5)
    began = np.array([[-0.6, 0.1, thickness / 2]])
    directions = np.array([[along, 0.0, -along]])
    origins = (began - 0.01 * directions) * scale + offset
    met = 0
    for hit in range(2 * plates):
        hits = tracer.closest_hits(origins, directions)
        met += int(hits["instance"][0] >= 0)
        side, eta = (1.0, 1 / ior) if hit % 2 == 0 else (-1.0, ior)
        directions = support.snell(directions, side * hits["facet_normal"].astype(float), eta)
        origins = shapes.leaving(hits, directions)
    place = named("stack of 16 plates traced on", offset, scale, kernel)
    check_bound(place, "walls missed", 2 * plates - met, 0, "walls")
    check_bound(place, "exit direction", np.abs(directions - [along, 0, -along]).max(), 1e-7 * plates, "rad")
    shift = plates * thickness * np.tan(np.arcsin(along / ior)) + (plates - 1) * gap
    off = abs((hits["facet_position"][0, 0] - offset) / scale - began[0, 0] - shift)
    check_bound(place, "shift", off, 1e-6 * plates + 2 * plates * rounding(offset, scale), "sizes")


@EVERY_KERNEL
@EVERY_PLACE
@pytest.mark.parametrize("excess", [1e-3, 1e-5, 2e-7])
def test_total_reflection_sets_in_at_the_critical_angle_wherever_it_is(excess, offset, scale, kernel):
    """Straight down through a prism's level face to its tilted one, this much flatter and steeper than the angle."""
    ior, wrong, worst = 1.5, 0, 0.0
    critical = np.arcsin(1 / ior)
    for sign in (-1, 1):
        prism, actual = support.wedge(critical + sign * excess)
        tracer = tracer_of(prism, offset, scale, kernel)
        directions = np.array([[0.0, 0.0, -1.0]])
        above, _ = hits_at(tracer, offset, scale, np.array([[0.2, 0.1, 1.0]]), directions)
        below = tracer.closest_hits(shapes.leaving(above, directions), directions)
        assert above["instance"][0] >= 0 and below["instance"][0] >= 0
        normal = below["facet_normal"][0].astype(float)
        found = np.arctan2(np.hypot(normal[0], normal[1]), abs(normal[2]))
        worst = max(worst, abs(found - actual))
        wrong += int((found > critical) != (sign > 0))
    place = named(f"total reflection, {excess:g} from the critical angle", offset, scale, kernel)
    check_bound(place, "angle of incidence", worst, 1e-7, "rad")  # normals are floats
    check_bound(place, "rays that take the wrong way", wrong, 0, "rays")


@EVERY_KERNEL
@EVERY_PLACE
def test_a_chain_of_64_hits_in_a_pipe_keeps_its_direction_wherever_it_is(offset, scale, kernel):
    """Mirrors all round, so that each hit adds what it is off."""
    hits_wanted, half = 64, (0.05, 0.07, 8.0)
    tracer = tracer_of(support.cuboid(half), offset, scale, kernel)
    directions = shapes.unit(np.array([[0.8, 0.3, 0.5], [0.5, 0.7, 0.3], [0.9, 0.1, 0.2], [0.3, 0.9, 0.4]]))
    origins, began = np.full((4, 3), offset), directions
    held = np.float32(half).astype(float)
    length = np.zeros(4)
    for _ in range(hits_wanted):
        found = tracer.closest_hits(origins, directions)
        assert (found["instance"] >= 0).all(), "a ray left the closed pipe"
        length += np.linalg.norm(found["facet_position"] - origins, axis=1) / scale
        directions = shapes.unit(support.reflected(directions, found["facet_normal"].astype(float)))
        origins = shapes.leaving(found, directions)
    # Unfolded the way is straight: where it would be is folded back into the box.
    unfolded = (began * length[:, None] + held) / (2 * held)
    folded = np.abs((unfolded + 1) % 2 - 1) * 2 * held - held
    place = named("pipe of mirrors, 64 hits", offset, scale, kernel)
    turned = np.abs(np.abs(directions) - np.abs(began)).max()
    check_bound(place, "direction", turned, 1e-7 * hits_wanted, "rad")
    off = np.abs((found["facet_position"] - offset) / scale - folded).max()
    # Every start is rounded, and a step beside its wall, of some 2^-21 of the pipe.
    check_bound(place, "position", off, hits_wanted * (1e-6 * max(half) + 2 * rounding(offset, scale)), "sizes")


# --- whole renders ----------------------------------------------------------------------------------------------------


def glass(core, scene, ior):
    return material(core, scene, ("glass", 1.0, 1.0, 0.0, ior, "GGX"))


def hollow_ball(core, scene, place, thickness):
    """Of dense glass: nothing of it shows in an even world."""
    ball, dense = scene.add_surface("ball", [scenes.sphere_spline(core)]), glass(core, scene, 1.5)
    inside = place(1 - thickness)
    inside[:3, 0] *= -1
    scene.add_instance("outside", ball, place(1.0), dense)
    scene.add_instance("inside", ball, inside, dense)


def nested_balls(core, scene, place, gap):
    ball, clear = scene.add_surface("ball", [scenes.sphere_spline(core)]), glass(core, scene, 1.0)
    for size in (1.0, 1.0 - gap):
        scene.add_instance(f"ball {size}", ball, place(size), clear)


def touching_cubes(core, scene, place, gap):
    cube, clear = scene.add_mesh("cube", scenes.CUBE_VERTICES, scenes.CUBE_TRIANGLES), glass(core, scene, 1.0)
    for side in (-1, 1):
        scene.add_instance(f"cube {side}", cube, place(0.4, height=side * (0.4 + gap / 2)), clear)


def seen_from_inside(core, scene, place, _):
    ball = scene.add_surface("ball", [scenes.sphere_spline(core)])
    scene.add_instance("ball", ball, place(20.0), glass(core, scene, 1.5))


INVISIBLE = {
    "glass shell, 1e-6 thick": (hollow_ball, 1e-6),
    "nested shells, 1e-6 apart": (nested_balls, 1e-6),
    "cubes of glass that touch": (touching_cubes, 0.0),
    "camera inside glass": (seen_from_inside, None),
}


@EVERY_KERNEL
@EVERY_PLACE
@pytest.mark.parametrize("name", INVISIBLE)
def test_clear_bodies_stay_invisible_wherever_they_are(core, name, offset, scale, kernel):
    assert trace.use_simd_target(kernel)
    build, thickness = INVISIBLE[name]

    def place(size, height=0.0):
        return scenes.matrix((offset, offset, offset + height * scale), size * scale)

    scene = core.SceneDescription()
    build(core, scene, place, thickness)
    scene.set_world(scenes.background(core, (1, 1, 1)))
    view = (-0.3, -0.3), (0.3, 0.3), 1e-6 * scale, 1000.0 * scale
    scene.set_camera("PERSPECTIVE", scenes.matrix((offset, offset, offset + 5 * scale)), *view)
    deep = dict(max_bounces=64, transmission_bounces=64, glossy_bounces=64, roulette_start=64, clamp_indirect=0.0)
    light = scenes.render(core, scene, width=6, height=6, samples=8, **deep)["combined"][..., :3]
    assert np.isfinite(light).all() and (light >= 0).all()
    case = named(name, offset, scale, kernel)
    check_bound(case, "light above the world's", max(light.max() - 1, 0.0), 1e-4, "of the world's")
    # One path in some thousands crosses the wall too many times at the rim; of 288, none or one.
    check_bound(case, "light lost", 1 - light.mean(), 4e-3, "of the world's")


@EVERY_KERNEL
@EVERY_PLACE
def test_a_wall_at_a_millionth_is_seen_and_lit_by_a_tiny_lamp_wherever_it_is(core, offset, scale, kernel):
    """Clipping at 1e-6 of the size, a lamp of radius 1e-9 and 10^9 W a size away."""
    assert trace.use_simd_target(kernel)
    scene = core.SceneDescription()
    grey = material(core, scene, ("diffuse", 1.0, 0.5))
    wall = scenes.quad(scene, "wall", 1.0)
    scene.add_instance("wall", wall, scenes.matrix((offset,) * 3, scale), grey)
    lamp, power = scenes.matrix((offset, offset, offset + scale)), 1e9
    scene.add_lamp("lamp", "POINT", lamp, (power,) * 3, radius=1e-9 * scale)
    view = (-0.1, -0.1), (0.1, 0.1), 1e-6 * scale, 10.0 * scale
    scene.set_camera("PERSPECTIVE", scenes.matrix((offset, offset, offset + 2e-6 * scale)), *view)
    settings = dict(width=6, height=6, samples=4, passes=["combined", "depth"], clamp_direct=0.0)
    found = scenes.render(core, scene, **settings)
    case = named("wall 2e-6 away under a lamp of 1e-9", offset, scale, kernel)
    off = np.abs(found["depth"] / (2e-6 * scale) - 1).max()
    check_bound(case, "depth", off, 1e-5 + rounding(offset, scale) / 2e-6, "of the value")
    expected = 0.5 / np.pi * power / (4 * np.pi) / scale**2
    check_bound(case, "radiance", np.abs(found["combined"][..., :3] / expected - 1).max(), 1e-3, "of the value")
