"""Ray interpolation as artists set it reaches the core, and what cannot be is told."""

import pytest

SETUP = """
import bpy, recording_core
core = recording_core.install()
scene = bpy.context.scene
scene.render.engine = "RAYLEAF"
scene.render.resolution_x = scene.render.resolution_y = 8
rays = scene.rayleaf.ray_interpolation
cube = bpy.data.objects["Cube"]
own = cube.rayleaf.ray_interpolation
"""
RENDER = """
bpy.ops.render.render()
session = core.Session.last
sent = [values.values for _, values in session.scene.ray_interpolations]
instances = session.scene.instances
report(scene=session.settings.ray_interpolation.values, sent=sent, used=instances["ray_interpolations"],
       names=[name for name, _ in session.scene.ray_interpolations])
"""


def test_interpolation_is_off_unless_asked_for(run_blender):
    run = run_blender(SETUP + RENDER).report
    assert run["scene"]["mode"] == "OFF" and run["scene"]["error"] == 0.005
    assert run["sent"] == [] and set(run["used"]) == {-1}


def test_the_panel_of_the_scene_reaches_the_core(run_blender):
    run = run_blender(SETUP + "rays.mode, rays.error = 'AUTO', 0.01" + RENDER).report
    assert run["scene"] == {"mode": "AUTO", "error": 0.01, "cache_bytes": None}
    advanced = (
        "rays.mode, rays.use_advanced, rays.distance, rays.angle, rays.depth, rays.cache_size, rays.rays_per_cell = "
    )
    run = run_blender(SETUP + advanced + "'ON', True, 0.02, 0.25, 24, 2.0, 1.5" + RENDER).report
    assert run["scene"]["mode"] == "ON"
    assert run["scene"]["distance_threshold"] == 0.02 and run["scene"]["angle_threshold"] == pytest.approx(0.25)
    assert run["scene"]["depth_limit"] == 24 and run["scene"]["cache_bytes"] == 2_000_000
    assert run["scene"]["rays_per_cell"] == 1.5


def test_an_object_overrides_the_mode_and_keeps_the_scenes_thresholds(run_blender):
    run = run_blender(SETUP + "rays.error = 0.02; own.mode = 'ON'" + RENDER).report
    assert run["scene"]["mode"] == "OFF"
    assert run["names"] == ["Cube"] and run["used"].count(0) == 1
    assert run["sent"][0] == {"mode": "ON", "error": 0.02, "cache_bytes": None}


def test_an_object_may_have_thresholds_of_its_own(run_blender):
    run = run_blender(SETUP + "rays.mode = 'AUTO'; own.use_own_error, own.error = True, 0.001" + RENDER).report
    assert run["sent"] == [{"mode": "AUTO", "error": 0.001, "cache_bytes": None}]


def test_a_material_becomes_a_volume_at_one_switch(run_blender):
    script = """
material = cube.active_material
material.rayleaf.use_volume = True
material.rayleaf.volume_kind, material.rayleaf.volume_density = "ABSORPTION", 2.5
material.rayleaf.volume_color = (1.0, 0.5, 0.25)
bpy.ops.render.render()
report(materials=[[m["name"], m["volume"].values if m["volume"] else None] for m in core.Session.last.scene.materials])
"""
    run = run_blender(SETUP + script).report
    assert ["Material", {"kind": "ABSORPTION", "density": 2.5, "color": [1.0, 0.5, 0.25]}] in run["materials"]


def test_every_setting_has_a_place_in_a_panel(run_blender):
    script = """
import bpy
from rayleaf import ui_rays

class Layout:
    shown = set()
    def __getattr__(self, name):
        return lambda *arguments, **more: self
    def prop(self, owner, name, **more):
        Layout.shown.add((type(owner).__name__, name))

class Context:
    pass

context = Context()
context.scene, context.object, context.material = scene, cube, cube.active_material
context.world = scene.world
for each in (rays, own):
    each.use_advanced = True
own.use_own_error = True
for panel in ui_rays.PANELS:
    own_names = {name: each for name, each in vars(panel).items() if not name.startswith("__")}
    shown = type("Shown", (), own_names | {"layout": Layout(), "_column": lambda self: Layout()})()
    shown.draw(context)
    if hasattr(shown, "draw_header"):
        shown.draw_header(context)
owners = [rays, own, context.material.rayleaf]
report(missing=[[type(o).__name__, p.identifier] for o in owners for p in o.bl_rna.properties
                if p.identifier not in ("rna_type", "name") and (type(o).__name__, p.identifier) not in Layout.shown])
"""
    assert run_blender(SETUP + script).report["missing"] == []


def test_ticking_advanced_changes_nothing(run_blender):
    script = """
import bpy
from rayleaf import core_module
from rayleaf.export import ray_interpolation as export
core = core_module.load()
names = ("distance_threshold", "angle_threshold", "depth_limit", "cache_bytes", "rays_per_cell")
rays = bpy.context.scene.rayleaf.ray_interpolation
found = []
for tolerance in (0.005, 0.0007, 0.03, 0.5):
    rays.use_advanced = False
    rays.error = tolerance
    before = export.of_scene(core, rays)
    rays.use_advanced = True
    after = export.of_scene(core, rays)
    found.append([[getattr(each, name) for name in names] for each in (before, after)])
report(found=found)
"""
    for before, after in run_blender(script).report["found"]:
        assert after == pytest.approx(before, rel=1e-6)
