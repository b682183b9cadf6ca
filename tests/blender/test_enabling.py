"""Enabling the add-on finds out whether its core works in this Blender, and says in a sentence what is wrong."""

import json
import re
import shutil
import subprocess
from pathlib import Path

import pytest

RENDER = """
import sys
import bpy, rayleaf
from rayleaf import enabling

scene = bpy.context.scene
scene.render.engine = "RAYLEAF"
scene.render.resolution_x = scene.render.resolution_y = 16
scene.rayleaf.samples = 1
loaded = "rayleaf._core" in sys.modules
try:
    bpy.ops.render.render()
    said = ""
except RuntimeError as error:
    said = str(error)
report(problem=enabling.problem, said=said, loaded=loaded, completed=rayleaf.last_statistics.get("completed"))
"""


@pytest.fixture
def copy(addons: Path, tmp_path: Path) -> Path:
    """An add-on of its own, without memory of earlier tests, to be spoilt."""
    folder = tmp_path / "scripts" / "addons" / "rayleaf"
    shutil.copytree(addons / "rayleaf", folder, ignore=shutil.ignore_patterns("self_test.json*", "__pycache__"))
    return folder


def module_of(add_on: Path) -> Path:
    """The compiled core."""
    (module,) = add_on.glob("_core.*.so")
    return module


def scripts_of(add_on: Path) -> dict[str, str]:
    """What shows an add-on to Blender."""
    return {"BLENDER_USER_SCRIPTS": str(add_on.parents[1])}


def test_the_first_enabling_tests_the_core_and_later_ones_remember(run_blender, copy):
    memory = copy / "self_test.json"
    first = run_blender(RENDER, env=scripts_of(copy)).report
    assert first == {"problem": None, "said": "", "loaded": False, "completed": True}
    (stamp,) = json.loads(memory.read_text()).values()
    assert any(str(module_of(copy)) in part for part in stamp)
    written = memory.stat().st_mtime_ns
    assert run_blender(RENDER, env=scripts_of(copy)).report == first
    assert memory.stat().st_mtime_ns == written
    module_of(copy).touch()
    assert run_blender(RENDER, env=scripts_of(copy)).report == first
    assert memory.stat().st_mtime_ns > written


def test_a_memory_that_cannot_be_read_or_written_is_done_without(run_blender, copy):
    (copy / "self_test.json").mkdir()
    run = run_blender(RENDER, env=scripts_of(copy)).report
    assert (run["problem"], run["completed"]) == (None, True)


def remove(module: Path) -> None:
    module.unlink()


