"""Grids of voxels: lookups, what programs read of them, light through them, and input that nobody wants."""

import numpy as np
import pyopenvdb
import pytest
from path_scenes import picture, render
from scenes import background, look_down, matrix
from vdb_files import write

WHITE = (1.0, 1.0, 1.0)
DENSITY, COLOR, HEAT = 0, 1, 2


def placed(scale=(1.0, 1.0, 1.0), origin=(0.0, 0.0, 0.0)):
    """From voxels to object space."""
    result = np.diag([*scale, 1.0])
    result[:3, 3] = origin
    return result


def grid_of(core, function, size=20, name="density", least=0.0):
    """A grid over the cube from -1 to 1 whose voxels hold a function of their places, (…, channels) or (…)."""
    at = (np.arange(size) + 0.5) / size * 2.0 - 1.0
    z, y, x = np.meshgrid(at, at, at, indexing="ij")
    values = np.asarray(function(x, y, z), np.float32)
    values = values[..., None] if values.ndim == 3 else values
    return core.VoxelGrid("volume", name, values, placed((2.0 / size,) * 3, (1.0 / size - 1.0,) * 3), least)


def density_program(core, *closures):
    """Absorption or scattering by the grid called density."""
    program = core.Program("medium")
    one = program.constant(1, 1, 1, 1)
    density = program.operation("component", [program.operation("grid_value", [one], [DENSITY])], [0])
    for identifier, *arguments in closures:
        operands = [program.constant(*((a,) * 3 if np.isscalar(a) else a), 1) for a in arguments]
        program.operation(identifier, [one, operands[0], density, *operands[1:]])
    return program


ABSORPTION = ("volume_absorption", (0.5, 0.0, 1.0))


def volume_scene(core, program, grids, unit="WORLD", place=(0, 0, 0), scale=1.0, world=WHITE):
    """A volume before a world."""
    scene = core.SceneDescription()
    shape = scene.add_shape(core.volume("volume", grids, unit))
    materials = scene.add_material_list([scene.add_material("volume", None, medium=program)])
    scene.add_instance("volume", shape, matrix(place, scale), materials)
    scene.set_world(background(core, world), 0)
    look_down(scene, half=0.05)
    return scene


def test_lookups_are_trilinear(core):
    """Which is exact for products of coordinates."""

    def function(x, y, z):
        return 3.0 + x - 2.0 * y + 0.5 * z * x + x * y * z

    grid = grid_of(core, function)
    points = np.random.default_rng(1).uniform(-0.94, 0.94, (2000, 3))
    np.testing.assert_allclose(grid.values(points)[:, 0], function(*points.T), rtol=2e-6)
    np.testing.assert_array_equal(grid.values(points)[:, 3], 1.0)


def test_beyond_its_voxels_a_grid_fades_to_nothing(core):
    grid = core.VoxelGrid("volume", "density", np.ones((1, 1, 1, 1), np.float32), placed())
    points = np.array([[0, 0, 0], [0.25, 0, 0], [0.25, 0.5, 0], [1, 0, 0], [1e30, 0, 0], [np.nan, 0, 0]])
    np.testing.assert_allclose(grid.values(points)[:, 0], [1.0, 0.75, 0.375, 0.0, 0.0, 0.0])
    assert grid.bounds() == ([-8.5] * 3, [7.5] * 3)  # whole blocks, and those beside the voxel


def test_vectors_and_colors_have_their_channels(core):
    points = np.array([[0.1, 0.2, 0.3]])
    vectors = grid_of(core, lambda x, y, z: np.stack([x, y, z], -1))
    np.testing.assert_allclose(vectors.values(points), [[0.1, 0.2, 0.3, 1.0]], atol=1e-6)
    colors = grid_of(core, lambda x, y, z: np.stack([0.2 * (2 + x), 0.4 * (2 + x), 0 * x, 2 + x], -1))
    np.testing.assert_allclose(colors.values(points), [[0.2, 0.4, 0.0, 2.1]], rtol=1e-6)


@pytest.mark.parametrize("integrator", ["PATH", "DISTRIBUTION"])
def test_a_grid_absorbs_by_its_integral(core, integrator):
    """Seen straight down; the density falls from the middle to the sides like a tent."""
    grid = grid_of(core, lambda x, y, z: 2.0 * (1.0 - np.abs(z)), size=40)
    scene = volume_scene(core, density_program(core, ABSORPTION), {DENSITY: grid})
    image = picture(core, scene, samples=4000, size=2, integrator=integrator)
    np.testing.assert_allclose(image.mean((0, 1)), np.exp([-1.0, -2.0, 0.0]), rtol=0.02)


