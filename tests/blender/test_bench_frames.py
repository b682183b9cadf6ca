"""The benchmark of whole frames beside Cycles, on a stamp of a picture."""

import json
import os
import subprocess
import sys

import numpy as np
import pytest


@pytest.fixture(scope="module")
def run(root, addons, tmp_path_factory):
    """`rayleaf bench frames WORDS`, after everything is built: what it printed, and its rows."""
    folder = tmp_path_factory.mktemp("frames")

    def run_with(*words, check=True):
        script, out = root / "tests" / "bench" / "run_benchmarks.py", folder / "rows.json"
        environment = {**os.environ, "RAYLEAF_PACKAGE_DIR": str(addons), "BLENDER_USER_SCRIPTS": str(addons.parent)}
        command = [sys.executable, str(script), "frames", *words, "--json", str(out), "-o", str(folder)]
        done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
        assert not check or done.returncode == 0, done.stdout + done.stderr
        return done.stdout, json.loads(out.read_text())["cases"]["frames"] if check else done.stderr

    run_with.folder = folder
    return run_with


@pytest.mark.slow
def test_the_table_has_every_engine_and_mode_and_equal_settings_were_used(run):
    printed, rows = run("bezier_sheet", *("--samples", "2", "--percentage", "4", "--threads", "1", "--rounds", "2"))
    head = next(line for line in printed.splitlines() if line.startswith("scene"))
    for name in (
        "samples",
        "first, s",
        "second, s",
        "first, ratio",
        "second, ratio",
        "error",
        "equal error",
        "from Cycles",
        "MB",
    ):
        assert name in head
    names = ["Cycles", "Rayleaf, off", "Rayleaf, auto", "Rayleaf, on"]
    assert [row["contender"] for row in rows] == names
    lines = [line.split("  ") for line in printed.splitlines() if line.startswith("bezier_sheet ")]
    shown = [[cell.strip() for cell in line if cell.strip()] for line in lines]
    assert [(cells[1], cells[2]) for cells in shown] == [("2", name) for name in names]
    assert ["–" in cells for cells in shown] == [True, False, False, False], printed
    assert all(row["problem"] == "" and row["size"] == [32, 18] for row in rows)
    assert all(len(row["first"]) == len(row["second"]) == 2 and min(row["first"] + row["second"]) > 0 for row in rows)
    assert all(row["from_cycles"] < 0.3 for row in rows[1:])
    assert all(0 < row["rmse"] < 0.3 and row["memory_mb"] > 0 for row in rows)
    for name, value in (("samples", 2), ("threads", 1), ("persistent data", False)):
        assert {row["told"][name] for row in rows} == {value}
    cycles, *own = (row["told"] for row in rows)
    assert (cycles["use_adaptive_sampling"], cycles["use_denoising"], cycles["device"]) == (False, False, "CPU")
    assert [told["interpolation"] for told in own] == ["OFF", "AUTO", "ON"]


@pytest.mark.slow
def test_in_an_orbit_the_camera_turns_and_the_last_frame_is_judged(run):
    words = ("bezier_sheet", "--samples", "4", "--percentage", "4", "--interpolation", "off")
    printed, rows = run(*words, "--orbit", "31")
    assert "frame 31" in printed and all(row["problem"] == "" for row in rows)
    assert all(len(row["first"]) == len(row["second"]) == 1 and row["rmse"] < 0.2 for row in rows), rows
    _, still = run(*words)
    # Thirty degrees on both engines see another side; they still see the same.
    assert rows[1]["from_cycles"] < 0.2 and still[1]["from_cycles"] < 0.2
    pictures = [np.load(path)[..., :3] for path in sorted(run.folder.glob("converged/bezier_sheet_rayleaf_16_*.npy"))]
    assert len(pictures) == 2 and np.abs(np.clip(pictures[0], 0, 1) - np.clip(pictures[1], 0, 1)).mean() > 0.1


def test_a_scene_that_is_not_there_is_answered_with_those_that_are(run):
    _, complaint = run("bezier_shet", check=False)
    assert "there is no scene bezier_shet" in complaint and "bezier_sheet" in complaint


@pytest.mark.parametrize(
    "words", [("--samples", "0"), ("--threads", "-1"), ("--orbit", "1"), ("--interpolation", "much"), ("--turbo",)]
)
def test_options_that_mean_nothing_are_refused(run, words):
    _, complaint = run("bezier_sheet", *words, check=False)
    assert words[0] in complaint and "usage: rayleaf bench frames" in complaint
