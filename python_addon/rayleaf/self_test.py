"""Does the core work in this Blender? It renders three triangles whose picture is known.

When the add-on is enabled the test runs in a copy of the process, where a crash harms nobody and the core is loaded for the
test alone. What has passed is remembered beside the core, and only looked up the next time.
"""

import json
import os
import select
import signal
import time
import warnings
from pathlib import Path
from types import ModuleType

import bpy

from . import core_module

_COLORS = ((0.5, 0.0, 0.25), (0.0, 1.0, 0.5), (2.0, 0.25, 0.0))  # what the triangles emit
_SIDE = 10  # pixels along a triangle's base
_PARTS = 8  # that each is cut into: Embree meets meshes that have more than a few triangles
_TOLERANCE = 1e-5  # a weighted mean of equal samples, in single precision
_ENOUGH_SECONDS = 20.0  # for a test that takes a fraction of one
_MEMORY = "self_test.json"
_WRONG = (
    "Rayleaf renders a known picture wrongly in this Blender: libraries of Blender's may answer in place of Rayleaf's. "
    "Install a zip made by `rayleaf package`."
)


def wrong_picture(core: ModuleType) -> str | None:
    """Render the triangles; None, or what is wrong."""
    import numpy as np

    scene = core.SceneDescription()
    materials = []
    for number, color in enumerate(_COLORS):
        program = core.Program(f"triangle {number}")
        one = program.constant(1.0, 1.0, 1.0, 1.0)
        program.operation("emission", [one, program.constant(*color, 1.0), one])
        materials.append(scene.add_material(f"triangle {number}", program))
    parts = [(number, part / _PARTS) for number in range(3) for part in range(_PARTS)]
    corners = [(n + x, y, 0.0) for n, at in parts for x, y in ((at, 0.0), (at + 1.0 / _PARTS, 0.0), (0.5, 1.0))]
    slots = np.repeat(np.arange(3, dtype=np.int32), _PARTS)
    triangles = np.arange(len(corners), dtype=np.int32).reshape(-1, 3)
    shape = scene.add_mesh("triangles", np.array(corners, np.float32), triangles, material_slots=slots)
    scene.add_instance("triangles", shape, np.eye(4), scene.add_material_list(materials))
    above = np.eye(4)
    above[2, 3] = 1.0
    scene.set_camera("ORTHOGRAPHIC", above, (0.0, 0.0), (3.0, 1.0), 0.1, 10.0)
    session = core.Session(scene, core.Settings(width=3 * _SIDE, height=_SIDE, samples=1, threads=1))
    session.render()
    pixels = session.pass_pixels("combined")
    centers = pixels[_SIDE // 3, _SIDE // 2 :: _SIDE, :3]
    corner = pixels[_SIDE - 1, 0, :3]
    right = np.abs(centers - _COLORS).max() <= _TOLERANCE and np.abs(corner).max() <= _TOLERANCE
    return None if right else _WRONG


def run() -> str | None:
    """Load the core and test it, here and now; None, or what is wrong."""
    try:
        return wrong_picture(core_module.load())
    except core_module.CoreError as error:
        return str(error)
    except Exception as error:  # whatever it is, people shall read it
        return f"Rayleaf's self-test failed: {type(error).__name__}: {error}"


def checked() -> str | None:
    """None if the core passed in a Blender like this, now or earlier; otherwise what is wrong."""
    key, stamp = _key(), _stamp()
    memory = core_module.path().parent / _MEMORY if core_module.path().is_file() else None
    known = _remembered(memory)
    if known.get(key) == stamp:
        return None
    try:
        problem = _run_in_a_copy()
    except TimeoutError:  # a machine so busy tells nothing of the core: test again when enabled next
        return None
    if problem is None and memory is not None:
        _remember(memory, known | {key: stamp})
    return problem


def _key() -> str:
    """Which Blender this is."""
    return f"{bpy.app.version_string} {bpy.app.binary_path or os.path.realpath(bpy.__file__)}"


def _stamp() -> list[str]:
    """What else the answer depends on: core, program, libraries put before others, machine."""
    stamp = [os.environ.get("LD_PRELOAD", ""), *os.uname()]
    for path in (core_module.path(), Path(bpy.app.binary_path or bpy.__file__)):
        try:
            status = path.stat()
            stamp.append(f"{path} {status.st_mtime_ns} {status.st_size}")
        except OSError:
            stamp.append(str(path))
    return stamp


def _remembered(memory: Path | None) -> dict[str, list[str]]:
    try:
        known = json.loads(memory.read_text()) if memory is not None else {}
    except (OSError, ValueError):
        return {}
    return known if isinstance(known, dict) else {}


def _remember(memory: Path, known: dict[str, list[str]]) -> None:
    """Write beside, then rename. Where nothing can be written, the next enabling tests again."""
    beside = memory.with_name(f"{memory.name}.{os.getpid()}")
    try:
        beside.write_text(json.dumps(known))
        beside.replace(memory)
    except OSError:
        pass


def _run_in_a_copy() -> str | None:
    """`run` in a forked process, which has the same libraries loaded."""
    reading, writing = os.pipe()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # of forking with threads: the copy uses its own alone
        child = os.fork()
    if child == 0:
        try:
            os.close(reading)
            os.write(writing, (run() or "").encode())
        finally:
            os._exit(0)  # nothing of the copy may be cleaned up, Blender's windows least of all
    os.close(writing)
    try:
        return _answer(child, reading)
    finally:
        os.close(reading)


def _answer(child: int, reading: int) -> str | None:
    """Wait for the copy and read what it found. Raises TimeoutError."""
    began, text = time.monotonic(), b""
    while True:
        left = _ENOUGH_SECONDS - (time.monotonic() - began)
        if left <= 0 or not select.select([reading], [], [], left)[0]:
            os.kill(child, signal.SIGKILL)
            os.waitpid(child, 0)
            raise TimeoutError
        part = os.read(reading, 4096)
        if not part:
            break
        text += part
    _, status = os.waitpid(child, 0)
    if os.WIFSIGNALED(status):
        name = signal.Signals(os.WTERMSIG(status)).name
        return (
            f"Rayleaf's core crashes in this Blender ({name} in its self-test). Install Rayleaf's zip again; if that does not "
            "help, please report it."
        )
    return text.decode() or None
