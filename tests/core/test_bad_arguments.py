"""Every bound function is given what it does not want, and answers with an exception, never with the end of the process.

The calls are generated from the stub (core/bad_arguments.py) and made in another process, so that a crash has a name.
"""

import os
import subprocess
import sys
import threading
from pathlib import Path

import numpy as np
import pytest
import rayleaf_rivals
from core import bad_arguments, scenes, shapes
from rayleaf import _core

MOST_CRASHES = 12


def test_every_bound_function_has_a_call_that_holds():
    assert sorted(bad_arguments.bound()) == sorted(bad_arguments.CALLS)


def calls_from(first: int) -> tuple[int, list[str]]:
    """Make the calls from one on: the exit code and what was said."""
    folders = [
        str(Path(__file__).parents[1]),
        str(Path(_core.__file__).parents[1]),
        str(Path(rayleaf_rivals.__file__).parent),
    ]
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(folders), "PYTHONWARNINGS": "ignore"}
    done = subprocess.run(
        [sys.executable, "-m", "core.bad_arguments", str(first)],
        env=environment,
        cwd=folders[0],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        errors="replace",
    )
    lines = done.stdout.splitlines()
    if done.returncode == 0 and lines[-1:] != ["END"]:
        lines.append(f"UNCLEAN\tended early: {done.stderr[-1000:]}")
    if done.returncode != 0:
        lines.append(f"STDERR\t{done.stderr[-1500:]}")
    return done.returncode, lines


@pytest.mark.slow
def test_bad_arguments_raise_clean_exceptions():
    troubles, first = [], 0
    for _ in range(MOST_CRASHES):
        code, lines = calls_from(first)
        troubles += [line for line in lines if line.startswith("UNCLEAN")]
        if code == 0:
            break
        last = next((line for line in reversed(lines) if line.split("\t")[0].isdigit()), None)
        assert last, "\n".join(lines)
        troubles.append(f"exit code {code}: {last} {lines[-1] if lines[-1].startswith('STDERR') else ''}")
        first = int(last.split("\t")[0]) + 1
    assert not troubles, "\n".join(troubles)


ALONE = """
from core import test_bad_arguments

test_bad_arguments.{name}()
print("END")
"""


def ends_well(name: str) -> bool:
    """Call a function of this file in another process."""
    folders = [
        str(Path(__file__).parents[1]),
        str(Path(_core.__file__).parents[1]),
        str(Path(rayleaf_rivals.__file__).parent),
    ]
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(folders)}
    done = subprocess.run(
        [sys.executable, "-c", ALONE.format(name=name)],
        env=environment,
        capture_output=True,
        text=True,
        errors="replace",
    )
    print(f"exit code {done.returncode}: {done.stderr[-2000:]}")
    return done.returncode == 0 and done.stdout.endswith("END\n")


def add_while_rendering() -> None:
    """Fill a scene and a program in one thread while another renders them."""
    scene, program = _core.SceneDescription(), _core.Program("grows")
    one = program.constant(1, 1, 1, 1)
    program.operation("diffuse", [one, one])
    shape = scenes.quad(scene, "quad")
    scene.add_material_list([scene.add_material("grows", program)])
    scenes.look_down(scene)
    settings = _core.Settings(width=32, height=32, crop_width=32, crop_height=32, samples=1, threads=2)
    for _ in range(10):
        for i in range(300):
            scene.add_instance(f"before {i}", shape, scenes.matrix((0, 0, -1e-3 * i)), 0)
        session = _core.Session(scene, settings)
        renders = threading.Thread(target=session.render)
        renders.start()
        for i in range(200):
            scene.add_instance("meanwhile", shape, scenes.matrix((0, 0, -5)), 0)
            program.operation("diffuse", [one, program.constant(1, 0.5, i, 1)])
            if i % 50 == 0:
                scene.add_material("more", program)
        renders.join()
        assert np.isfinite(session.pass_pixels("combined")).all()


def test_a_scene_may_be_filled_while_it_is_rendered():
    assert ends_well("add_while_rendering")


def build_with_little_memory() -> None:
    """Shapes that give Embree buffers, with less and less memory left."""
    import resource

    count = 300_000
    points = np.stack([np.arange(count) * 1e-5, np.zeros(count), np.zeros(count)], axis=1)
    hair = _core.Strands(
        "hair", points, np.full(count, 1e-4, np.float32), np.array([0, count], np.int32), form="EMBREE_ROUND"
    )
    used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    refused = 0
    for megabytes in (8, 16, 24, 32):
        resource.setrlimit(resource.RLIMIT_AS, (used + megabytes * (1 << 20), resource.RLIM_INFINITY))
        try:
            _core.trace.Tracer([(hair, np.eye(4), shapes.EVERYTHING)])
        except (MemoryError, RuntimeError):
            refused += 1
        resource.setrlimit(resource.RLIMIT_AS, (resource.RLIM_INFINITY, resource.RLIM_INFINITY))
    assert refused > 0


@pytest.mark.skipif("asan" in os.environ.get("LD_PRELOAD", ""), reason="the sanitizer maps terabytes")
def test_too_little_memory_for_embree_is_an_exception():
    assert ends_well("build_with_little_memory")


def test_a_session_renders_once():
    session = _core.Session(bad_arguments.scene(), bad_arguments.settings())
    assert session.render()
    with pytest.raises(_core.InputError, match="session.*render is asked for again"):
        session.render()
