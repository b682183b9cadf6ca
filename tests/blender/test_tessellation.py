"""The geometry cache through Blender: its settings reach the core, its passes and statistics come back."""

import numpy as np
import plain_exr

SETUP = """
import sys, bpy, rayleaf, scenes
scene = bpy.context.scene
scene.render.engine = "RAYLEAF"
scene.render.resolution_x = scene.render.resolution_y = 32
scene.render.resolution_percentage = 100
own = scene.rayleaf
own.samples = 2
if bpy.app.version >= (5, 0):  # prints statistics with --log-level info alone
    bpy.app.handlers.render_stats.append(lambda text, _: print(text))
scenes.write_layers()
own.facet_memory = 0  # all facets go through the cache
scene.render.filepath = sys.argv[1]
bpy.data.objects.remove(bpy.data.objects["Cube"])
bpy.ops.surface.primitive_nurbs_surface_sphere_add(radius=2.0)
def cache():
    bpy.ops.render.render(write_still=True)
    return rayleaf.last_statistics["core"]["geometry_cache"]
"""


def test_level_and_cache_misses_come_back_from_a_render(run_blender, tmp_path):
    script = """
passes = bpy.context.view_layer.rayleaf
passes.use_pass_level = passes.use_pass_cache_misses = True
report(cache=cache())
"""
    path = tmp_path / "levels.exr"
    counters = run_blender(SETUP + script, path).report["cache"]
    picture = plain_exr.read(path)
    level, misses = (picture[f"ViewLayer.Rayleaf {name}.X"] for name in ("Level", "Cache Misses"))
    assert {0} < set(np.unique(level)) <= {0, 1, 2, 3, 4, 5, 6}
    diced = counters["parts"]["diced"] + sum(each["diced"] for each in counters["levels"].values())
    assert 2 * misses.sum() == diced > 0


def test_a_render_prints_what_the_cache_did_at_each_level(run_blender, tmp_path):
    result = run_blender(SETUP + "report(core=[cache(), rayleaf.last_statistics['core']['rays']])", tmp_path / "a.exr")
    (cache, rays), printed = result.report["core"], result.log
    for name, level in (cache["levels"] | {"parts": cache["parts"]}).items():
        line = next((line for line in printed.splitlines() if f"| {name}: " in line), "")
        for key in ("cold", "lookups", "misses", "vertices_recomputed", "bypassed"):
            assert f"{level[key]:,}" in line, (name, key, line)
        assert f"{level['hit_rate']:.2%} hits" in line and " MB" in line
    assert f"{cache['splits']:,} splits" in printed and f"Rays: {rays['paths']:,} paths" in printed


def test_the_panels_settings_change_what_is_kept_and_not_the_picture(run_blender, tmp_path):
    script = """
found = {}
def rendered(name):
    scene.render.filepath = sys.argv[1] + name + ".exr"
    found[name] = cache()
rendered("default")
own.geometry_cache_size = 0.0
rendered("nothing")
own.geometry_cache_mode = "NONE"
rendered("none")
own.geometry_cache_mode, own.geometry_cache_size = "SINGLE", 2.0
rendered("single")
own.geometry_cache_mode, own.geometry_cache_size = "MULTI", 30.0
own.tessellation_factor = 8.0
rendered("coarse")
own.tessellation_factor = 1.0
own.use_stochastic_levels = own.use_importance_levels = True
own.least_mirrored_spread = 0.1
rendered("switches")
report(found=found)
"""
    found = run_blender(SETUP + script, f"{tmp_path}/").report["found"]
    levels = {name: {level: each["lookups"] for level, each in of["levels"].items()} for name, of in found.items()}
    assert [found[name]["budget"] for name in ("default", "nothing", "single")] == [30 << 20, 0, 2 << 20]
    assert levels["default"] == levels["nothing"] == levels["none"] != levels["switches"]
    assert levels["single"]["coarse"] == levels["single"]["medium"] == 0 < levels["single"]["fine"]
    assert levels["coarse"]["coarse"] > levels["default"]["coarse"]
    pictures = [
        plain_exr.read(tmp_path / f"{name}.exr")["ViewLayer.Combined.R"] for name in ("default", "nothing", "none")
    ]
    assert (pictures[0] == pictures[1]).all() and (pictures[0] == pictures[2]).all()


def test_what_fits_stays_in_memory_by_default_and_the_render_says_so(run_blender, tmp_path):
    script = """
own.facet_memory = -1
report(core=[cache()["bytes"], rayleaf.last_statistics["core"]["memory"]["facets"]])
"""
    result = run_blender(SETUP + script, tmp_path / "resident.exr")
    cached, facets = result.report["core"]
    assert cached == 0 < facets
    assert f"Facets in memory: {facets / 1e6:.1f} MB" in result.log
