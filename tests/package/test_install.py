"""The add-on zip installs in a Blender that never heard of this checkout, and holds all that rendering needs."""

import re
import zipfile

INSTALL_AND_RENDER = """
import sys
import addon_utils
import bpy

bpy.ops.preferences.addon_install(filepath=sys.argv[1])
bpy.ops.preferences.addon_enable(module="rayleaf")
import rayleaf
from rayleaf import enabling

scene = bpy.context.scene
scene.render.engine = "RAYLEAF"
scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 16, 16, 100
scene.rayleaf.samples = 1
bpy.ops.render.render()
mapped = {line.split()[-1] for line in open("/proc/self/maps") if "/rayleaf_lib" in line}
report(file=rayleaf.__file__, completed=rayleaf.last_statistics["completed"], problem=enabling.problem,
       mapped=sorted(mapped))
"""


def test_the_add_on_zip_installs_and_renders_with_its_own_libraries(run_blender, zips, tmp_path):
    scripts = tmp_path / "scripts"
    (scripts / "addons").mkdir(parents=True)
    run = run_blender(INSTALL_AND_RENDER, zips.add_on, env={"BLENDER_USER_SCRIPTS": str(scripts)})
    add_on = scripts / "addons" / "rayleaf"
    assert run.report["file"] == str(add_on / "__init__.py")
    assert run.report["completed"] and run.report["problem"] is None
    assert set(run.report["mapped"]) == {str(path) for path in (add_on / "libraries").glob("*.so")}


def test_the_extension_names_the_wheel_that_it_holds(zips):
    with zipfile.ZipFile(zips.extension) as archive:
        manifest = archive.read("blender_manifest.toml").decode()
        (wheel,) = (name for name in archive.namelist() if name.endswith(".whl"))
        assert f'\nwheels = ["./{wheel}"]\n' in manifest.split("\n[")[0]
        assert re.search(r"\[permissions\]\nfiles = \".+\"", manifest)
        assert "__init__.py" in archive.namelist() and not any("_core.cpython" in name for name in archive.namelist())
        with zipfile.ZipFile(archive.open(wheel)) as inside:
            names = inside.namelist()
    assert any(re.fullmatch(r"rayleaf_core/_core\.cpython-311-x86_64-linux-gnu\.so", name) for name in names)
    assert any(re.fullmatch(r"rayleaf_core/libraries/licences/libembree\d\.txt", name) for name in names)
    assert any(name.endswith(".dist-info/RECORD") for name in names)


def test_the_zips_stay_small(zips):
    for path in (zips.extension, zips.add_on):
        assert path.stat().st_size < 40e6, path
