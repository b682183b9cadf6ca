"""What a scene does not need costs no byte and no call: by the core's own counters, and by looking at every call it makes."""

import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import scenes
import strand_shapes
import subdivision_cages as cages
import swept_support
from path_scenes import material

CORE = Path(__file__).parents[2] / "core"

UNNEEDED = {
    "texture system",
    "light linking",
    "ray caches",
    "irradiance cache",
    "tessellation",
    "volume visualisation",
    "shadow catchers",
    "target error",
    "spline surfaces",
    "strands",
    "bevelled curves",
    "subdivision surfaces",
    "displaced surfaces",
}


def diffuse_scene(core):
    """A diffuse quad under a lamp."""
    scene = core.SceneDescription()
    scene.add_instance("floor", scenes.quad(scene, "floor"), scenes.matrix(), scenes_material(core, scene))
    scene.add_lamp("lamp", "POINT", scenes.matrix((0, 0, 3)), (100,) * 3, radius=0.1)
    scenes.look_down(scene)
    return scene


def scenes_material(core, scene):
    return material(core, scene, ("diffuse", 1.0, 0.5))


def statistics_of(core, scene, **settings):
    session = core.Session(scene, core.Settings(**{"width": 8, "height": 8, "samples": 1, **settings}))
    session.render()
    return session.statistics()


def left_out(statistics):
    """Without passes, which have a test of their own."""
    return {name for name in statistics["left_out"] if not name.startswith("pass ")}


def add_spline_surface(core, scene):
    surface = scene.add_surface("ball", [scenes.sphere_spline(core)])
    scene.add_instance("ball", surface, scenes.matrix(), scenes_material(core, scene))


def add_bevelled_curve(core, scene):
    curve = swept_support.curve("POLY", [[-1, 0, 1], [1, 0, 1]], bevel_depth=0.1)
    scene.add_instance("wire", scene.add_curve(curve), scenes.matrix(), scenes_material(core, scene))


def add_strand(core, scene):
    hair = strand_shapes.strand([[-1, 0, 1], [0, 0.1, 1], [1, 0, 1]], 0.1)
    scene.add_instance("hair", scene.add_shape(hair), scenes.matrix(), scenes_material(core, scene))


def add_subdivision_surface(core, scene):
    body = cages.cube().surface()
    scene.add_instance("body", scene.add_shape(body), scenes.matrix(), scenes_material(core, scene))


def add_texture(core, scene):
    image = scene.add_image_pixels("image", np.ones((2, 2, 3), np.float32), "LINEAR")
    program = core.Program("textured")
    color = program.operation("image", [program.operation("uv", [], [-1])], [image, 0, 0])
    program.operation("diffuse", [program.constant(1, 1, 1, 1), color])
    textured = scene.add_material_list([scene.add_material("textured", program)])
    scene.add_instance("picture", scenes.quad(scene, "picture"), scenes.matrix((0, 0, 1)), textured)


def add_volume(core, scene):
    mist = core.VolumeVisualisation(kind="EMISSION", density=1.0, color=(1, 1, 1))
    shown = scene.add_material_list([scene.add_material("mist", None, volume=mist)])
    cube = scene.add_mesh("cube", scenes.CUBE_VERTICES, scenes.CUBE_TRIANGLES)
    scene.add_instance("mist", cube, scenes.matrix((0, 0, 1)), shown)


def displacement(core):
    program = core.Program("displacement")
    return program, program.constant(0, 0, 0.25, 1)


def add_displaced_material(core, scene):
    moved = scene.add_material("moved", scenes.diffuse(core), displacement=(*displacement(core), -1))
    surface = scene.add_surface("ball", [scenes.sphere_spline(core)])
    scene.add_instance("ball", surface, scenes.matrix(), scene.add_material_list([moved]))


def add_displaced_shape(core, scene):
    program, up = displacement(core)
    shape = scene.add_shape(core.displaced(cages.cube().surface(), program, object=up))
    scene.add_instance("cube", shape, scenes.matrix(), scenes_material(core, scene))


