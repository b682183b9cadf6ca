"""What a 3-D view shows: its camera, its size, its settings."""

import math
from typing import Any

import numpy as np

from ..denoising import Denoising
from ..export import camera
from ..export.camera import CropRectangle, Frame
from ..passes import Pass
from ..settings import core_settings

# Beyond this many screen pixels a point, Blender's Automatic pixel size takes two of them for one.
_DENSE_SCREEN = 1.5


def pixel_size(context: Any) -> int:
    """Screen pixels along a side of one that is rendered, as Blender's Performance panel says."""
    chosen = context.scene.render.preview_pixel_size
    if chosen == "AUTO":
        return 2 if context.preferences.system.pixel_size > _DENSE_SCREEN else 1
    return int(chosen)


def frame_of(context: Any) -> Frame:
    """The size of the picture that fills the view."""
    size = pixel_size(context)
    return Frame(max(context.region.width // size, 1), max(context.region.height // size, 1))


def camera_of(context: Any, depsgraph: Any) -> dict[str, Any]:
    """The arguments of the core's `set_camera`.

    Taken from the matrices with which Blender draws the rest of the view, so that both agree in every kind of view.
    """
    space, region = context.space_data, context.region_data
    to_world = np.array(region.view_matrix.inverted(), np.float64)
    projection = np.array(region.window_matrix, np.float64)
    seen_by = space.camera if region.view_perspective == "CAMERA" else None
    ends = space if seen_by is None or seen_by.type != "CAMERA" else seen_by.data
    clip_start, clip_end = float(ends.clip_start), float(ends.clip_end)
    if projection[3, 3] == 0.0:
        center, half = projection[:2, 2] / projection[[0, 1], [0, 1]], 1.0 / projection[[0, 1], [0, 1]]
        window_min, window_max = center - half, center + half
        kind = "PERSPECTIVE"
    else:
        center, half = -projection[:2, 3] / projection[[0, 1], [0, 1]], 1.0 / projection[[0, 1], [0, 1]]
        window_min, window_max = center - half, center + half
        kind = "ORTHOGRAPHIC"
        if seen_by is None:  # such views see as far behind their centre as before it
            to_world[:3, 3] += clip_end * to_world[:3, 2] / np.linalg.norm(to_world[:3, 2])
            clip_start, clip_end = 0.0, 2.0 * clip_end
    arguments: dict[str, Any] = dict(
        kind=kind,
        matrix=to_world,
        window_min=tuple(map(float, window_min)),
        window_max=tuple(map(float, window_max)),
        clip_start=clip_start,
        clip_end=clip_end,
    )
    if seen_by is not None and seen_by.type == "CAMERA" and seen_by.data.dof.use_dof:
        evaluated = seen_by.evaluated_get(depsgraph)
        dof = evaluated.data.dof
        arguments.update(
            aperture_radius=camera.aperture_radius(evaluated.data),
            focus_distance=camera.focus_distance(evaluated, np.array(evaluated.matrix_world, np.float64)),
            blades=dof.aperture_blades,
            blade_rotation=math.remainder(dof.aperture_rotation, 2 * math.pi),
            aperture_ratio=dof.aperture_ratio,
        )
    return arguments


def crop_of(context: Any, frame: Frame, camera_arguments: dict[str, Any]) -> CropRectangle:
    """The part of the view that is rendered: its own border, or through a camera, that of the scene."""
    space, scene = context.space_data, context.scene
    if context.region_data.view_perspective != "CAMERA":
        if not space.use_render_border:
            return CropRectangle(0, 0, frame.width, frame.height)
        border = _border_of(space, "render_border_")
        return _rectangle(border, frame)
    seen_by = space.camera
    if not scene.render.use_border or seen_by is None or seen_by.type != "CAMERA":
        return CropRectangle(0, 0, frame.width, frame.height)
    picture_min, picture_max = camera.window(seen_by.data, camera.frame_of(scene))
    border, shares = _border_of(scene.render, "border_"), []
    for side in range(2):
        for axis in range(2):
            low, high = camera_arguments["window_min"][axis], camera_arguments["window_max"][axis]
            place = picture_min[axis] + border[2 * side + axis] * (picture_max[axis] - picture_min[axis])
            shares.append((place - low) / (high - low))
    return _rectangle(tuple(shares), frame)


def _border_of(owner: Any, prefix: str) -> tuple[float, ...]:
    return tuple(float(getattr(owner, prefix + side)) for side in ("min_x", "min_y", "max_x", "max_y"))


def _rectangle(shares: tuple[float, ...], frame: Frame) -> CropRectangle:
    """At least a pixel, within the frame; `shares` of it: left, bottom, right, top."""
    sizes = (frame.width, frame.height)
    first = [min(max(round(shares[axis] * sizes[axis]), 0), sizes[axis] - 1) for axis in range(2)]
    end = [min(max(round(shares[2 + axis] * sizes[axis]), first[axis] + 1), sizes[axis]) for axis in range(2)]
    return CropRectangle(first[0], first[1], end[0] - first[0], end[1] - first[1])


def settings_of(
    core: Any, scene: Any, view_layer: Any, frame: Frame, crop: CropRectangle, shown: Pass
) -> dict[str, Any]:
    """The arguments of the core's Settings: those of a render, without what would delay the first picture."""
    settings = core_settings(core, scene, view_layer, frame, crop, [shown])
    settings.update(samples=1, time_limit=0.0, target_error=0.0)  # samples are taken in rounds
    if settings["ray_interpolation"].mode == "AUTO":  # whose probe takes as long as a picture
        settings["ray_interpolation"] = core.RayInterpolation()
    return settings


def denoising_of(scene: Any, shown: Pass) -> Denoising | None:
    """How a view's picture is denoised; None if it is not."""
    wanted = scene.rayleaf.use_preview_denoising and shown.identifier == "combined"
    return Denoising.of(scene) if wanted else None
