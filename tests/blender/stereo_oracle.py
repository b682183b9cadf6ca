"""Runs inside Blender: Cycles and Rayleaf render stereoscopic pictures; both views are left in EXR files of either."""

import sys
from pathlib import Path

import both_engines
import bpy
import scenes
from rayleaf.versions import animation_curves

report = globals()["report"]  # given by the test
SIZE, SAMPLES = 40, 256
# By name: what is set of the camera's stereo settings, and of the camera.
CASES = {
    "off-axis": (dict(convergence_mode="OFFAXIS", convergence_distance=5.0), {}),
    "off-axis, right": (dict(convergence_mode="OFFAXIS", pivot="RIGHT"), dict(shift_x=0.1)),
    "parallel": (dict(convergence_mode="PARALLEL", pivot="CENTER"), {}),
    "toe-in": (dict(convergence_mode="TOE", pivot="CENTER", convergence_distance=4.0), {}),
    "orthographic": (dict(convergence_mode="PARALLEL"), dict(type="ORTHO", ortho_scale=6.0)),
}
# Panoramas whose eyes turn: what is set of the stereo settings, and the kind of panorama.
PANORAMAS = {
    "around": (dict(convergence_mode="OFFAXIS", convergence_distance=5.0), "EQUIRECTANGULAR"),
    "around, parallel": (dict(convergence_mode="PARALLEL"), "EQUIRECTANGULAR"),
    "around, poles merged": (
        dict(convergence_mode="TOE", use_pole_merge=True, pole_merge_angle_from=0.2, pole_merge_angle_to=0.8),
        "EQUIRECTANGULAR",
    ),
    "fisheye": (dict(convergence_mode="OFFAXIS", convergence_distance=3.0), "FISHEYE_EQUIDISTANT"),
}
LENS = "focused on an object"
CAMERAS = "cameras of their own"
MOVING = "moving"


def build():
    """Bodies near and far, each of its colour."""
    scenes.empty_file()
    scene = bpy.context.scene
    scenes.plain_world((0.4, 0.5, 0.6))
    for number, place in enumerate(((0, 0, 0), (-1.5, 2, 0.4), (1.6, 4, 0.2), (0.6, -1.5, -0.3))):
        bpy.ops.mesh.primitive_cube_add(size=1.0, location=place, rotation=(0.3, 0.4 * number, 0.5))
        material, tree, _ = scenes.material(f"color {number}")
        color = (0.2 + 0.2 * number, 0.9 - 0.25 * number, 0.3, 1)
        scenes.diffuse_alone(tree).inputs[0].default_value = color
        bpy.context.object.data.materials.append(material)
    camera = scenes.add(bpy.data.cameras.new("Camera"))
    camera.location, camera.rotation_euler = (0.0, -6.0, 1.0), (1.4, 0.05, 0)
    scene.camera = camera
    scene.render.use_multiview, scene.render.views_format = True, "STEREO_3D"
    scene.render.resolution_x, scene.render.resolution_y = SIZE, SIZE // 2
    scene.render.resolution_percentage = 100
    scenes.write_layers()
    scene.render.image_settings.views_format = "MULTIVIEW"
    both_engines.sample_plainly(scene, SAMPLES)
    both_engines.without_blur(scene)
    both_engines.filter_by_box(scene)
    both_engines.set_alike(scene, max_bounces=1)
    return scene


def set_up(scene, stereo, camera):
    """Of the scene's camera."""
    data = scene.camera.data
    data.stereo.interocular_distance = 0.6
    for owner, values in ((data.stereo, stereo), (data, camera)):
        for name, value in values.items():
            setattr(owner, name, value)


def focus(scene):
    """On the cube that is far."""
    dof = scene.camera.data.dof
    dof.use_dof, dof.aperture_fstop, dof.focus_object = True, 0.1, bpy.data.objects["Cube.002"]


def turn_eyes(kind):
    """All around, in the middle of the bodies."""

    def change(scene):
        camera = scene.camera
        camera.location, camera.data.stereo.use_spherical_stereo = (0.1, -2.5, 0.6), True
        scenes.make_panoramic(camera.data, kind)

    return change


def give_views_cameras(scene):
    """Found by the ends of their names."""
    scene.render.views_format = "MULTIVIEW"
    for suffix, x in (("_L", -1.0), ("_R", 0.7)):
        camera = scenes.add(bpy.data.cameras.new("Seen"), f"Seen{suffix}")
        camera.location, camera.rotation_euler = (x, -6.0, 0.5), (1.45, 0, -0.1 * x)
        camera.data.lens = 50 + 10 * x
        if suffix == "_L":
            scene.camera = camera


def move(scene):
    """The camera, while the shutter is open."""
    scene.render.use_motion_blur, scene.render.motion_blur_shutter = True, 1.0
    for frame, x in ((0, -0.5), (2, 0.5)):
        scene.camera.location.x = x
        scene.camera.keyframe_insert("location", frame=frame)
    for curve in animation_curves(scene.camera):
        for point in curve.keyframe_points:
            point.interpolation = "LINEAR"


def render(folder, name):
    """Both engines; what a case is called is no file name."""
    for engine in ("CYCLES", "RAYLEAF"):
        both_engines.channels(bpy.context.scene, engine, folder / f"{name.replace(' ', '_')}_{engine}.exr")


if __name__ == "__main__":
    out = Path(sys.argv[1])
    for case, (of_stereo, of_camera) in CASES.items():
        set_up(build(), of_stereo, of_camera)
        render(out, case)
    for case, (of_stereo, panorama) in PANORAMAS.items():
        made = build()
        set_up(made, of_stereo, {})
        turn_eyes(panorama)(made)
        render(out, case)
    for case, change in ((LENS, focus), (CAMERAS, give_views_cameras), (MOVING, move)):
        made = build()
        set_up(made, dict(convergence_mode="TOE"), {})
        change(made)
        render(out, case)
    report(cases=[*CASES, *PANORAMAS, LENS, CAMERAS, MOVING])
