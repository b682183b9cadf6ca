"""Frames on a Slurm cluster, whole, in tiles and in ranges of samples: all there, and the same bits as rendered here."""

import os
import re
import struct
import subprocess
import time

import plain_exr
import pytest

MAKE_SCENE = """
import sys
import bpy
scene = bpy.context.scene
scene.render.engine = "RAYLEAF"
scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 40, 30, 100
scene.render.image_settings.file_format = "OPEN_EXR_MULTILAYER"
scene.render.image_settings.exr_codec = "NONE"
scene.rayleaf.samples = 7
layer = scene.view_layers[0]
layer.use_pass_z = layer.use_pass_diffuse_direct = layer.use_pass_object_index = layer.rayleaf.use_pass_mask = True
cube = bpy.data.objects["Cube"]
cube.pass_index = 3
cube.keyframe_insert("location", frame=1)
cube.location.x = 2
cube.keyframe_insert("location", frame=8)
bpy.ops.wm.save_as_mainfile(filepath=sys.argv[1])
"""


def call(root, *arguments, **environment):
    """`rayleaf` with arguments, as from a shell that has none of the test's settings."""
    inherited = {key: value for key, value in os.environ.items() if not key.startswith(("RAYLEAF_", "PYTEST_"))}
    return subprocess.Popen(
        [str(root / "rayleaf"), *map(str, arguments)],
        env={**inherited, **environment},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )


def finished(process, code=0):
    """What it printed."""
    log, _ = process.communicate(timeout=300)
    assert process.returncode == code, log
    return log


def png_pixels(path):
    """The compressed pixels of a PNG, without its texts, which tell the date."""
    data, at, pixels = path.read_bytes(), 8, b""
    while at < len(data):
        (length,) = struct.unpack_from(">I", data, at)
        if data[at + 4 : at + 8] == b"IDAT":
            pixels += data[at + 8 : at + 8 + length]
        at += length + 12
    return pixels


def assert_same_pictures(one, other):
    first, second = (plain_exr.read(path.with_name(f"{path.name}.exr")) for path in (one, other))
    assert len(first) == 10 and first.keys() == second.keys()
    for channel in first:
        assert (first[channel] == second[channel]).all(), (one, channel)
    assert png_pixels(one.with_name(f"{one.name}.png")) == png_pixels(other.with_name(f"{other.name}.png"))


@pytest.fixture
def scene(run_blender, tmp_path):
    run_blender(MAKE_SCENE, tmp_path / "scene.blend")
    return tmp_path / "scene.blend"


@pytest.mark.slow
def test_frames_come_whole_in_tiles_and_in_sample_ranges_though_a_worker_is_killed(root, cluster, scene, tmp_path):
    environment = {"SLURM_CONF": str(cluster.configuration)}
    output, here = tmp_path / "farm" / "a", tmp_path / "here" / "a"
    finished(call(root, "render", scene, "-s", 1, "-e", 8, "-o", here))
    # Last in the queue goes first: of one output, only one submission may be under way, so each has its own.
    ranges = call(
        root, "farm", scene, "-s", 8, "-e", 8, "-o", f"{output}-r", "--samples-per-job", 3, "--wait", **environment
    )
    killed = None
    while killed is None and ranges.poll() is None:
        killed = cluster.kill_worker("--sample-range", "2/3")
        time.sleep(0.02)
    assert killed is not None
    tiles = call(root, "farm", scene, "-s", 7, "-e", 7, "-o", f"{output}-t", "--tiles", 4, "--wait", **environment)
    whole = call(root, "farm", scene, "-s", 1, "-e", 6, "-o", output, "--wait", **environment)
    for process in (tiles, whole, ranges):
        finished(process)
    for frame in range(1, 9):
        name = f"{output}{'-r' if frame == 8 else '-t' if frame == 7 else ''}_{frame:04d}"
        assert_same_pictures(here.with_name(f"a_{frame:04d}"), output.with_name(name.rsplit("/", 1)[1]))
    logs = {path: path.read_text() for path in output.parent.glob("*.farm/logs/*.log")}
    assert len(logs) == 6 + 4 + 1 + 3 + 1
    assert [len(re.findall(r"^frame \d", log, re.MULTILINE)) for log in logs.values()] == [1] * len(logs)
    assert sum("is queued again" in log for log in logs.values()) == 1
    assert not list(output.parent.glob("**/*.npz")) and not list(output.parent.glob("**/.*"))

    # What is there is left as it is; what is not is rendered.
    assert "all frames are there" in finished(call(root, "farm", scene, "-s", 1, "-e", 6, "-o", output, **environment))
    times = {path: path.stat().st_mtime_ns for path in output.parent.glob("a_*")}
    (lost := output.parent / "a_0003.png").unlink()
    finished(call(root, "farm", scene, "-s", 1, "-e", 6, "-o", output, "--wait", **environment))
    assert lost.is_file()
    assert all(path.stat().st_mtime_ns == old for path, old in times.items() if "_0003" not in path.name)


def test_a_wrong_call_gets_one_clear_sentence(root, tmp_path):
    file = root / "blend_scenes" / "studio.blend"
    for arguments, complaint in (
        ((), "which file?"),
        ((file,), "-s and -e say which frames"),
        ((file, "-s", 1, "-e", "x"), "-s and -e say which frames"),
        ((file, "-s", 2, "-e", 1), "-s 2 is after -e 1"),
        ((file, "-s", 1, "-e", 1, "--tiles", 0), "--tiles is 0"),
        (("nothing.blend", "-s", 1, "-e", 1), "there is no file nothing.blend"),
    ):
        assert complaint in finished(call(root, "farm", *arguments), 1 if "nothing" in complaint else 2)
    (tmp_path / "bin").mkdir()
    for name in ("bash", "dirname", "readlink", "env"):
        (tmp_path / "bin" / name).symlink_to(f"/usr/bin/{name}")
    log = finished(call(root, "farm", file, "-s", 1, "-e", 1, PATH=str(tmp_path / "bin")), 1)
    assert "there is no sbatch" in log


def test_a_part_that_is_there_is_not_rendered_again_and_a_missing_one_is_named(root, scene, tmp_path):
    output = tmp_path / "a"
    finished(call(root, "render", scene, "-o", output, "--tile", "1/2"))
    (part,) = (tmp_path / "a.parts").iterdir()
    assert part.name == "tile-1-of-2_samples-1-of-1.npz"
    before = part.stat().st_mtime_ns
    finished(call(root, "render", scene, "-o", output, "--tile", "1/2"))
    assert part.stat().st_mtime_ns == before
    log = finished(call(root, "render", scene, "-o", output, "--merge"), 1)
    assert "missing" in log and "tile-2-of-2_samples-1-of-1.npz" in log
    assert not output.with_suffix(".png").exists()
    # A file of another content wants parts of its own.
    part.write_bytes(part.read_bytes()[:500])
    log = finished(call(root, "render", scene, "-o", output, "--merge"), 1)
    assert "there is no part of frame 1" in log
    finished(call(root, "render", scene, "-o", output, "--tile", "1/2"))
    assert part.stat().st_size > 500


@pytest.mark.parametrize("share", ["3/2", "0/2", "2", "a/b", "1/2/3"])
def test_a_share_that_is_none_is_refused(root, share):
    file = root / "blend_scenes" / "studio.blend"
    assert f"--tile is {share}, and not like 2/4" in finished(call(root, "render", file, "--tile", share), 2)