def cut_in_half(module: Path) -> None:
    content = module.read_bytes()
    module.write_bytes(content[: len(content) // 2])


def empty(module: Path) -> None:
    module.write_bytes(b"")


def fill_with_text(module: Path) -> None:
    module.write_text("not a library\n" * 100)


def make_for_another_python(module: Path) -> None:
    module.rename(module.with_name("_core.cpython-399-x86_64-linux-gnu.so"))


def cut_off_from_a_library(module: Path) -> None:
    content = module.read_bytes()
    assert content.count(b"libtbb.so.12\0") == 1
    module.write_bytes(content.replace(b"libtbb.so.12\0", b"libnix.so.12\0"))


def make_for_a_newer_system(module: Path) -> None:
    content = module.read_bytes()
    assert b"\0GLIBC_2.2.5\0" in content
    # The loader compares the name and its hash; both are in the file, the hash in SysV's way.
    changed = content.replace(b"\0GLIBC_2.2.5\0", b"\0GLIBC_9.9.9\0")
    changed = changed.replace(sysv_hash(b"GLIBC_2.2.5"), sysv_hash(b"GLIBC_9.9.9"))
    module.write_bytes(changed)


def sysv_hash(name: bytes) -> bytes:
    value = 0
    for byte in name:
        value = (value << 4) + byte
        high = value & 0xF0000000
        value = (value ^ (high >> 24)) & ~high
    return value.to_bytes(4, "little")


@pytest.mark.parametrize(
    ("spoil", "sentence"),
    [
        (remove, "compiled core is missing in .*Install Rayleaf's zip again"),
        (
            cut_in_half,
            "are damaged. Install Rayleaf's zip again|core crashes in this Blender.*Install Rayleaf's zip again",
        ),
        (empty, "are damaged. Install Rayleaf's zip again"),
        (fill_with_text, "are damaged. Install Rayleaf's zip again"),
        (make_for_another_python, r"for Blenders with Python 3.99; this one has 3.\d+. Install the package for it"),
        (cut_off_from_a_library, "library libnix.so.12 is missing. Install Rayleaf's zip again"),
        (make_for_a_newer_system, r"Linux is too old for Rayleaf.*lacks GLIBC_9.9.9, this system has glibc 2"),
    ],
)
def test_a_core_that_does_not_fit_is_told_of_when_enabled_and_when_rendering(run_blender, copy, spoil, sentence):
    spoil(module_of(copy))
    run = run_blender(RENDER, env=scripts_of(copy), check=False)  # Blender 3 counts the error that was caught
    assert re.search(sentence, run.report["problem"]), run.report
    assert run.report["problem"] in run.report["said"] and "Rayleaf: " + run.report["problem"] in run.log
    assert "Traceback" not in run.log and run.report["completed"] is None


def test_a_processor_that_is_too_old_is_told_of(run_blender):
    run = run_blender(
        """
from rayleaf import core_module, self_test
core_module._processor_flags = lambda: {"sse", "sse2", "ssse3"}
report(problem=self_test.run())
"""
    )
    assert run.report["problem"].startswith("This processor is too old for Rayleaf, which needs SSE4.2")


def test_an_add_on_of_another_version_than_its_core_asks_for_a_new_start(run_blender, copy):
    source = (copy / "__init__.py").read_text()
    (copy / "__init__.py").unlink()
    (copy / "__init__.py").write_text(re.sub(r'__version__ = ".*"', '__version__ = "9.8.7"', source))
    run = run_blender(RENDER, env=scripts_of(copy), check=False)
    assert (
        "This add-on is Rayleaf 9.8.7, its core" in run.report["said"] and "Start Blender again" in run.report["said"]
    )
    assert "Traceback" not in run.log


def test_a_foreign_embree_in_front_is_found_out(run_blender, copy, tmp_path):
    """As in an official Blender, whose Embree would answer a core that is linked plainly: an empty picture without a word."""
    source, library = tmp_path / "foreign.c", tmp_path / "libforeign.so"
    # Both ways that rays go: one by one, and in packets.
    source.write_text("void rtcIntersect1(void) {}\nvoid rtcIntersect16(void) {}\n")
    subprocess.run(["gcc", "-shared", "-fPIC", "-o", str(library), str(source)], check=True)
    run = run_blender(RENDER, env=scripts_of(copy) | {"LD_PRELOAD": str(library)}, check=False)
    assert "renders a known picture wrongly" in run.report["problem"]
    assert run.report["problem"] in run.report["said"] and run.report["completed"] is None
    assert "Traceback" not in run.log


def test_two_at_once_are_refused_with_a_sentence(run_blender, copy):
    shutil.copytree(copy, copy.with_name("rayleaf_copy"))
    run = run_blender(
        RENDER
        + """
import addon_utils
addon_utils.enable("rayleaf_copy")
addon_utils.disable("rayleaf_copy")
report(kept=hasattr(bpy.types.Scene, "rayleaf"))
addon_utils.disable("rayleaf")
addon_utils.enable("rayleaf_copy")
report(taken_over=hasattr(bpy.types.Scene, "rayleaf"))
""",
        env=scripts_of(copy),
    )
    assert "Another Rayleaf is enabled in this Blender. Disable it" in run.log and "Traceback" not in run.log
    assert run.report["kept"] and run.report["taken_over"] and run.report["completed"]


def test_the_preferences_tell_versions_and_threads_and_test(run_blender):
    run = run_blender(
        """
import bpy
from rayleaf import preferences

before = preferences.lines(bpy.context.scene.render)
result = bpy.ops.rayleaf.self_test()
bpy.context.scene.render.threads_mode, bpy.context.scene.render.threads = "FIXED", 3
report(before=before, result=list(result), after=preferences.lines(bpy.context.scene.render),
       page=[each.bl_idname for each in bpy.types.AddonPreferences.__subclasses__() if each.__module__.startswith("rayleaf")])
"""
    ).report
    assert run["result"] == ["FINISHED"] and run["page"] == ["rayleaf"]
    assert any("shown after the self-test" in line for line in run["before"])
    text = "\n".join(run["after"])
    assert re.search(
        r"Version: \d+\.\d+\.\d+\nCore: /.*_core\..*\.so\nBuilt with: Compiler GNU \d+.*Embree \d.*OpenImageIO \d", text
    )
    assert re.search(r"OpenSubdiv 3\.\d\.\d, OpenVDB \d+\.\d\.\d, TBB 20\d\d", text) and "Threads: 3, as set" in text
