"""The script `rayleaf`, as people call it."""

import json
import os
import subprocess
from pathlib import Path

import pytest

COMMANDS = ("render", "farm", "test", "bench", "lint", "blender", "package")

MAKE_SCENE = """
import sys
import bpy
scene = bpy.context.scene
scene.render.engine = "RAYLEAF"
scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 32, 24, 100
scene.rayleaf.samples = 1
if "no camera" in sys.argv:
    bpy.data.objects.remove(scene.camera)
bpy.ops.wm.save_as_mainfile(filepath=sys.argv[1])
"""


def call(root: Path, *arguments: object, **environment: str) -> subprocess.CompletedProcess[str]:
    """`rayleaf` with arguments, as from a shell that has none of the test's settings."""
    inherited = {key: value for key, value in os.environ.items() if not key.startswith(("RAYLEAF_", "PYTEST_"))}
    command = [str(root / "rayleaf"), *map(str, arguments)]
    return subprocess.run(
        command, env={**inherited, **environment}, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=600
    )


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_explains_itself(root, command):
    done = call(root, command, "--help")
    assert done.returncode == 0
    assert f"rayleaf {command}" in done.stdout


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        (("paint",), "there is no command paint"),
        (("render",), "which file?"),
        (("render", "nothing.blend"), "there is no file nothing.blend"),
        (("render", "a.blend", "b.blend"), "one file at a time"),
        (("render", "a.blend", "-s", "1"), "-s and -e go together"),
        (("render", "a.blend", "-s", "5", "-e", "1"), "-s 5 is after -e 1"),
        (("render", "a.blend", "-s", "1", "-e", "two"), "-e is two, and not the number of a frame"),
        (("render", "a.blend", "-f", "abc"), "-f is abc, and not the number of a frame"),
        (("render", "--turbo"), "there is no option --turbo"),
        (("render", "-o"), "-o wants a value"),
    ],
)
def test_a_wrong_call_gets_one_clear_sentence(root, arguments, complaint):
    done = call(root, *arguments)
    assert done.returncode != 0
    assert complaint in done.stderr


def test_a_blender_that_is_not_there_is_named(root, tmp_path):
    done = call(root, "render", root / "blend_scenes" / "studio.blend", BLENDER=str(tmp_path / "blender"))
    assert done.returncode != 0
    assert str(tmp_path / "blender") in done.stderr


def test_a_blender_whose_python_is_not_here_is_refused_with_the_version_it_wants(root, tmp_path):
    other = tmp_path / "blender"
    other.write_text("#!/bin/sh\necho PYTHON 9.99\n")
    other.chmod(0o755)
    done = call(root, "render", root / "blend_scenes" / "studio.blend", BLENDER=str(other))
    assert done.returncode != 0
    assert "runs Python 9.99" in done.stderr


def test_another_blender_with_the_same_python_renders(root, run_blender, tmp_path):
    run_blender(MAKE_SCENE, tmp_path / "scene.blend")
    other = tmp_path / "another blender"
    other.write_text('#!/bin/sh\nexec /usr/bin/blender "$@"\n')
    other.chmod(0o755)
    done = call(root, "render", tmp_path / "scene.blend", "-o", tmp_path / "a", BLENDER=str(other))
    assert done.returncode == 0, done.stdout + done.stderr
    assert (tmp_path / "a.png").exists()


def test_render_writes_picture_layers_and_statistics_for_each_frame(root, run_blender, tmp_path):
    run_blender(MAKE_SCENE, tmp_path / "scene.blend")
    done = call(
        *(root, "render", tmp_path / "scene.blend", "-s", 2, "-e", 3),
        *("-o", tmp_path / "pictures" / "a", "--stats", tmp_path / "statistics.json"),
    )
    assert done.returncode == 0, done.stdout + done.stderr
    names = ["a_0002.exr", "a_0002.png", "a_0003.exr", "a_0003.png"]
    assert sorted(path.name for path in (tmp_path / "pictures").iterdir()) == names
    assert (tmp_path / "pictures" / "a_0002.png").read_bytes().startswith(b"\x89PNG")
    assert b"ViewLayer.Combined.R" in (tmp_path / "pictures" / "a_0002.exr").read_bytes()
    frames = json.loads((tmp_path / "statistics.json").read_text())["frames"]
    assert [frame["frame"] for frame in frames] == [2, 3]
    assert all(layer["completed"] for frame in frames for layer in frame["view_layers"])
    assert "frame 3" in done.stdout


def test_a_render_that_fails_says_why_and_has_an_exit_code(root, run_blender, tmp_path):
    run_blender(MAKE_SCENE, tmp_path / "scene.blend", "no camera")
    done = call(root, "render", tmp_path / "scene.blend", "-o", tmp_path / "picture")
    assert done.returncode != 0
    assert "camera" in done.stderr
    assert not (tmp_path / "picture.png").exists()


def test_packages_are_waited_for_while_another_apt_get_runs(root, tmp_path):
    """apt-get fails at once where another holds the lock of its lists; any other failure is final."""
    programs = {
        "dpkg-query": "exit 0",  # nothing is installed
        "sudo": '"$@"',
        "sleep": "exit 0",
        "apt-get": f"""echo call >>{tmp_path}/calls
        case $(wc -l <{tmp_path}/calls) in
        1 | 2) echo 'E: Could not get lock /var/lib/apt/lists/lock. It is held by process 1 (apt-get)' >&2 ;;
        *) echo 'E: The network is down' >&2 ;;
        esac
        exit 100""",
    }
    for name, text in programs.items():
        program = tmp_path / name
        program.write_text(f"#!/bin/sh\n{text}\n")
        program.chmod(0o755)
    done = call(root, "package", PATH=f"{tmp_path}:{os.environ['PATH']}")
    assert done.returncode != 0
    assert (tmp_path / "calls").read_text().count("call") == 3
    assert "Could not get lock" not in done.stderr
    assert "The network is down" in done.stderr
