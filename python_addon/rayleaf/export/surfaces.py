"""SURFACE objects as exact splines: which can be, and their control points."""

from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..messages import Messages, Subject
from ..names import name_of


def fallback_reason(surface_object: Any) -> str | None:
    """Why an object must be taken as Blender's evaluated mesh; None if it can be sent as splines."""
    for modifier in surface_object.modifiers:
        if modifier.show_render:
            return f"modifier {name_of(modifier)}"
    keys = surface_object.data.shape_keys
    if keys is not None and not keys.use_relative:
        return "absolute shape keys"
    return None


def _key_coordinates(block: Any) -> NDArray[np.float32]:
    values = np.empty(len(block.data) * 3, np.float32)
    block.data.foreach_get("co", values)
    return values.reshape(-1, 3)


def mixed_shape_keys(surface_object: Any) -> NDArray[np.float64] | None:
    """(points, 3): the control points of all splines with the relative shape keys mixed in; None without keys."""
    keys = surface_object.data.shape_keys
    if keys is None or not keys.key_blocks:
        return None
    blocks = list(keys.key_blocks)
    if surface_object.show_only_shape_key:
        return _key_coordinates(blocks[surface_object.active_shape_key_index]).astype(np.float64)
    mixed = _key_coordinates(blocks[0]).astype(np.float64)
    for block in blocks[1:]:
        if not block.mute and block.value != 0.0:
            mixed += block.value * (_key_coordinates(block).astype(np.float64) - _key_coordinates(block.relative_key))
    return mixed


def control_points(spline: Any) -> NDArray[np.float64]:
    """(count_v, count_u, 4): x, y, z, weight."""
    values = np.empty(len(spline.points) * 4, np.float32)
    spline.points.foreach_get("co", values)
    return values.astype(np.float64).reshape(spline.point_count_v, spline.point_count_u, 4)


def all_points(surface_object: Any) -> NDArray[np.float64]:
    """(points, 4): the control points of all splines, shape keys mixed in."""
    moved = mixed_shape_keys(surface_object)
    found, first = [np.empty((0, 4))], 0
    for spline in surface_object.data.splines:
        points = control_points(spline).reshape(-1, 4)
        if moved is not None and spline.type == "NURBS":
            points[:, :3] = moved[first : first + len(points)]
        first += len(points)
        found.append(points)
    return np.concatenate(found)


def topology(surface_object: Any) -> tuple[int, ...]:
    """Equal where the control points of two times are the same ones, of the same weights."""
    numbers = [
        number
        for spline in surface_object.data.splines
        for number in (spline.point_count_u, spline.point_count_v, spline.order_u, spline.order_v, spline.hide)
    ]
    weights = [control_points(spline)[..., 3].tobytes() for spline in surface_object.data.splines]
    return *numbers, hash(b"".join(weights))


def splines_of(
    core: ModuleType, surface_object: Any, messages: Messages, moved: NDArray[np.float64] | None = None
) -> list[list[Any]]:
    """The splines of a SURFACE object that the core accepts; the others are named in messages. Each comes with its forms
    at the shutter's steps; `moved`: all points then, of an object that deforms."""
    forms = [all_points(surface_object)]
    if moved is not None:
        forms += list(moved)
    subject = Subject("Object", name_of(surface_object))
    splines, first = [], 0
    for number, spline in enumerate(surface_object.data.splines):
        count = spline.point_count_u * spline.point_count_v
        own = slice(first, first + count)
        first += count
        if spline.hide:
            continue
        what = f"{subject}, spline {number + 1}"
        sent = [_spline(core, spline, points[own]) for points in forms]
        problem = sent[0].problem()
        if problem is None:
            splines.append(sent)
        else:
            _, argument, got, wanted = problem
            messages.warn(f"{what}: {argument} is {got}, wanted {wanted}; left out", subject)
    return splines


def _spline(core: ModuleType, spline: Any, points: NDArray[np.float64]) -> Any:
    return core.NurbsSpline(
        points.reshape(spline.point_count_v, spline.point_count_u, 4),
        spline.order_u,
        spline.order_v,
        cyclic_u=spline.use_cyclic_u,
        cyclic_v=spline.use_cyclic_v,
        endpoint_u=spline.use_endpoint_u,
        endpoint_v=spline.use_endpoint_v,
        bezier_u=spline.use_bezier_u,
        bezier_v=spline.use_bezier_v,
        material_slot=spline.material_index,
        smooth=spline.use_smooth,
    )


def add_surface(
    core: ModuleType,
    scene: Any,
    surface_object: Any,
    messages: Messages,
    moved: NDArray[np.float64] | None = None,
) -> int | None:
    """Send a SURFACE object; the shape's index, or None if nothing of it can be rendered. `moved` as of splines_of."""
    name = name_of(surface_object)
    splines = splines_of(core, surface_object, messages, moved)
    if not splines:
        if not surface_object.data.splines:
            messages.note(f"Object '{name}' has no splines; left out", Subject("Object", name))
        return None
    try:
        return _send(scene, name, splines)
    except core.InputError as error:
        if len(splines) == 1:
            messages.warn(f"{error}; left out", Subject("Object", name))
            return None
    return _add_good_splines(core, scene, name, splines, messages)


def _send(scene: Any, name: str, splines: list[list[Any]]) -> int:
    """Each spline with its forms at the shutter's steps."""
    middle, *steps = (list(forms) for forms in zip(*splines))
    return int(scene.add_surface(name, middle, steps))


def _add_good_splines(
    core: ModuleType, scene: Any, name: str, splines: list[list[Any]], messages: Messages
) -> int | None:
    """One bad spline must not take the others with it: try each in a scene of its own, and send those that pass."""
    good = []
    for number, spline in enumerate(splines):
        try:
            _send(core.SceneDescription(), name, [spline])
            good.append(spline)
        except core.InputError as error:
            messages.warn(f"{error} (spline {number + 1}); left out", Subject("Object", name))
    return _send(scene, name, good) if good else None
