"""Distribution ray tracing and ambient occlusion through Blender: the settings arrive, and Cycles sees the same occlusion."""

import numpy as np
import plain_exr
import pytest

SETUP = """
import sys, bpy, numpy as np, scenes
scene = scenes.empty_scene()
render, own = scene.render, scene.rayleaf
render.resolution_x = render.resolution_y = 16
render.resolution_percentage = 100
scenes.write_layers()
scene.camera.location = (0, 0, 5)
scene.world = bpy.data.worlds.new("World")
scene.world.color = (0.5, 0.6, 0.7)
scenes.mesh([(-9, -9, 0), (9, -9, 0), (9, 9, 0), (-9, 9, 0)], [(0, 1, 2, 3)], "Floor")
wall = scenes.mesh([(0.2, -9, 0), (0.2, 9, 0), (0.2, 9, 1.5), (0.2, -9, 1.5)], [(0, 1, 2, 3)], "Wall")
scene.view_layers[0].use_pass_ambient_occlusion = True
"""


@pytest.mark.parametrize("distance", [0.5, 10.0])
def test_cycles_sees_the_same_ambient_occlusion(run_blender, tmp_path, distance):
    script = f"""
own.occlusion_distance = scene.world.light_settings.distance = {distance}
own.samples = scene.cycles.samples = 256
scene.cycles.use_denoising = scene.cycles.use_adaptive_sampling = False
scene.cycles.pixel_filter_type = own.filter_type = "BOX"
scene.cycles.filter_width = own.filter_width = 1.0
for engine in ("RAYLEAF", "CYCLES"):
    render.engine = engine
    render.filepath = sys.argv[1] + engine + ".exr"
    bpy.ops.render.render(write_still=True)
"""
    run_blender(SETUP + script, f"{tmp_path}/")
    pictures = [plain_exr.read(tmp_path / f"{engine}.exr")["ViewLayer.AO.R"] for engine in ("RAYLEAF", "CYCLES")]
    assert pictures[0].min() < 0.8 and pictures[0].max() > 0.9
    # 256 rays a pixel; single pixels differ by their noise, at most 1/32 at one standard deviation.
    assert np.abs(pictures[0] - pictures[1]).max() < 0.12
    assert pictures[0].mean() == pytest.approx(pictures[1].mean(), abs=0.005)


def test_the_panels_settings_reach_the_core(run_blender, tmp_path):
    script = """
import rayleaf
own.integrator, own.samples = "DISTRIBUTION", 2
own.hemisphere_rays, own.light_rays, own.glossy_rays = 8, 3, 5
scenes.add(bpy.data.lights.new("Lamp", "POINT")).location = (-1, 0, 2)
render.filepath = sys.argv[1]
found = {}
for indirect in ("NONE", "AMBIENT_OCCLUSION", "COLOR_BLEEDING"):
    own.indirect = indirect
    bpy.ops.render.render(write_still=True)
    found[indirect] = rayleaf.last_statistics["core"]["rays"]
report(rays=found)
"""
    rays = run_blender(SETUP + script, tmp_path / "picture.exr").report["rays"]
    camera = 16 * 16 * 2
    for indirect, counts in rays.items():
        assert counts["camera"] == camera and "glossy" not in counts, indirect
        assert counts["occlusion"] <= camera * 8
        assert counts["shadow"] > 0
    assert 0.9 * camera * 8 < rays["AMBIENT_OCCLUSION"]["hemisphere"] <= camera * 8
    assert rays["COLOR_BLEEDING"]["indirect"] > 0 and "indirect" not in rays["AMBIENT_OCCLUSION"]


def test_the_irradiance_cache_is_used_and_its_hemispheres_are_counted(run_blender, tmp_path):
    script = """
import rayleaf
own.integrator, own.samples, own.hemisphere_rays = "DISTRIBUTION", 2, 8
render.filepath = sys.argv[1]
found = []
for own.use_irradiance_cache, own.irradiance_error in ((False, 0.2), (True, 0.2), (True, 0.02)):
    bpy.ops.render.render(write_still=True)
    found.append(rayleaf.last_statistics["core"]["hemispheres"])
report(found=found)
"""
    none, coarse, fine = run_blender(SETUP + script, tmp_path / "picture.exr").report["found"]
    assert none["records"] == none["interpolated"] == 0 < none["sampled"]
    assert 0 < coarse["records"] < fine["records"]
    assert coarse["interpolated"] > 10 * coarse["sampled"]
