"""Denoising inside Blender: what is handed over with a library and without, in frames and views."""

import numpy as np
import plain_exr
import pytest
from blender_runner import is_module
from core.fake_denoiser import library

SCENE = """
import sys, bpy, scenes
from rayleaf import denoising
scene = scenes.empty_scene()
scenes.quad()
scene.world = bpy.data.worlds.new("World")
scene.camera.location = (0.5, 0.5, 3)
scene.render.resolution_x, scene.render.resolution_y, scene.render.film_transparent = 12, 8, True
scene.render.engine = "RAYLEAF"
scene.rayleaf.samples, scene.rayleaf.use_denoising = 4, True
scenes.write_layers()
scene.render.filepath = sys.argv[1]
denoising._library_paths = lambda: tuple(sys.argv[2:])
"""
RENDER = """
from rayleaf import statistics
bpy.ops.render.render(write_still=True)
report(texts=statistics.last("Scene")["messages"])
"""
FLAGS = {"RGB": 8, "RGB_ALBEDO": 8 + 1, "RGB_ALBEDO_NORMAL": 8 + 1 + 2}  # of the stand-in for the library


def in_front(path):
    """Blender's own library is taken where the process has it already: there the stand-in comes before it."""
    return {"LD_PRELOAD": path} if is_module() else {}


def layers(path):
    channels = plain_exr.read(path)
    names = {name.split(".")[1] for name in channels}
    return names, {
        name: np.stack([channels[f"ViewLayer.{name}.{letter}"] for letter in "RGBA"], -1)
        for name in ("Combined", "Noisy Image")
    }


@pytest.mark.parametrize("passes", FLAGS)
def test_a_finished_frame_is_denoised_and_keeps_its_alpha_and_its_noise_elsewhere(run_blender, tmp_path, passes):
    path = tmp_path / "picture.exr"
    lines = f"scene.rayleaf.denoising_input_passes, scene.rayleaf.denoising_prefilter = {passes!r}, 'FAST'\n"
    run = run_blender(SCENE + lines + RENDER, path, library(), env=in_front(library()))
    names, found = layers(path)
    assert names == {"Combined", "Noisy Image"}  # what guides stays inside
    noisy, combined = found["Noisy Image"], found["Combined"]
    assert np.array_equal(noisy[..., 3], combined[..., 3]) and 0 < noisy[..., 3].mean() < 1
    assert combined[0, 0, 0] == pytest.approx(noisy[..., :3].mean() + FLAGS[passes], abs=1e-3)
    assert run.report["texts"] == []


def test_without_a_library_the_picture_keeps_its_noise_and_a_message_says_where_to_get_one(run_blender, tmp_path):
    path = tmp_path / "picture.exr"
    broken = library(2, no_device=1)
    run = run_blender(SCENE + RENDER, path, broken, env=in_front(broken))
    _, found = layers(path)
    assert np.array_equal(found["Combined"], found["Noisy Image"]) and found["Combined"].any()
    (text,) = run.report["texts"]
    assert "Scene 'Scene'" in text and "unsupported hardware" in text and "keeps its noise" in text


def test_off_nothing_of_it_is_loaded_or_rendered(run_blender, tmp_path):
    path = tmp_path / "picture.exr"
    run = run_blender(SCENE + "scene.rayleaf.use_denoising = False\n" + RENDER, path, tmp_path / "nothing.so")
    assert {name.split(".")[1] for name in plain_exr.read(path)} == {"Combined"}
    assert run.report["texts"] == []
