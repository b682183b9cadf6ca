"""How the add-on comes into Blender and goes again."""

import subprocess
import sys

import pytest


def test_enabling_the_add_on_offers_the_engine_and_loads_no_core(run_blender):
    run = run_blender(
        """
import sys, bpy
scene = bpy.context.scene
scene.render.engine = "RAYLEAF"
report(engine=scene.render.engine, loaded="rayleaf._core" in sys.modules, samples=scene.rayleaf.samples)
"""
    ).report
    assert run == {"engine": "RAYLEAF", "loaded": False, "samples": 64}


OPENED = """
import sys, time
import addon_utils, bpy

assert not any(name.startswith("rayleaf") for name in sys.modules), "the add-on was there before it was enabled"
began = time.process_time()
addon_utils.enable("rayleaf")
seconds = time.process_time() - began
assert hasattr(bpy.types.Scene, "rayleaf") and "rayleaf._core" not in sys.modules
print("\\nSECONDS", seconds)
"""


def test_opening_blender_with_the_add_on_takes_less_than_a_tenth_of_a_second_more(run_blender):
    """Processor time of the process around the enabling, which is all that opening has to do more: other programs do not
    count, and 0.023 s when measured leaves four times as much. The best of three, for the first compiles the files."""
    run = run_blender(
        f"""
import subprocess, bpy

command = [bpy.app.binary_path, "--background", "--factory-startup", "--python-exit-code", "1"]
seconds = []
for _ in range(3):
    done = subprocess.run([*command, "--python-expr", {OPENED!r}], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    seconds += [float(line.split()[1]) for line in done.stdout.splitlines() if line.startswith("SECONDS")]
report(seconds=seconds)
"""
    ).report
    assert len(run["seconds"]) == 3
    assert min(run["seconds"]) < 0.1, run["seconds"]


def test_enabling_the_add_on_loads_itself_and_a_little_of_pythons_library(run_blender):
    """Opening Blender must not become slower, and imports are all that it takes."""
    run = run_blender(
        """
import sys
import bpy

own = [name for name in sys.modules if name.startswith("rayleaf")]
of_blender = {"numpy"} if bpy.app.version >= (4, 5) else set()  # which loads it itself
heavy = ("numpy", "matplotlib", "skimage", "OpenImageIO", "scipy")
report(own=len(own), core="rayleaf._core" in own, heavy=[name for name in heavy if name in sys.modules and name not in of_blender],
       exporters=[name for name in own if name.startswith("rayleaf.export.")])
"""
    ).report
    # Each is a page; panels, a view's choice of pass and the count of undos must be there before the first view is.
    assert 0 < run["own"] < 37 and not run["core"]
    assert run["heavy"] == [] and run["exporters"] == []


def test_disabling_the_add_on_leaves_nothing_behind_and_enabling_again_works(run_blender):
    run = run_blender(
        """
import addon_utils, bpy

def shown():
    def walk(base):
        for each in base.__subclasses__():
            yield each
            yield from walk(each)
    return sum("RAYLEAF" in getattr(panel, "COMPAT_ENGINES", ()) for panel in walk(bpy.types.Panel)
               if panel.__module__.startswith("bl_ui"))

counts = [shown()]
addon_utils.disable("rayleaf")
counts.append(shown())
report(property=hasattr(bpy.types.Scene, "rayleaf"), panel=hasattr(bpy.types, "RAYLEAF_PT_sampling"))
addon_utils.enable("rayleaf")
counts.append(shown())
bpy.context.scene.render.engine = "RAYLEAF"
report(counts=counts)
"""
    ).report
    assert (run["property"], run["panel"]) == (False, False)
    enabled, disabled, again = run["counts"]
    assert enabled == again > 100 and disabled == 0


def test_the_package_and_its_core_are_usable_from_plain_python(addons):
    code = "import sys, rayleaf, rayleaf._core; assert 'bpy' not in sys.modules; print(rayleaf._core.Program('a').name)"
    done = subprocess.run([sys.executable, "-c", code], env={"PYTHONPATH": str(addons)}, capture_output=True, text=True)
    assert done.stdout == "a\n", done.stderr


def test_the_settings_that_an_artist_sees_are_the_cores_with_the_same_defaults(run_blender):
    run = run_blender(
        """
import bpy
from rayleaf import _core
from rayleaf.export.camera import crop_of, frame_of
from rayleaf.passes import enabled
from rayleaf.settings import core_settings

scene = bpy.context.scene
scene.render.threads_mode = "AUTO"
layer, frame = bpy.context.view_layer, frame_of(scene)
sent = core_settings(_core, scene, layer, frame, crop_of(scene, frame), enabled(layer))
built, plain = _core.Settings(**sent), _core.Settings()
names = [name for name in dir(plain) if not name.startswith("_")]
report(unset=[name for name in names if name not in sent],
       different=[name for name in names if getattr(built, name) != getattr(plain, name)])
"""
    ).report
    of_parts = {"first_sample", "sample_count", "keep_sums", "part_x", "part_y", "part_width", "part_height"}
    # The first is for views, the others for tests: the picture is the same for any.
    assert set(run["unset"]) == {*of_parts, "draft", "stream_paths", "tile_size"}
    # The core is exact by default. An artist's default blurs what diffuse light meets in mirrors, as Cycles' does.
    assert set(run["different"]) == {"width", "height", "crop_width", "crop_height", "filter_glossy"}


@pytest.mark.parametrize("mode", ["FIXED", "AUTO"])
def test_blenders_own_settings_for_threads_and_film_are_used(run_blender, mode):
    run = run_blender(
        f"""
import bpy, scenes, recording_core
core = recording_core.install()
scene = bpy.context.scene
render = scene.render
render.engine, render.threads_mode = "RAYLEAF", {mode!r}
if {mode!r} == "FIXED":
    render.threads = 3
render.film_transparent, scene.rayleaf.use_animated_seed, scene.rayleaf.seed = True, True, 100
scene.frame_set(7)
bpy.ops.render.render()
sent = core.Session.last.settings
report(threads=sent.threads, transparent=sent.film_transparent, seed=sent.seed)
"""
    ).report
    assert run == {"threads": 3 if mode == "FIXED" else 0, "transparent": True, "seed": 107}
