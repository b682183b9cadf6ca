"""Displaced surfaces: where their points are, that no ray passes between them, and what is refused."""

import numpy as np
import pytest
import scenes
from core import shapes
from core import subdivision_cages as cages
from rayleaf import _core

RAYS = 5_000


def along_normal(amount):
    """A program that moves points along the normal; `amount(program)` is its register of how far."""
    program = _core.Program("displacement")
    normal = program.operation("object_normal")
    moved = program.operation("vector_math", [normal, amount(program)], text="MULTIPLY")
    return program, moved


def constant(value):
    return lambda program: program.constant(value, value, value, value)


def noise(scale, height):
    def amount(program):
        value = lambda x: program.constant(x, x, x, x)  # noqa: E731
        place = program.operation("object_coordinates")
        operands = [place, value(0), value(scale), value(1), value(0.5), value(0)]
        color = program.operation("noise", operands, ints=[3])
        level = program.operation("component", [color], ints=[3])
        middle = program.operation("math", [level, value(0.5)], ints=[0], text="SUBTRACT")
        return program.operation("math", [middle, value(height)], ints=[0], text="MULTIPLY")

    return amount


def by_texture_coordinate(height):
    """Jumps where the texture coordinate does."""

    def amount(program):
        u = program.operation("component", [program.operation("uv", ints=[-1])], ints=[0])
        return program.operation("math", [u, program.constant(*[height] * 4)], ints=[0], text="MULTIPLY")

    return amount


def displaced(shape, amount):
    program, moved = along_normal(amount)
    return _core.displaced(shape, program, object=moved)


def trace(shape, origins, directions, spread=0.0, **more):
    tracer = shapes.trace.Tracer([(shape, np.eye(4), shapes.EVERYTHING)], eye=(0.0, 0.0, 20.0), **more)
    count = len(origins)
    return tracer.closest_hits(
        origins, directions, width=np.zeros(count, np.float32), spread=np.full(count, spread, np.float32)
    )


def test_a_sphere_moved_along_its_normal_is_a_larger_sphere():
    random = np.random.default_rng(1)
    directions = shapes.random_directions(random, 3000)
    hits = trace(displaced(shapes.nurbs_sphere(), constant(0.25)), np.zeros((3000, 3)), directions)
    np.testing.assert_allclose(np.linalg.norm(hits["position"], axis=1), 1.25, atol=1e-6)
    # Slopes are differences of what is computed in single precision, a thousandth of a patch apart.
    np.testing.assert_allclose(hits["normal"], shapes.unit(hits["position"]), atol=2e-3)


def test_a_displacement_of_a_thousand_times_the_object_is_rendered():
    random = np.random.default_rng(1)
    directions = shapes.random_directions(random, 3000)
    hits = trace(displaced(shapes.nurbs_sphere(), constant(1000.0)), np.zeros((3000, 3)), directions)
    np.testing.assert_allclose(np.linalg.norm(hits["position"], axis=1), 1001, rtol=1e-5)


SHELLS = {
    "hills on a sphere": lambda: displaced(shapes.nurbs_sphere(), noise(3.0, 0.5)),
    "a sphere torn at its seam": lambda: displaced(shapes.nurbs_sphere(), by_texture_coordinate(0.3)),
    "hills on a cube's limit": lambda: displaced(cages.cube().surface(), noise(2.0, 0.4)),
    "hills on a prism of seven sides": lambda: displaced(cages.prism(7).surface(), noise(4.0, 0.3)),
    "a sharp cube blown up": lambda: displaced(
        cages.creased(cages.cube(), [e for f in cages.cube().faces for e in cages.face_edges(f)], 10.0).surface(),
        constant(0.3),
    ),
    "poles of twelve faces": lambda: displaced(cages.double_pole(12).surface(), noise(3.0, 0.2)),
}


@pytest.mark.slow
@pytest.mark.parametrize("spread", [0.0, 0.05])
@pytest.mark.parametrize("name", SHELLS)
def test_every_ray_from_inside_meets_a_displaced_shell(name, spread):
    random = np.random.default_rng(7)
    directions = shapes.random_directions(random, RAYS)
    hits = trace(SHELLS[name](), 0.05 * shapes.random_directions(random, RAYS), directions, spread)
    missed = np.flatnonzero(hits["instance"] < 0)
    assert len(missed) == 0, f"{len(missed)} missed: towards {directions[missed[:3]]!r}"


@pytest.mark.slow
def test_every_ray_from_inside_meets_a_displaced_torus():
    random = np.random.default_rng(8)
    angle = random.uniform(0, 2 * np.pi, RAYS)
    origins = 0.7 * np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    hits = trace(displaced(shapes.lumpy_torus(), noise(5.0, 0.1)), origins, shapes.random_directions(random, RAYS))
    assert (hits["instance"] >= 0).all()


@pytest.mark.slow
def test_a_ray_crosses_a_displaced_shell_an_even_number_of_times():
    shape = SHELLS["hills on a sphere"]()
    tracer = shapes.trace.Tracer([(shape, np.eye(4), shapes.EVERYTHING)], eye=(0.0, 0.0, 20.0))
    random = np.random.default_rng(9)
    directions = shapes.random_directions(random, 5000)
    origins = -4 * directions + 0.6 * shapes.random_directions(random, 5000)
    crossings, start = np.zeros(5000, int), np.zeros(5000)
    for _ in range(16):
        hits = tracer.closest_hits(origins, directions, t_min=start)
        found = hits["instance"] >= 0
        crossings += found
        start = np.where(found, hits["t"] + 1e-7, np.inf)
    # A ray along an edge may find both of its facets, or graze it.
    assert np.mean(crossings % 2) < 1e-3


