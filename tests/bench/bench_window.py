"""Blender's window used for long under Xvfb: nothing crashes, no thread is left, memory stays within 5 %.

200 switches of shading, 100 sizes of the view, 50 undos, 20 files loaded, the add-on off and on, F12 from a view that renders.
"""

import json
import os
import subprocess
import tempfile
from pathlib import Path
from typing import Any

PRINTS_ITSELF = True
MOST_GROWTH = 0.05
COUNTS = {"switches": 200, "sizes": 100, "undos": 50, "files": 20, "addon": 5, "renders": 5}
QUICK = {"switches": 6, "sizes": 4, "undos": 3, "files": 2, "addon": 1, "renders": 1}
SECONDS = 3600

SCRIPT = """
import gc, json, os, sys, threading, time, traceback
import addon_utils, bpy

counts, report = json.loads(sys.argv[-2]), sys.argv[-1]
blend = os.path.join(os.path.dirname(report), "file.blend")
memory = {}

def view():
    return next(area for area in bpy.context.window_manager.windows[0].screen.areas if area.type == "VIEW_3D")

def resident():
    gc.collect()
    with open("/proc/self/status") as status:
        line = next(line for line in status if line.startswith("VmRSS"))
    return int(line.split()[1]) / 1024

def switch(kind):
    view().spaces[0].shading.type = kind

def prepared():
    scene = bpy.context.scene
    scene.render.engine = "RAYLEAF"
    scene.rayleaf.preview_samples = scene.rayleaf.samples = 2
    scene.render.resolution_x, scene.render.resolution_y = 64, 48
    bpy.context.preferences.view.render_display_type = "NONE"
    bpy.context.preferences.view.show_splash = False

def switches():
    switch("RENDERED")
    yield 0.1
    switch("SOLID")
    yield 0.02

def sizes():
    switch("RENDERED")
    for toggle in ("show_region_ui", "show_region_toolbar"):
        setattr(view().spaces[0], toggle, not getattr(view().spaces[0], toggle))
        yield 0.1

def undos():
    switch("RENDERED")
    bpy.ops.ed.undo_push()
    bpy.ops.mesh.primitive_uv_sphere_add(location=(2, 0, 0))
    bpy.ops.ed.undo_push()
    yield 0.1
    bpy.ops.ed.undo()
    yield 0.1

def files():
    switch("RENDERED")
    yield 0.2
    bpy.ops.wm.open_mainfile(filepath=blend)
    yield 0.2

def addon():
    switch("RENDERED")
    yield 0.2
    addon_utils.disable("rayleaf")
    yield 0.2
    addon_utils.enable("rayleaf")
    prepared()
    yield 0.2

def renders():
    switch("RENDERED")
    yield 0.2
    bpy.ops.render.render("INVOKE_DEFAULT")
    yield 1.0

def steps():
    prepared()
    bpy.ops.wm.save_as_mainfile(filepath=blend)
    yield 0.5
    for name, count in counts.items():
        work = globals()[name]
        warm = max(count // 4, 1)  # what is allocated once is not counted
        for number in range(warm + count):
            if number == warm:
                switch("SOLID")
                yield 0.3
                memory[name] = [resident()]
            yield from work()
        switch("SOLID")
        yield 0.3
        memory[name].append(resident())
    threads = [thread.name for thread in threading.enumerate() if thread.name.startswith("rayleaf")]
    with open(report, "w") as file:
        json.dump({"memory": memory, "threads": threads}, file)

walk = steps()

def step():
    try:
        return next(walk)
    except StopIteration:
        switch("RENDERED")  # and closed while it renders
        bpy.app.timers.register(lambda: bpy.ops.wm.quit_blender() and None, first_interval=0.3, persistent=True)
    except BaseException:
        traceback.print_exc()
        os._exit(1)

bpy.app.timers.register(step, first_interval=1.0, persistent=True)
"""


def with_display(
    command: list[str], environment: dict[str, str], size: str = "640x480"
) -> subprocess.CompletedProcess[str]:
    """A command run in a display of its own."""
    wrapped = ["xvfb-run", "-a", "-s", f"-screen 0 {size}x24", *command]
    return subprocess.run(wrapped, env=environment, capture_output=True, text=True, timeout=SECONDS, check=False)


def used(counts: dict[str, int], folder: Path) -> dict[str, Any]:
    """What Blender reports of itself after all of it."""
    script, report = folder / "script.py", folder / "report.json"
    script.write_text(SCRIPT)
    scripts = str(Path(os.environ["RAYLEAF_PACKAGE_DIR"]).parent)
    environment = {**os.environ, "BLENDER_USER_SCRIPTS": scripts, "LIBGL_ALWAYS_SOFTWARE": "1"}
    options = [
        "--factory-startup",
        "--addons",
        "rayleaf",
        "--python",
        str(script),
        "--",
        json.dumps(counts),
        str(report),
    ]
    run = with_display([os.environ.get("BLENDER", "blender"), *options], environment)
    assert run.returncode == 0, run.stdout + run.stderr
    assert "Traceback" not in run.stdout + run.stderr, run.stdout + run.stderr
    result: dict[str, Any] = json.loads(report.read_text())
    return result


def run(quick: bool = False) -> list[dict[str, Any]]:
    """Prints memory before and after each, MB."""
    with tempfile.TemporaryDirectory() as folder:
        result = used(QUICK if quick else COUNTS, Path(folder))
    for name, (before, after) in result["memory"].items():
        print(f"  {name}: {before:.0f} MB before, {after:.0f} MB after")
    assert not result["threads"], result["threads"]
    for name, (before, after) in result["memory"].items():
        assert quick or after <= before * (1 + MOST_GROWTH), (name, before, after)
    return [{"name": name, "unit": "MB", "values": values} for name, values in result["memory"].items()]
