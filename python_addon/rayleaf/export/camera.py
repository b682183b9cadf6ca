"""Blender's camera to the core's."""

import math
from dataclasses import dataclass
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import versions
from ..names import name_of
from . import ExportError

# Least f-number; below it the aperture would be infinite.
_LEAST_FSTOP = 1e-5
_MILLIMETRE = 1e-3
_LEAST_FOCUS_DISTANCE = 1e-5  # as in Cycles; at 0 there would be no directions


@dataclass(frozen=True)
class Frame:
    """The size of the picture."""

    width: int  # pixels, of the whole picture
    height: int
    pixel_aspect_x: float = 1.0
    pixel_aspect_y: float = 1.0


@dataclass(frozen=True)
class CropRectangle:
    """The part of the picture that is rendered, pixels from the lower left corner."""

    x: int
    y: int
    width: int
    height: int


def frame_of(scene: Any) -> Frame:
    """The whole picture's size: resolution and percentage."""
    render = scene.render
    share = render.resolution_percentage
    # Whole-number arithmetic, as Blender does it.
    width, height = render.resolution_x * share // 100, render.resolution_y * share // 100
    return Frame(width, height, render.pixel_aspect_x, render.pixel_aspect_y)


def crop_of(scene: Any, frame: Frame) -> CropRectangle:
    """The render border in pixels; the whole picture where there is none."""
    render = scene.render
    if not render.use_border:
        return CropRectangle(0, 0, frame.width, frame.height)
    # In single precision, as Blender does it: 0.9 of 30 pixels are 27, not 26.
    left, right = (
        int(np.float32(edge) * np.float32(frame.width)) for edge in (render.border_min_x, render.border_max_x)
    )
    bottom, top = (
        int(np.float32(edge) * np.float32(frame.height)) for edge in (render.border_min_y, render.border_max_y)
    )
    return CropRectangle(left, bottom, right - left, top - bottom)


@dataclass(frozen=True)
class Eye:
    """From where a picture is seen: of stereoscopic ones, one of several places."""

    camera_object: Any  # evaluated
    matrix: NDArray[np.float64]
    shift_x: float  # in place of the camera's
    side: int = 0  # of spherical stereo: -1 left, 1 right; 0: a camera's own


def eye_of(camera_object: Any) -> Eye:
    """A camera's own."""
    shift = float(getattr(camera_object.data, "shift_x", 0.0))
    return Eye(camera_object, np.array(camera_object.matrix_world, np.float64), shift)


def window(camera: Any, frame: Frame, shift_x: float | None = None) -> tuple[tuple[float, float], tuple[float, float]]:
    """The picture's window: on the plane at distance 1 (perspective) or in world units (orthographic). `shift_x`: in place
    of the camera's."""
    width, height = frame.width * frame.pixel_aspect_x, frame.height * frame.pixel_aspect_y
    horizontal = camera.sensor_fit == "HORIZONTAL" or (camera.sensor_fit == "AUTO" and width >= height)
    if camera.type == "ORTHO":
        larger_half = camera.ortho_scale / 2
    else:
        sensor = camera.sensor_height if camera.sensor_fit == "VERTICAL" else camera.sensor_width
        larger_half = sensor / 2 / camera.lens
    half_x = larger_half if horizontal else larger_half * width / height
    half_y = larger_half * height / width if horizontal else larger_half
    # Shift is in units of the fitted side, for both axes.
    shift = camera.shift_x if shift_x is None else shift_x
    center_x, center_y = 2 * larger_half * shift, 2 * larger_half * camera.shift_y
    return (center_x - half_x, center_y - half_y), (center_x + half_x, center_y + half_y)


def focus_distance(camera_object: Any, matrix: NDArray[np.float64]) -> float:
    """Along the view axis: to the focus object or its bone, else as set. World units."""
    dof = camera_object.data.dof
    if dof.focus_object is None:
        return max(float(dof.focus_distance), _LEAST_FOCUS_DISTANCE)
    target = dof.focus_object.matrix_world.copy()
    pose = dof.focus_object.pose
    if pose is not None and dof.focus_subtarget in pose.bones:
        target = target @ pose.bones[dof.focus_subtarget].matrix
    axis = matrix[:3, 2] / np.linalg.norm(matrix[:3, 2])
    return max(float(abs(axis @ (matrix[:3, 3] - np.array(target.translation)))), _LEAST_FOCUS_DISTANCE)