@pytest.mark.parametrize("unit, scale, depth", [("WORLD", 1.0, 1.0), ("WORLD", 3.0, 3.0), ("OBJECT", 3.0, 1.0)])
def test_density_is_per_unit_of_the_world_or_of_the_object(core, unit, scale, depth):
    grid = grid_of(core, lambda x, y, z: 0.5 + 0.0 * x)
    scene = volume_scene(core, density_program(core, ABSORPTION), {DENSITY: grid}, unit, (0, 0, -5.0), scale)
    image = picture(core, scene, samples=3000, size=2)
    np.testing.assert_allclose(image.mean((0, 1)), np.exp([-0.5 * depth, -depth, 0.0]), rtol=0.03)


@pytest.mark.slow
def test_what_is_fine_and_dense_is_not_overlooked(core):
    """A layer of one voxel in 200, and a bound that holds for it."""

    def function(x, y, z):
        return np.where((np.abs(x) < 0.8) & (np.abs(z - 0.302) < 0.005), 200.0, 0.0)

    grid = grid_of(core, function, size=200)
    scene = volume_scene(core, density_program(core, ABSORPTION), {DENSITY: grid})
    image = picture(core, scene, samples=2000, size=2)
    np.testing.assert_allclose(image.mean((0, 1)), np.exp([-1.0, -2.0, 0.0]), rtol=0.03)


def test_fire_shines_where_there_is_no_smoke(core):
    grid = grid_of(core, lambda x, y, z: 0.5 * (np.abs(z) < 0.5))
    program = core.Program("fire")
    one = program.constant(1, 1, 1, 1)
    held = program.operation("attribute", ints=[DENSITY])
    program.operation("emission", [one, held, one])
    image = picture(core, volume_scene(core, program, {DENSITY: grid}, world=(0, 0, 0)), samples=2000, size=2)
    np.testing.assert_allclose(image.mean((0, 1)), 0.5, rtol=0.03)


def test_a_medium_of_grids_ends_where_they_end(core):
    """Whatever its program does: the blocks that hold voxels, from -1 to 0.6."""
    grid = core.VoxelGrid(
        "volume", "density", np.ones((7, 7, 7, 1), np.float32), placed((0.2,) * 3, (-0.9, -0.9, -0.8))
    )
    assert grid.bounds()[0][2] == pytest.approx(-2.5) and grid.bounds()[1][2] == pytest.approx(0.7)
    program = core.Program("mist")
    one = program.constant(1, 1, 1, 1)
    unused = program.operation("component", [program.operation("grid_value", [one], [DENSITY])], [1])
    amount = program.operation("math", [unused, program.constant(0, 0, 0, 0)], [0], text="MULTIPLY")
    amount = program.operation("math", [amount, one], [0], text="ADD")
    program.operation("volume_absorption", [one, program.constant(0.5, 0.5, 0.5, 1), amount])
    image = picture(core, volume_scene(core, program, {DENSITY: grid}), samples=2000, size=2)
    np.testing.assert_allclose(image.mean((0, 1)), np.exp(-0.5 * 3.2), rtol=0.03)


def smoke(core):
    """A ball of smoke with colours and heat, lit by a lamp."""

    def ball(x, y, z):
        return np.clip(1.5 - 2.0 * np.sqrt(x * x + y * y + z * z), 0.0, 1.0)

    def colors(x, y, z):
        return np.stack([0.5 + 0.5 * x, 0.5 + 0.0 * x, 0.5 + 0.5 * y], -1)

    program = core.Program("smoke")
    one, zero, grey = (program.constant(*[v] * 4) for v in (1.0, 0.0, 0.8))
    density = program.operation(
        "math", [program.operation("attribute", ints=[DENSITY]), program.constant(*[4.0] * 4)], [0], text="MULTIPLY"
    )
    color = program.operation("grid_value", [one], [COLOR])
    heat = program.operation("grid_value", [zero], [HEAT])
    program.operation("volume_principled", [one, color, density, zero, zero, heat, grey, zero, one, zero])
    grids = {
        DENSITY: grid_of(core, ball),
        COLOR: grid_of(core, colors),
        HEAT: grid_of(core, lambda x, y, z: 0.2 * (z > 0)),
    }
    scene = volume_scene(core, program, grids, world=(0.3, 0.4, 0.5))
    scene.add_lamp("lamp", "POINT", matrix((2, 1, 3)), (300.0, 280.0, 250.0), radius=0.2)
    look_down(scene, half=0.5)
    return scene


