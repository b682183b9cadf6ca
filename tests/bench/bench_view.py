"""Rendered shading in Blender's window: how long until the first picture, how often a new one while the camera turns, and
for how long Blender does not answer.

./rayleaf bench view: each scene of blend_scenes in a view of 1280 x 720 pixels under Xvfb, which draws without a graphics
card. `export` is the part of the first picture's time in which the scene is handed to the core; `ours` is what a picture of
the turning camera takes from the core's beginning to its first pixels, without drawing; `held` is the longest of the calls in
which Blender waits for the engine meanwhile, drawing by the graphics library included. A stall is the longest time
between two calls of a timer that asks to be called all the time; that of Solid shading is Blender's own.
"""

import json
import os
import tempfile
from pathlib import Path
from typing import Any

from bench_window import with_display

PRINTS_ITSELF = True
FILES = Path(__file__).resolve().parents[2] / "blend_scenes"
QUICK_SCENES = ("bezier_sheet",)

SCRIPT = """
import json, math, os, sys, time, traceback
import bpy, mathutils
from rayleaf.viewport import viewport, worker

report = sys.argv[-1]
exports, pictures, stalls, own, held = [], [], [], [], []

def watch(kind, name, note):
    plain = getattr(kind, name)
    def watched(self, *arguments):
        began = time.perf_counter()
        plain(self, *arguments)
        note(self, time.perf_counter() - began)
    setattr(kind, name, watched)

def drawn(view, seconds):
    held.append(seconds)
    if view._drawn is not None and (not pictures or pictures[-1][0] is not view._drawn):
        pictures.append((view._drawn, time.perf_counter()))

render, publish = worker.Worker._render, worker.Worker._publish

def rendered(self, request):
    self.began = time.perf_counter()
    render(self, request)

def published(self, *arguments):
    publish(self, *arguments)
    if self.began is not None:
        own.append(time.perf_counter() - self.began)
    self.began = None

worker.Worker._render, worker.Worker._publish = rendered, published
def updated(_, seconds):
    exports.append(seconds)
    held.append(seconds)

watch(viewport.Viewport, "update", updated)
watch(viewport.Viewport, "draw", drawn)

def space():
    area = next(area for area in bpy.context.window_manager.windows[0].screen.areas if area.type == "VIEW_3D")
    return area, area.spaces[0]

def fill_window():
    window = bpy.context.window_manager.windows[0]
    with bpy.context.temp_override(window=window, area=space()[0]):
        bpy.ops.screen.screen_full_area(use_hide_panels=True)

def look_through_camera():
    region = space()[1].region_3d
    camera = bpy.context.scene.camera
    region.view_perspective = "PERSP"
    region.view_matrix = camera.matrix_world.inverted() if camera else region.view_matrix

def turn():
    region = space()[1].region_3d
    region.view_rotation = mathutils.Quaternion((0, 0, 1), math.radians(1)) @ region.view_rotation

def longest(times):
    return max((b - a for a, b in zip(times, times[1:])), default=0.0)

def wait(seconds, work=lambda: None):
    del stalls[:]
    end = time.perf_counter() + seconds
    while time.perf_counter() < end:
        stalls.append(time.perf_counter())
        work()
        yield 0.001

def steps():
    bpy.context.preferences.view.show_splash = False
    scene = bpy.context.scene
    scene.render.engine = "RAYLEAF"
    scene.rayleaf.preview_samples = 100000
    yield 0.5
    fill_window()
    yield 0.5
    space()[1].overlay.show_overlays = False
    look_through_camera()
    yield 0.5
    result = {}
    yield from wait(2.0, turn)
    result["stall_solid"] = longest(stalls)
    look_through_camera()
    yield 0.5
    began = time.perf_counter()
    space()[1].shading.type = "RENDERED"
    while not pictures:
        assert time.perf_counter() < began + 120, "no picture"
        yield 0.001
    result["first"] = pictures[-1][1] - began
    result["export"] = exports[0]
    yield 1.0
    yield from wait(2.0)
    result["stall_refining"] = longest(stalls)
    del pictures[:], own[:], held[:]
    yield from wait(3.0, turn)
    result["held"] = max(held)
    result["own"] = sorted(own)[len(own) // 2]
    result["stall_turning"] = longest(stalls)
    times = [when for _, when in pictures]
    result["pictures"] = len(times) / 3.0
    region = next(region for region in space()[0].regions if region.type == "WINDOW")
    result["size"] = region.width, region.height
    space()[1].shading.type = "SOLID"
    yield 0.2
    with open(report, "w") as file:
        json.dump(result, file)

walk = steps()

def step():
    try:
        return next(walk)
    except StopIteration:
        bpy.ops.wm.quit_blender()
    except BaseException:
        traceback.print_exc()
        os._exit(1)

bpy.app.timers.register(step, first_interval=1.0, persistent=True)
"""


def measured(scene: str, folder: Path) -> dict[str, Any]:
    """What Blender reports of a view of a scene."""
    script, report = folder / "script.py", folder / "report.json"
    script.write_text(SCRIPT)
    environment = {
        **os.environ,
        "BLENDER_USER_SCRIPTS": str(Path(os.environ["RAYLEAF_PACKAGE_DIR"]).parent),
        "LIBGL_ALWAYS_SOFTWARE": "1",
    }
    options = ["--factory-startup", "-p", "0", "0", "1280", "720", "--addons", "rayleaf", str(FILES / f"{scene}.blend")]
    command = [os.environ.get("BLENDER", "blender"), *options, "--python", str(script), "--", str(report)]
    run = with_display(command, environment, "1280x720")
    assert run.returncode == 0 and report.exists(), run.stdout + run.stderr
    result: dict[str, Any] = json.loads(report.read_text())
    return result


def run(quick: bool = False) -> list[dict[str, Any]]:
    """Prints a line for each scene."""
    scenes = QUICK_SCENES if quick else sorted(path.stem for path in FILES.glob("*.blend"))
    print(
        f"{'scene':<22}{'first, s':>10}{'export, s':>11}{'pictures/s':>12}{'ours, ms':>10}{'held, ms':>10}"
        f"{'stall, ms: solid':>18}{'refining':>10}{'turning':>9}"
    )
    rows = []
    for scene in scenes:
        with tempfile.TemporaryDirectory() as folder:
            found = measured(scene, Path(folder))
        stalls = [1000 * found[f"stall_{kind}"] for kind in ("solid", "refining", "turning")]
        print(
            f"{scene:<22}{found['first']:>10.2f}{found['export']:>11.2f}{found['pictures']:>12.1f}"
            f"{1000 * found['own']:>10.0f}{1000 * found['held']:>10.0f}"
            f"{stalls[0]:>18.0f}{stalls[1]:>10.0f}{stalls[2]:>9.0f}",
            flush=True,
        )
        rows.append({"name": scene, "unit": "s", "values": [found["first"]]})
    return rows
