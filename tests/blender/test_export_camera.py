"""Cameras, compared with Blender's own projection."""

SCRIPT = """
import itertools, math
import bpy, mathutils, scenes, recording_core
from bpy_extras.object_utils import world_to_camera_view

scene = scenes.empty_scene()
camera = scene.camera
camera.location, camera.rotation_euler = (1, -2, 3), (0.3, 0.5, -0.7)
render = scene.render
worst, count = 0.0, 0
for kind, fit, shift, size, aspect in itertools.product(
    ("PERSP", "ORTHO"),
    ("AUTO", "HORIZONTAL", "VERTICAL"),
    ((0, 0), (0.2, -0.3)),
    ((160, 90), (90, 160), (100, 100)),
    ((1, 1), (2, 1), (1, 1.5)),
):
    data = camera.data
    data.type, data.sensor_fit, data.lens, data.ortho_scale = kind, fit, 35, 5
    data.sensor_width, data.sensor_height = 36, 20
    data.shift_x, data.shift_y = shift
    render.resolution_x, render.resolution_y = size
    render.pixel_aspect_x, render.pixel_aspect_y = aspect
    bpy.context.view_layer.update()
    sent = recording_core.export()[0].camera
    (left, bottom), (right, top) = sent["window_min"], sent["window_max"]
    for point in (mathutils.Vector((0.3, 0.2, -2)), mathutils.Vector((-1, 0.4, -5))):
        plane = point.xy if kind == "ORTHO" else point.xy / -point.z
        ours = (plane.x - left) / (right - left), (plane.y - bottom) / (top - bottom)
        theirs = world_to_camera_view(scene, camera, camera.matrix_world @ point)
        worst = max(worst, abs(ours[0] - theirs.x), abs(ours[1] - theirs.y))
        count += 1
report(worst=worst, count=count)
"""


def test_the_window_agrees_with_blenders_projection_for_every_fit_shift_and_aspect(run_blender):
    run = run_blender(SCRIPT)
    assert run.report["count"] == 216
    assert run.report["worst"] < 1e-5  # Blender projects in single precision


def test_depth_of_field_becomes_an_aperture_in_metres_and_a_distance_along_the_axis(run_blender):
    run = run_blender(
        """
import scenes, recording_core, math
scene = scenes.empty_scene()
camera = scene.camera
camera.location, camera.rotation_euler = (0, 0, 10), (0, 0, 1)
data = camera.data
report(sharp=recording_core.export()[0].camera)
data.lens, data.dof.use_dof, data.dof.aperture_fstop, data.dof.focus_distance = 50, True, 2.0, 7.5
data.dof.aperture_blades, data.dof.aperture_rotation, data.dof.aperture_ratio = 5, 0.25, 1.5
report(by_distance={k: v for k, v in recording_core.export()[0].camera.items() if k != "matrix"})
data.dof.focus_object = scenes.add(None, "Target")
data.dof.focus_object.location = (3, 4, 6)
report(by_object=recording_core.export()[0].camera["focus_distance"])
data.type = "ORTHO"
report(ortho=recording_core.export()[0].camera["aperture_radius"])
""".replace(
            "report(sharp=recording_core.export()[0].camera)",
            "report(sharp=sorted(recording_core.export()[0].camera))",
        )
    ).report
    assert "aperture_radius" not in run["sharp"]
    lens = run["by_distance"]
    assert abs(lens["aperture_radius"] - 0.05 / 4) < 1e-8
    assert (lens["focus_distance"], lens["blades"], lens["blade_rotation"], lens["aperture_ratio"]) == (
        7.5,
        5,
        0.25,
        1.5,
    )
    assert abs(run["by_object"] - 4) < 1e-6
    assert abs(run["ortho"] - 0.25) < 1e-8


def test_an_unknown_panorama_and_a_missing_camera_are_named(run_blender):
    run = run_blender(
        """
import bpy, scenes, recording_core
from rayleaf.export import ExportError
scene = scenes.empty_scene()
camera, texts = scene.camera, []
camera.name = "Fisheye"
scenes.make_panoramic(camera.data, "FISHEYE_LENS_POLYNOMIAL")
for scene.camera in (camera, None):
    try:
        recording_core.export()
    except ExportError as error:
        texts.append(str(error))
report(texts=texts)
"""
    )
    panoramic, missing = run.report["texts"]
    assert "'Fisheye'" in panoramic and "Fisheye Lens Polynomial" in panoramic and "Equisolid" in panoramic
    assert "no camera" in missing