@pytest.mark.slow
def test_normals_are_those_of_the_displaced_surface():
    random = np.random.default_rng(4)
    directions = shapes.random_directions(random, 3000)
    hits = trace(displaced(shapes.nurbs_sphere(), noise(2.0, 0.4)), np.zeros((3000, 3)), directions)
    cosine = np.sum(hits["normal"] * hits["facet_normal"], axis=1)
    assert np.median(cosine) > 0.9999 and cosine.min() > 0.9
    assert np.abs(hits["position"] - hits["facet_position"]).max() < 5e-3


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_a_displacement_that_is_not_finite_is_refused_by_name(value):
    def amount(program):
        huge = program.constant(3e38, 3e38, 3e38, 3e38)
        place = program.operation("object_coordinates")
        large = program.operation("vector_math", [place, huge], text="MULTIPLY")
        infinite = program.operation("vector_math", [large, huge], text="MULTIPLY")
        if np.isnan(value):
            return program.operation("vector_math", [infinite, infinite], text="SUBTRACT")
        sign = program.constant(*[np.sign(value)] * 4)
        return program.operation("vector_math", [infinite, sign], text="MULTIPLY")

    with pytest.raises(_core.InputError, match="object 'sphere': displacement is not finite"):
        displaced(shapes.nurbs_sphere(), amount)


def test_a_mesh_and_a_register_that_is_not_there_are_refused():
    program, moved = along_normal(constant(1.0))
    with pytest.raises(_core.InputError, match="object 'cube'"):
        _core.displaced(shapes.cube(), program, object=moved)
    with pytest.raises(_core.InputError, match="displacement is 99"):
        _core.displaced(shapes.nurbs_sphere(), program, object=99)
    scene = _core.SceneDescription()
    with pytest.raises(_core.InputError, match="object 'paint': displacement"):
        scene.add_material("paint", None, displacement=(program, 99, -1))


def heights(space, scale):
    """The z of a flat cage's limit that is moved up by 0.5 in one space, seen from above, its object scaled."""
    scene = _core.SceneDescription()
    program = _core.Program("displacement")
    up = program.constant(0, 0, 0.5, 1)
    displacement = (program, up, -1) if space == "object" else (program, -1, up)
    materials = scene.add_material_list([scene.add_material("m", scenes.diffuse(_core), displacement=displacement)])
    cage = cages.Cage(np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], float), [[0, 1, 2, 3]])
    shape = scene.add_shape(cage.surface(border_corners="SHARP"))
    scene.add_instance("quad", shape, scenes.matrix(scale=scale), materials)
    scenes.look_down(scene, half=0.05)
    session = _core.Session(scene, _core.Settings(width=4, height=4, samples=1, passes=["combined", "position"]))
    assert session.render()
    return session.pass_pixels("position")[..., 2]


def test_object_space_scales_with_the_object_and_world_space_does_not():
    np.testing.assert_allclose(heights("object", 2.0), 1.0, atol=1e-5)
    np.testing.assert_allclose(heights("world", 2.0), 0.5, atol=1e-5)


def infinite_between(low, high):
    """Nothing, but infinity where the first object coordinate lies between two numbers."""

    def amount(program):
        value = lambda x: program.constant(x, x, x, x)  # noqa: E731
        x = program.operation("component", [program.operation("object_coordinates")], ints=[0])
        inside = [program.operation("math", [x, value(low)], ints=[0], text="GREATER_THAN")]
        inside.append(program.operation("math", [x, value(high)], ints=[0], text="LESS_THAN"))
        band = program.operation("math", inside, ints=[0], text="MULTIPLY")
        large = program.operation("math", [band, value(3e38)], ints=[0], text="MULTIPLY")
        return program.operation("math", [large, value(3e38)], ints=[0], text="MULTIPLY")

    return amount


def test_a_point_between_vertices_that_is_not_finite_lies_on_its_facet():
    corners = np.array([[[0.0, 0, 0, 1], [1, 0, 0, 1]], [[0, 1, 0, 1], [1, 1, 0, 1]]])
    linear = (2, False, False, False)
    sheet = displaced(
        _core.trace.PatchSurface("sheet", [(corners, linear, linear, True, 0)]), infinite_between(0.3301, 0.3329)
    )
    origins = np.array([[x, 0.4, 1.0] for x in (0.3, 0.3315, 0.3325, 0.334)])
    hits = trace(sheet, origins, np.tile([0.0, 0, -1], (4, 1)))
    assert (hits["instance"] == 0).all()
    for key in ("position", "normal", "derivatives", "facet_position"):
        assert np.isfinite(hits[key]).all(), key
    np.testing.assert_allclose(hits["position"], origins * [1, 1, 0], atol=1e-6)
    np.testing.assert_allclose(np.abs(hits["normal"]), np.tile([0, 0, 1], (4, 1)), atol=1e-6)


def test_a_vertex_that_is_not_finite_is_refused_by_name():
    with pytest.raises(_core.InputError, match="'sphere': displacement is not finite"):
        trace(displaced(shapes.nurbs_sphere(), infinite_between(-9.0, 9.0)), np.zeros((1, 3)), np.eye(3)[:1])
