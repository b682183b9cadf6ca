"""Whatever goes wrong in a render ends in Blender's report, and the next render works."""

import plain_exr
import pytest

SCENE = """
import sys
import bpy, scenes, rayleaf
scene = scenes.empty_scene()
render = scene.render
render.resolution_x, render.resolution_y, render.resolution_percentage = 16, 16, 100
render.image_settings.file_format = "OPEN_EXR"
render.image_settings.color_depth, render.image_settings.exr_codec = "32", "NONE"
scene.camera.location = (0.5, 0.5, 5)
scene.rayleaf.samples = 1
scenes.quad()

def failed():
    "What Blender says of a render that fails."
    try:
        bpy.ops.render.render()
        return ""
    except RuntimeError as error:
        return str(error)
"""

BROKEN = """
import recording_core
core = recording_core.install()

def broken(error):
    def fail(*arguments, **more):
        raise error
    return fail

cases = dict(
    session=(core.Session, "__init__", MemoryError("std::bad_alloc")),
    render=(core.Session, "render", RuntimeError("Embree: out of memory")),
    pixels=(core.Session, "pass_pixels", ValueError("no such pass")),
    statistics=(core.Session, "statistics", KeyError("geometry_cache")),
    settings=(core.Settings, "__init__", TypeError("seed")),
    export=(core.SceneDescription, "add_mesh", AttributeError("co")),
    camera=(core.SceneDescription, "set_camera", ZeroDivisionError("division by zero")),
    store=(core.RayCacheStore, "__init__", OverflowError("too large")),
    odd=(core.Session, "render", RuntimeError("a path \\udce4")),
)
for name, (owner, method, error) in cases.items():
    whole = getattr(owner, method)
    setattr(owner, method, broken(error))
    told = failed()
    setattr(owner, method, whole)
    report(**{name: [told, failed()]})
"""


def test_every_failure_of_the_core_is_reported_and_the_next_render_works(run_blender):
    run = run_blender(SCENE + BROKEN)
    words = dict(
        session="Out of memory: std::bad_alloc",
        render="RuntimeError: Embree: out of memory",
        pixels="ValueError: no such pass",
        statistics="KeyError: 'geometry_cache'",
        settings="TypeError: seed",
        export="AttributeError: co",
        camera="ZeroDivisionError: division by zero",
        store="OverflowError: too large",
        odd="RuntimeError: a path \\udce4",
    )
    for name, text in words.items():
        told, after = run.report[name]
        assert text in told, (name, told)
        assert after == "", (name, after)
    assert run.log.count("Traceback") >= len(words)  # the console says where


def test_a_core_that_cannot_be_loaded_says_why_every_time(run_blender):
    run = run_blender(
        SCENE
        + """
hidden = {name: sys.modules.pop(name) for name in list(sys.modules) if name == "numpy" or name.startswith("numpy.")}
sys.modules["numpy"] = None
report(told=[failed(), failed()])
del sys.modules["numpy"]
sys.modules.update(hidden)
report(after=failed())
"""
    ).report
    assert len(run["told"]) == 2
    assert all("Install" in text and "NumPy" in text for text in run["told"]), run["told"]
    assert run["after"] == ""


@pytest.mark.parametrize("frame, seed", [(-3, 0), (-1_000_000, 5), (1_000_000, 2**31 - 1)])
def test_an_animated_seed_is_a_number_at_every_frame(run_blender, tmp_path, frame, seed):
    path = tmp_path / "picture.exr"
    run = run_blender(
        SCENE
        + f"""
scene.rayleaf.seed, scene.rayleaf.use_animated_seed, scene.frame_start = {seed}, True, -1_000_000
scene.frame_set({frame})
render.filepath = sys.argv[1]
bpy.ops.render.render(write_still=True)
report(frame=scene.frame_current)
""",
        path,
    )
    assert run.report["frame"] == frame
    assert plain_exr.read(path)["A"].max() == 1


def test_renders_of_every_kind_of_object_leave_nothing_behind(run_blender):
    """When it ends, Blender says what was never freed."""
    run = run_blender(
        SCENE
        + """
scenes.surface("Surface")
bpy.ops.curve.primitive_bezier_circle_add()
bpy.context.object.data.bevel_depth = 0.1
bpy.ops.object.text_add()
bpy.context.object.data.extrude = 0.1
bpy.ops.object.metaball_add()
fine = scenes.quad("Fine")
fine.modifiers.new("Subdivision", "SUBSURF")
hairy = scenes.quad("Hairy")
hairy.modifiers.new("Particles", "PARTICLE_SYSTEM")
hairy.particle_systems[0].settings.type, hairy.particle_systems[0].settings.count = "HAIR", 3
displaced = scenes.quad("Displaced")
material, tree, output = scenes.material()
tree.links.new(tree.nodes.new("ShaderNodeDisplacement").outputs[0], output.inputs["Displacement"])
scenes.set_displacement(material, "DISPLACEMENT")
displaced.data.materials.append(material)
scenes.add(bpy.data.lights.new("Lamp", "AREA"), "Lamp")
report(told=[failed(), failed()])
"""
    )
    assert run.report["told"] == ["", ""]
    assert "Not freed memory blocks" not in run.log, run.log