def add_linked_lamp(core, scene):
    scene.add_lamp("linked", "POINT", scenes.matrix((0, 0, 3)), (1, 1, 1), link=(0, -1))


# What is added -> what is no longer left out.
ADDED = {
    add_spline_surface: {"spline surfaces", "tessellation"},
    add_bevelled_curve: {"bevelled curves", "tessellation"},
    add_strand: {"strands"},
    add_subdivision_surface: {"subdivision surfaces", "tessellation"},
    add_texture: {"texture system"},
    add_volume: {"volume visualisation"},
    add_displaced_material: {"spline surfaces", "displaced surfaces", "tessellation"},
    add_displaced_shape: {"displaced surfaces", "tessellation"},
    add_linked_lamp: {"light linking"},
}


def test_a_scene_of_diffuse_meshes_leaves_everything_else_out(core):
    statistics = statistics_of(core, diffuse_scene(core))
    assert left_out(statistics) == UNNEEDED
    memory = statistics["memory"]
    assert [memory[name] for name in ("grids", "subpatches", "irradiance", "textures")] == [0, 0, 0, 0]
    assert list(statistics["shape_bytes"]) == ["triangles"]
    assert statistics["shape_bytes"]["triangles"] == memory["shapes"]
    cache = statistics["geometry_cache"]
    assert cache["bytes"] == 0 and all(level["lookups"] == 0 for level in cache["levels"].values())
    assert statistics["ray_caches"] == [] and statistics["hemispheres"]["records"] == 0


@pytest.mark.parametrize("add", ADDED, ids=lambda add: add.__name__)
def test_what_is_added_brings_its_own_subsystem_and_no_other(core, add):
    scene = diffuse_scene(core)
    add(core, scene)
    statistics = statistics_of(core, scene)
    assert UNNEEDED - left_out(statistics) == ADDED[add]
    assert (statistics["memory"]["facets"] > 0) == ("tessellation" in ADDED[add])


def test_a_scene_without_lamps_samples_none(core):
    scene = core.SceneDescription()
    scene.add_instance("floor", scenes.quad(scene, "floor"), scenes.matrix())
    scenes.look_down(scene)
    statistics = statistics_of(core, scene)
    assert "light sampling" in statistics["left_out"] and statistics["lights"] == 0
    # An empty set's own few hundred bytes, and no table and no tree.
    assert statistics["memory"]["lights"] < statistics_of(core, diffuse_scene(core))["memory"]["lights"]
    assert statistics["memory"]["lights"] <= 768


def test_ray_caches_are_there_only_for_what_they_can_answer(core):
    scene = diffuse_scene(core)
    add_spline_surface(core, scene)
    off = statistics_of(core, scene, ray_interpolation=core.RayInterpolation("OFF"))
    assert "ray caches" in left_out(off) and off["ray_caches"] == []
    mirror = material(core, scene, ("glossy", 1.0, 1.0, 0.0, "SHARP"))
    surface = scene.add_surface("mirror", [scenes.sphere_spline(core)])
    scene.add_instance("mirror", surface, scenes.matrix((0, 0, 1)), mirror)
    on = statistics_of(core, scene, ray_interpolation=core.RayInterpolation("ON"))
    assert "ray caches" not in left_out(on) and any(cache["used"] for cache in on["ray_caches"])


def test_an_irradiance_cache_is_there_only_for_distribution_ray_tracing_that_wants_it(core):
    def settings(**more):
        return {"integrator": "DISTRIBUTION", "indirect": "AMBIENT_OCCLUSION", "hemisphere_rays": 4, **more}

    scene = diffuse_scene(core)
    scene.set_world(scenes.background(core))
    assert "irradiance cache" in left_out(statistics_of(core, scene, **settings()))
    assert "irradiance cache" in left_out(statistics_of(core, scene, irradiance_cache=True))
    cached = statistics_of(core, scene, **settings(irradiance_cache=True))
    assert "irradiance cache" not in left_out(cached) and cached["memory"]["irradiance"] > 0