def test_the_bits_of_smoke_do_not_depend_on_streams_and_threads(core):
    scene = smoke(core)
    settings = dict(size=12, samples=5, volume_bounces=3)
    alone = render(core, scene, stream_paths=0, **settings).pass_pixels("combined")
    assert np.isfinite(alone).all() and alone[..., :3].std() > 0.01
    for paths, threads in ((1, 1), (17, 2), (512, 3)):
        other = render(core, scene, stream_paths=paths, threads=threads, **settings).pass_pixels("combined")
        np.testing.assert_array_equal(other, alone)


@pytest.mark.slow
def test_both_integrators_agree_on_smoke(core):
    scene = smoke(core)
    settings = dict(size=2, samples=3000, volume_bounces=2, max_bounces=4)
    images = [picture(core, scene, integrator=name, **settings).mean((0, 1)) for name in ("PATH", "DISTRIBUTION")]
    np.testing.assert_allclose(images[0], images[1], rtol=0.03)


def test_numbers_that_are_none_are_counted_and_taken_as_zero(core):
    values = np.ones((4, 4, 4, 1), np.float32)
    values[1, 2, 3], values[0, 0, 0] = np.nan, np.inf
    grid = core.VoxelGrid("volume", "density", values, placed())
    assert grid.bad_numbers == 2
    np.testing.assert_array_equal(grid.values(np.array([[3.0, 2.0, 1.0], [0, 0, 0], [1, 1, 1]]))[:, 0], [0.0, 0.0, 1.0])


def test_empty_grids_are_refused_by_name(core):
    grid = core.VoxelGrid("cloud", "smoke", np.zeros((4, 4, 4, 1), np.float32), placed())
    with pytest.raises(core.InputError, match="'cloud'.*smoke.*active voxel"):
        core.volume("cloud", {DENSITY: grid})
    with pytest.raises(core.InputError, match="'cloud'"):
        core.volume("cloud", {})


@pytest.mark.parametrize("channels", [0, 2, 5])
def test_grids_of_other_channels_are_refused(core, channels):
    with pytest.raises(core.InputError, match="density.*channels"):
        core.VoxelGrid("volume", "density", np.zeros((2, 2, 2, channels), np.float32), placed())


@pytest.mark.parametrize("bad", [0.0, np.nan, 1e-320])
def test_grids_without_a_place_are_refused(core, bad):
    with pytest.raises(core.InputError, match="density"):
        core.VoxelGrid("volume", "density", np.ones((2, 2, 2, 1), np.float32), placed((bad, 1.0, 1.0)))


def test_smoke_beyond_many_cells_scatters_the_sun(core):
    """A grid has up to 64 cells a side, and two that overlap have twice as many borders along a ray."""

    def far_smoke(has_another):
        scene = core.SceneDescription()
        for name, shift, density in (("smoke", 0.0, 3.0), ("nothing", np.array([0.017, 0.011, 0.007]), 0.0)):
            if name == "nothing" and not has_another:
                continue
            values = np.zeros((64, 64, 64, 1), np.float32)
            values[58:63, 58:63, 58:63] = density
            values[0, 0, 0] = values[63, 63, 63] = 1e-6
            to_object = np.diag([2 / 64, 2 / 64, 2 / 64, 1.0])
            to_object[:3, 3] = shift - 1 + 1 / 64
            attribute = scene.attribute(name)
            grid = core.VoxelGrid(name, "density", values, to_object, least=0.0)
            program = core.Program(name)
            white, albedo = program.constant(1, 1, 1, 1), program.constant(0.8, 0.8, 0.8, 1)
            read = program.operation("attribute", [], [attribute])
            program.operation("volume_scatter", [white, albedo, read, program.constant(0, 0, 0, 0)])
            filled = scene.add_material_list([scene.add_material(name, None, medium=program)])
            scene.add_instance(name, scene.add_shape(core.volume(name, {attribute: grid})), np.eye(4), filled)
        sun = np.eye(4)
        sun[:3, 2] = np.array([1, 0.2, 0.5]) / np.linalg.norm([1, 0.2, 0.5])
        scene.add_lamp("sun", "SUN", sun, strength=(3,) * 3)
        back = -np.ones(3) / np.sqrt(3)
        right = np.cross((0, 0, 1.0), back) / np.linalg.norm(np.cross((0, 0, 1.0), back))
        camera = np.eye(4)
        camera[:3, :4] = np.stack([right, np.cross(back, right), back, np.full(3, -3.0)], axis=1)
        scene.set_camera("PERSPECTIVE", camera, (-0.03, -0.03), (0.03, 0.03), 0.01, 100)
        return picture(core, scene, samples=256, max_bounces=1).mean()

    alone = far_smoke(False)
    assert alone > 0.005
    assert far_smoke(True) == pytest.approx(alone, rel=0.05)


