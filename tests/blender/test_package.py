"""The zip that `rayleaf package` makes installs in a Blender that never heard of this checkout."""

import subprocess

INSTALL_AND_RENDER = """
import sys
import addon_utils
import bpy

bpy.ops.preferences.addon_install(filepath=sys.argv[1])
bpy.ops.preferences.addon_enable(module="rayleaf")
import rayleaf

scene = bpy.context.scene
scene.render.engine = "RAYLEAF"
scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 16, 16, 100
scene.rayleaf.samples = 1
bpy.ops.render.render()
report(file=rayleaf.__file__, completed=rayleaf.last_statistics["completed"])
"""


def test_the_package_installs_and_renders(run_blender, root, tmp_path):
    made = subprocess.run([str(root / "rayleaf"), "package"], capture_output=True, text=True, timeout=600)
    assert made.returncode == 0, made.stderr
    archive = made.stdout.splitlines()[0]
    scripts = tmp_path / "scripts"
    (scripts / "addons").mkdir(parents=True)
    run = run_blender(INSTALL_AND_RENDER, archive, env={"BLENDER_USER_SCRIPTS": str(scripts)})
    assert run.report["file"] == str(scripts / "addons" / "rayleaf" / "__init__.py")
    assert run.report["completed"]