def aperture_radius(camera: Any) -> float:
    """World units, one being a metre."""
    fstop = max(camera.dof.aperture_fstop, _LEAST_FSTOP)
    return (1.0 if camera.type == "ORTHO" else camera.lens * _MILLIMETRE) / (2 * fstop)


_KINDS = {"PERSP": "PERSPECTIVE", "ORTHO": "ORTHOGRAPHIC", "PANO": "PANORAMIC"}
_PANORAMAS = ("EQUIRECTANGULAR", "FISHEYE_EQUIDISTANT", "FISHEYE_EQUISOLID", "MIRRORBALL")


def _spherical_stereo(eye: Eye) -> dict[str, Any]:
    """Of an eye that turns, more arguments of the core's Panorama."""
    if eye.side == 0:
        return {}
    stereo = eye.camera_object.data.stereo
    merge = (stereo.pole_merge_angle_from, stereo.pole_merge_angle_to) if stereo.use_pole_merge else None
    return dict(
        eye_offset=eye.side * stereo.interocular_distance / 2,
        convergence=None if stereo.convergence_mode == "PARALLEL" else stereo.convergence_distance,
        pole_merge=merge,
    )


def _panorama(core: ModuleType, eye: Eye, frame: Frame) -> Any:
    """The core's Panorama of a panoramic camera."""
    camera_object = eye.camera_object
    camera = camera_object.data
    found = versions.panorama(camera)
    kind = found["panorama_type"]
    if kind not in _PANORAMAS:
        words = kind.replace("_", " ").title()
        raise ExportError(
            f"Camera '{name_of(camera_object)}': panorama type {words} is not supported; use Equirectangular, Fisheye"
            " Equidistant, Fisheye Equisolid or Mirror Ball"
        )
    return core.Panorama(
        kind,
        (found["longitude_min"], found["longitude_max"]),
        (found["latitude_min"], found["latitude_max"]),
        found["fisheye_fov"],
        found["fisheye_lens"],
        _sensor(camera, frame),
        **_spherical_stereo(eye),
    )


def _sensor(camera: Any, frame: Frame) -> tuple[float, float]:
    """Width and height of what the picture fills, millimetres: one is the camera's, the other has the picture's shape."""
    width, height = frame.width * frame.pixel_aspect_x, frame.height * frame.pixel_aspect_y
    if camera.sensor_fit == "HORIZONTAL" or (camera.sensor_fit == "AUTO" and width > height):
        return camera.sensor_width, camera.sensor_width * height / width
    fitted = camera.sensor_height if camera.sensor_fit == "VERTICAL" else camera.sensor_width
    return fitted * width / height, fitted


def describe(core: ModuleType, eye: Eye, frame: Frame) -> dict[str, Any]:
    """The arguments of the core's `set_camera`."""
    camera_object, matrix = eye.camera_object, eye.matrix
    camera = camera_object.data
    if camera_object.type != "CAMERA":
        raise ExportError(f"Camera '{name_of(camera_object)}' is a {camera_object.type.lower()}, not a camera")
    if camera.type not in _KINDS:
        raise ExportError(
            f"Camera '{name_of(camera_object)}': type {camera.type.title()} is not supported; "
            "use Perspective, Orthographic or Panoramic"
        )
    window_min, window_max = window(camera, frame, eye.shift_x)
    arguments = dict(
        kind=_KINDS[camera.type],
        matrix=matrix,
        window_min=window_min,
        window_max=window_max,
        clip_start=camera.clip_start,
        clip_end=camera.clip_end,
    )
    if camera.type == "PANO":
        arguments["panorama"] = _panorama(core, eye, frame)
    if camera.dof.use_dof:
        arguments.update(
            aperture_radius=aperture_radius(camera),
            focus_distance=focus_distance(camera_object, matrix),
            blades=camera.dof.aperture_blades,
            blade_rotation=math.remainder(camera.dof.aperture_rotation, 2 * math.pi),
            aperture_ratio=camera.dof.aperture_ratio,
        )
    return arguments