def corner_file(core, tmp_path, **reading):
    """A number in a few voxels, two units apart."""
    grid = pyopenvdb.FloatGrid()
    grid.name = "density"
    grid.fill((2, 3, 4), (5, 7, 6), 2.0)
    grid.fill((20, 3, 4), (20, 3, 4), 0.5)
    path = write(tmp_path / "corner.vdb", grid)
    return core.read_vdb("cloud", path, ["density"], **reading)["density"]


def test_values_stand_in_the_middle_of_voxels_or_in_their_corners(core, tmp_path):
    points = np.random.default_rng(8).uniform(1.0, 9.0, (300, 3))
    middle, corner = (corner_file(core, tmp_path, value_place=place) for place in ("MIDDLE", "CORNER"))
    np.testing.assert_allclose(middle.values(points + 0.5), corner.values(points), atol=1e-6)
    np.testing.assert_array_equal(corner.values([[2.0, 3.0, 4.0], [1.0, 3.0, 4.0]])[:, 0], [2.0, 0.0])


def test_stochastic_mixing_finds_values_around_of_which_it_is_the_mean(core, tmp_path):
    mean, chosen = (corner_file(core, tmp_path, mixing=mixing) for mixing in ("TRILINEAR", "STOCHASTIC"))
    points = np.random.default_rng(9).uniform((1.9, 4, 5), (2.1, 4.001, 5.001), (20000, 3))
    found = chosen.values(points)[:, 0]
    assert set(found) == {0.0, 2.0}
    assert found.mean() == pytest.approx(mean.values(points)[:, 0].mean(), abs=5 * found.std() / len(found) ** 0.5)


@pytest.mark.parametrize("body", ["BOX", pytest.param("NARROW_BOX", marks=pytest.mark.slow)])
@pytest.mark.parametrize(
    ("place", "least", "low", "high"),
    [
        pytest.param("MIDDLE", 0.0, (1, 2, 3), (22, 9, 8), marks=pytest.mark.slow),
        ("CORNER", 0.0, (1, 2, 3), (22, 9, 8)),
        ("CORNER", 1.0, (1, 2, 3), (7, 9, 8)),
    ],
)
def test_a_volume_may_fill_the_box_of_all_active_voxels(core, tmp_path, place, least, low, high, body):
    """It shines where rays cross it, however little is in it: one voxel further than what is active, or behind it no
    further."""
    high = tuple(each - (body == "NARROW_BOX") for each in high)
    grid = corner_file(core, tmp_path, value_place=place, least=least)
    program = core.Program("glow")
    one = program.constant(1, 1, 1, 1)
    read = program.operation("component", [program.operation("grid_value", [one], [DENSITY])], [0])
    program.operation("volume_absorption", [one, one, read])  # of white: nothing is absorbed
    program.operation("emission", [one, one, one])
    scene = core.SceneDescription()
    shape = scene.add_shape(core.volume("volume", {DENSITY: grid}, "WORLD", body))
    materials = scene.add_material_list([scene.add_material("volume", None, medium=program)])
    scene.add_instance("volume", shape, np.eye(4), materials)
    across = high[0] - low[0]
    for x, seen in (
        (low[0] - 0.3, 0),
        (low[0] + 0.3, 1),
        (low[0] + 0.5 * across, 1),
        (high[0] - 0.3, 1),
        (high[0] + 0.3, 0),
    ):
        scene.set_camera("PERSPECTIVE", matrix((x, 5.0, 40.0)), (-1e-6, -1e-6), (1e-6, 1e-6), 0.01, 1000.0)
        got = picture(core, scene, samples=16).mean((0, 1))
        np.testing.assert_allclose(got[:3], seen * (high[2] - low[2]), rtol=0.02)  # noise
