"""OpenVDB files: what they hold is found, what is wrong with them is said."""

import numpy as np
import pyopenvdb
import pytest
from core.vdb_files import make_grid, write


def ball(x, y, z):
    return np.clip(1.0 - np.sqrt(x * x + y * y + z * z), 0.0, None)


def test_a_file_holds_what_was_written(core, tmp_path):
    """Numbers and vectors, each in the middle of its voxel, as Cycles has it."""
    path = write(
        tmp_path / "cloud.vdb",
        make_grid("density", lambda x, y, z: 2.0 + x + y * z, 24),
        make_grid("flow", lambda x, y, z: np.stack([x, -y, 0.5 * z], -1), 24),
    )
    grids = core.read_vdb("cloud", path, ["density", "flow", "heat"])
    assert sorted(grids) == ["density", "flow"]
    points = np.random.default_rng(3).uniform(-0.95, 0.95, (500, 3))
    x, y, z = points.T
    np.testing.assert_allclose(grids["density"].values(points)[:, 0], 2.0 + x + y * z, rtol=1e-5)
    np.testing.assert_allclose(grids["flow"].values(points)[:, :3], np.stack([x, -y, 0.5 * z], -1), atol=1e-6)


def test_tiles_are_what_their_voxels_would_be(core, tmp_path):
    """A number that fills most of a box is written as cubes of many voxels."""

    def blocky(x, y, z):
        return np.where((x > -0.5) & (y < 0.25), 3.0, 0.0)

    path = write(tmp_path / "tiles.vdb", make_grid("density", blocky, 256))
    tiles = core.read_vdb("cloud", path, ["density"])["density"]
    at = (np.arange(256) + 0.5) / 128.0 - 1.0
    z, y, x = np.meshgrid(at, at, at, indexing="ij")
    to_object = np.diag([1 / 128, 1 / 128, 1 / 128, 1.0])
    to_object[:3, 3] = 1 / 256 - 1
    whole = core.VoxelGrid("cloud", "density", blocky(x, y, z).astype(np.float32)[..., None], to_object)
    points = np.random.default_rng(4).uniform(-1.1, 1.1, (5000, 3))
    np.testing.assert_allclose(tiles.values(points), whole.values(points), atol=1e-5)
    assert tiles.bytes < 2e6 < 20e6 < whole.bytes


def test_a_billion_voxels_of_one_value_take_no_memory(core, tmp_path):
    grid = pyopenvdb.FloatGrid()
    grid.name = "density"
    grid.fill((0, 0, 0), (1535, 1535, 1535), 0.25)
    grid.fill((100000, 0, 0), (100001, 1, 1), 1.0)
    read = core.read_vdb("cloud", write(tmp_path / "vast.vdb", grid), ["density"])["density"]
    assert read.bytes < 20e6
    at = np.array([[700.0, 800.0, 900.0], [100001.0, 1.0, 1.0], [50000.0, 3.0, 3.0]])
    np.testing.assert_allclose(read.values(at)[:, 0], [0.25, 1.0, 0.0], atol=1e-6)


def test_backgrounds_and_other_numbers_are_read(core, tmp_path):
    mask = pyopenvdb.BoolGrid()
    mask.name = "mask"
    mask.fill((0, 0, 0), (3, 3, 3), True)
    level = pyopenvdb.createLevelSetSphere(10.0)
    level.name = "surface"
    grids = core.read_vdb("cloud", write(tmp_path / "kinds.vdb", mask, level), ["mask", "surface"])
    np.testing.assert_array_equal(grids["mask"].values(np.array([[2.0, 2.0, 2.0], [9, 9, 9]]))[:, 0], [1.0, 0.0])
    np.testing.assert_allclose(
        grids["surface"].values(np.array([[0.5, 0.5, 0.5], [500, 0, 0], [10.5, 0.5, 0.5]]))[:, 0], [-3, 3, 0], atol=1e-5
    )


def test_numbers_that_are_none_are_counted(core, tmp_path):
    bad = make_grid("density", ball, 16)
    for place in ((8, 8, 8), (3, 9, 10)):
        bad.getAccessor().setValueOn(place, float("nan"))
    grid = core.read_vdb("cloud", write(tmp_path / "bad.vdb", bad), ["density"])["density"]
    assert grid.bad_numbers == 2
    assert np.isfinite(grid.values(np.random.default_rng(5).uniform(-1, 1, (500, 3)))).all()


def test_files_that_cannot_be_read_are_named(core, tmp_path):
    with pytest.raises(core.InputError, match="'cloud'.*nowhere.vdb"):
        core.read_vdb("cloud", str(tmp_path / "nowhere.vdb"), ["density"])
    path = tmp_path / "noise.vdb"
    path.write_bytes(np.random.default_rng(6).bytes(5000))
    with pytest.raises(core.InputError, match="'cloud'.*noise.vdb"):
        core.read_vdb("cloud", str(path), ["density"])
    whole = tmp_path / "whole.vdb"
    write(whole, make_grid("density", ball, 64))
    for share in (0.02, 0.3, 0.9):
        path.write_bytes(whole.read_bytes()[: int(whole.stat().st_size * share)])
        with pytest.raises(core.InputError, match="'cloud'.*noise.vdb"):
            core.read_vdb("cloud", str(path), ["density"])


def test_grids_without_voxels_are_refused_by_name(core, tmp_path):
    empty = pyopenvdb.FloatGrid()
    empty.name = "density"
    grids = core.read_vdb("cloud", write(tmp_path / "empty.vdb", empty), ["density"])
    with pytest.raises(core.InputError, match="'cloud'.*'density'.*empty"):
        core.volume("cloud", {0: grids["density"]})
