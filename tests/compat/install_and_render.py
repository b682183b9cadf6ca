"""Inside Blender: install the package as a person does, and render one scene. Arguments: ZIP SCENE PICTURE.

Prints lines `RESULT key value`. An extension is installed from a repository index that stands beside it; an add-on by its file.
"""

import importlib
import os
import sys
import traceback

import addon_utils
import bpy

ADD_ON, EXTENSION = "rayleaf", "bl_ext.local.rayleaf"


def result(key, value):
    """A line for run_compat.py."""
    print(f"\nRESULT {key} {value}", flush=True)


def install(archive):
    """Unless it is there; the module's name."""
    name = EXTENSION if archive.endswith(".json") else ADD_ON
    if name == ADD_ON:
        if not any(each.__name__ == ADD_ON for each in addon_utils.modules()):
            bpy.ops.preferences.addon_install(filepath=archive)
        bpy.ops.preferences.addon_enable(module=ADD_ON)
        return name
    preferences = bpy.context.preferences
    preferences.system.use_online_access = True
    repositories = preferences.extensions.repos
    repository = repositories.new(name="Local", module="local", remote_url=f"file://{archive}")
    repository.use_remote_url = repository.enabled = True
    number = list(repositories).index(repository)
    if not os.path.isdir(os.path.join(repository.directory, "rayleaf")):
        bpy.ops.extensions.repo_sync(repo_index=number)
        bpy.ops.extensions.package_install(repo_index=number, pkg_id="rayleaf", enable_on_install=False)
    addon_utils.enable(name)
    return name


def render(scene_file, picture):
    """A small picture, saved as plain OpenEXR."""
    bpy.ops.wm.open_mainfile(filepath=scene_file)
    scene = bpy.context.scene
    scene.render.engine = "RAYLEAF"
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 80, 60, 100
    scene.rayleaf.samples = 4
    settings = scene.render.image_settings
    settings.file_format, settings.color_depth, settings.exr_codec = "OPEN_EXR", "32", "NONE"
    scene.render.filepath = picture
    bpy.ops.render.render(write_still=True)


def main():
    archive, scene_file, picture = sys.argv[sys.argv.index("--") + 1 :]
    result("python", "%d.%d" % sys.version_info[:2])
    name = install(archive)
    result("installed", "yes")
    result("problem", importlib.import_module(f"{name}.enabling").problem or "none")
    result("self-test", next(iter(bpy.ops.rayleaf.self_test())))
    render(scene_file, picture)
    statistics = importlib.import_module(name).last_statistics
    result("completed", statistics["completed"])
    result("warnings", len(statistics["messages"]))


try:
    main()
except Exception:
    traceback.print_exc()
    sys.stdout.flush()
    os._exit(1)