def test_the_film_grows_by_the_passes_that_are_on(core):
    sizes = {}
    for passes in (["combined"], ["combined", "depth"], ["combined", "depth", "normal"]):
        statistics = statistics_of(core, diffuse_scene(core), passes=passes)
        sizes[len(passes)] = statistics["memory"]["film"]
        assert ("pass Depth" in statistics["left_out"]) == (len(passes) < 2)
    assert sizes[1] < sizes[2] < sizes[3]


# Run under callgrind: a scene of diffuse meshes, start to end.
WATCHED = """
import sys
sys.path[:0] = {paths!r}
from rayleaf import _core
import test_left_out
session = _core.Session(test_left_out.diffuse_scene(_core), _core.Settings(width=4, height=4, samples=1, threads=1))
session.render()
"""
# Folders, and files of other folders, that a scene of diffuse meshes has no use for.
UNUSED = ("splines/", "tessellation/", "textures/", "ri_tree/", "geometry/patch_surface", "geometry/swept_",
          "geometry/strand", "geometry/curve_fits", "geometry/subdivision", "trace/grid_scene", "trace/strand_scene",
          "trace/embree_strand_scene", "trace/inside_length", "trace/subdivision", "integrators/irradiance",
          "integrators/distribution", "integrators/volumes", "integrators/glass_path")  # fmt: skip
# Names of a table, for the bindings; thresholds that settings have by default; a few settings, copied once a render.
# Settings are read and checked whatever the scene holds.
# Meshes of few triangles are met by the exact test of resident facets, over a list.
ASKED = {"few_facets_kernel", "meet_closest", "meet_any", "bits_of_half", "answer_names", "quality_settings",
         "checked", "require", "DistributionSettings::DistributionSettings"}  # fmt: skip


def defined_functions(source):
    """Names of the functions that a source defines outside classes, as it writes them: `name` and `Class::name`."""
    return set(re.findall(r"^[A-Za-z][^#=;(]*?[ &*]([\w:~]+)\(", source.read_text(), re.M))


def plain_name(demangled):
    """`rayleaf::(anonymous namespace)::Class::name<type>(types) const` as a source writes it: `Class::name`."""
    name = demangled.replace("(anonymous namespace)::", "")
    while (shorter := re.sub(r"<[^<>]*>", "", name)) != name:
        name = shorter
    return re.sub(r"N_[A-Z0-9]+::", "", name.split("(")[0].split(" ")[-1]).removeprefix("rayleaf::")


@pytest.mark.slow
def test_a_scene_of_diffuse_meshes_calls_no_function_of_splines_trees_or_textures(tmp_path):
    """Every function that runs, by callgrind, against those that sources define of what should not run."""
    valgrind = shutil.which("valgrind")
    if valgrind is None:
        pytest.skip("needs valgrind")
    script = tmp_path / "watched.py"
    script.write_text(WATCHED.format(paths=[path for path in sys.path if path]))
    calls = tmp_path / "calls"
    command = [valgrind, "--tool=callgrind", f"--callgrind-out-file={calls}", sys.executable, str(script)]
    subprocess.run(command, check=True, capture_output=True, text=True)
    listed = subprocess.run(["callgrind_annotate", "--threshold=100", str(calls)], capture_output=True, text=True)
    lines = [line for line in listed.stdout.splitlines() if "rayleaf::" in line]
    called = {plain_name(line[line.index("rayleaf::") :].split(" [")[0]) for line in lines}
    assert "Session::render" in called, "callgrind saw nothing of the core"
    sources = {str(path.relative_to(CORE)): defined_functions(path) for path in sorted(CORE.rglob("*.cpp"))}
    assert called & sources["integrators/path_tracer.cpp"], "names are written in two ways"
    used = set().union(*(names for place, names in sources.items() if not place.startswith(UNUSED)), ASKED)
    unwanted = {place: found for place, names in sources.items()
                if place.startswith(UNUSED) and (found := (names & called) - used)}  # fmt: skip
    assert unwanted == {}
