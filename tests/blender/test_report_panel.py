"""The button that sweeps settings over the open scene, and the page of `rayleaf report`."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from test_window import TOOLS, window  # noqa: F401: a fixture

MEASURE = """
import bpy

scene = bpy.context.scene
scene.render.engine = "RAYLEAF"
scene.render.resolution_x, scene.render.resolution_y = 32, 24
bpy.ops.rayleaf.measure_settings(width=16)
measurement = bpy.context.window_manager.rayleaf_measurement
found = [(each.name, each.seconds, each.error) for each in measurement.settings]
measurement.wanted_error = 1.0
bpy.ops.rayleaf.apply_measured()
fastest = (found[0][0], scene.rayleaf.samples, scene.rayleaf.ray_interpolation.mode)
measurement.wanted_error = 0.0001
report(found=found, fastest=fastest, none=bpy.ops.rayleaf.apply_measured.poll(), state=measurement.state)
"""


def test_the_button_lists_error_and_time_and_apply_sets_the_fastest_within_the_wish(run_blender):
    run = run_blender(MEASURE)
    found = run.report["found"]
    by_name = {name: error for name, _, error in found}
    assert [seconds for _, seconds, _ in found] == sorted(seconds for _, seconds, _ in found)
    assert by_name["Samples: 64 samples"] < by_name["Samples: 1 sample"]
    assert any("interpolation" in name for name in by_name)
    name, samples, mode = run.report["fastest"]
    assert f"{samples} sample" in name and (mode == "OFF" or "interpolation" in name)
    assert not run.report["none"], "nothing is closer than the noise of the reference, so nothing can be applied"
    assert run.report["state"] == f"{len(found)} settings measured"


QUIT = """
from rayleaf.report import panel

made = []

class Noted(panel._Run):
    def __init__(self, width):
        super().__init__(width)
        made.append(self)

panel._Run = Noted

def steps():
    yield 0.5
    with bpy.context.temp_override(window=bpy.context.window_manager.windows[0]):
        bpy.ops.rayleaf.measure_settings("INVOKE_DEFAULT")
    yield 0.5
    report(folder=made[0]._folder.name, process=made[0]._process.pid, running=made[0].is_running(),
           again=bpy.ops.rayleaf.measure_settings.poll())
    bpy.ops.wm.quit_blender()
    yield 20

drive(steps())
"""


@pytest.mark.skipif(bool(TOOLS), reason=f"not installed: {', '.join(TOOLS)}")
def test_blenders_end_stops_a_measurement_and_only_one_runs(window):  # noqa: F811
    run = window(QUIT, size="640x480").report
    assert run["running"] and not run["again"]
    assert not Path(run["folder"]).exists() and not Path(f"/proc/{run['process']}").exists()


MAKE = """
import bpy, sys
bpy.context.scene.render.resolution_x, bpy.context.scene.render.resolution_y = 32, 24
bpy.ops.curve.primitive_bezier_circle_add(radius=2.0)
bpy.context.object.data.bevel_depth = 0.2
bpy.ops.wm.save_as_mainfile(filepath=sys.argv[1])
"""


def test_the_report_of_a_file_holds_its_tables_plots_and_pictures(run_blender, addons, tmp_path):
    file, folder = tmp_path / "cube.blend", tmp_path / "report"
    run_blender(MAKE, file)
    root = Path(__file__).resolve().parents[2]
    environment = os.environ | {"PYTHONPATH": str(addons), "BLENDER_USER_SCRIPTS": str(addons.parent)}
    blender = os.environ.get("BLENDER") or "/usr/bin/blender"
    command = [sys.executable, "-m", "rayleaf.report.run_report", str(file), "--quick", "-o", str(folder)]
    command += ["--root", str(root), "--blender", blender]
    done = subprocess.run(command, capture_output=True, text=True, env=environment, check=False, timeout=300)
    assert done.returncode == 0, done.stdout + done.stderr
    figures = json.loads((folder / "report.json").read_text())
    rows = figures["scenes"]["cube"]
    assert {row["engine"] for row in rows} == {"RAYLEAF", "CYCLES"}
    assert all(row["seconds"] > 0 and 0 <= row["rmse"] <= 1 for row in rows)
    swept = {row["series"] for row in rows}
    assert "Primitive of bevelled curves" in swept and "Primitive of strands" not in swept
    text = (folder / "report.html").read_text()
    assert text.count("<svg") >= 1 and text.count("data:image/png") >= 6
    frames = figures["frames"]["cube"]
    assert [frame["contender"] for frame in frames] == ["Cycles", "Rayleaf, off", "Rayleaf, auto", "Rayleaf, on"]
    assert all(frame["problem"] == "" and frame["rmse"] >= 0 for frame in frames)
    assert text.index("Whole frames beside Cycles") < text.index("Samples: 1 sample")
    assert "Not in this version" not in text, "a setting is tried that the add-on does not have"
    assert (folder / "frontier.csv").read_text().count("\n") == len(rows) + 1
