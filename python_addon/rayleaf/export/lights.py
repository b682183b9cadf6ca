"""Blender's lamps to the core's."""

import math
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import versions
from ..messages import Messages, Subject
from ..names import name_of
from .instances import VISIBLE_CAMERA
from .nodes.compiler import Compiler
from .nodes.resources import Resources
from .nodes.emitter import Emitter
from .nodes.lamps import constant_emission


# How far light of a lamp may go where nobody has limited it.
_ANY_BOUNCES = 1024


def is_portal(lamp: Any) -> bool:
    """Whether an area lamp only shows Cycles where the world's light comes in."""
    return lamp.type == "AREA" and bool(versions.cycles_setting(lamp, "is_portal", False))


def _name_ignored(lamp: Any, subject: Subject, messages: Messages) -> None:
    if versions.cycles_setting(lamp, "max_bounces", _ANY_BOUNCES) < _ANY_BOUNCES:
        messages.warn(f"{subject}: a limit of bounces of its own is not supported; it has none", subject)


def _area(lamp: Any, matrix: NDArray[np.float64]) -> float:
    """What Cycles takes for the lamp's area where its power is by area, world units squared; 1 for one without a size."""
    if lamp.type == "AREA":
        uneven = lamp.shape in ("RECTANGLE", "ELLIPSE")
        sides = np.linalg.norm(matrix[:3, :2], axis=0) * (lamp.size, lamp.size_y if uneven else lamp.size)
        area = float(sides[0] * sides[1]) * (math.pi / 4 if lamp.shape in ("DISK", "ELLIPSE") else 1.0)
    else:
        radius = math.tan(lamp.angle / 2) if lamp.type == "SUN" else lamp.shadow_soft_size
        area = math.pi * radius * radius
    return area or 1.0


def _emission(core: ModuleType, lamp: Any, subject: Subject, resources: Resources, messages: Messages) -> Any:
    """What the lamp's nodes make of its light: a colour, or a program where that is not the same everywhere."""
    if not lamp.use_nodes or lamp.node_tree is None:
        return np.ones(3)
    emitter = Emitter(core, subject.name)
    compiler = Compiler(emitter, subject, resources, messages)
    constant = constant_emission(compiler, lamp.node_tree)
    if constant is not None:
        return constant
    return emitter.program if compiler.compile_tree(lamp.node_tree) else np.zeros(3)


def describe(
    core: ModuleType,
    lamp_object: Any,
    matrix: NDArray[np.float64],
    visibility: int,
    resources: Resources,
    messages: Messages,
) -> dict[str, Any]:
    """The arguments of the core's `add_lamp`."""
    lamp, subject = lamp_object.data, Subject("Light", name_of(lamp_object))
    _name_ignored(lamp, subject, messages)
    factor = np.full(3, versions.lamp_factor(lamp))
    if not getattr(lamp, "normalize", True):  # 4.5
        factor *= _area(lamp, matrix)
    emission = _emission(core, lamp, subject, resources, messages)
    program = None if isinstance(emission, np.ndarray) else emission
    if program is None:
        factor *= emission
    arguments: dict[str, Any] = dict(
        name=subject.name,
        kind=lamp.type,
        matrix=matrix,
        strength=[float(channel) for channel in np.array(versions.lamp_color(lamp)) * lamp.energy * factor],
        casts_shadow=bool(lamp.use_shadow and versions.cycles_setting(lamp, "cast_shadow", True)),
        visibility=visibility & ~VISIBLE_CAMERA,  # Cycles never shows lamps to the camera
        emission=program,
    )
    if lamp.type in ("POINT", "SPOT"):
        arguments.update(radius=lamp.shadow_soft_size, soft_falloff=versions.has_soft_falloff(lamp))
    if lamp.type == "SPOT":
        arguments.update(spot_size=lamp.spot_size, spot_blend=lamp.spot_blend, spot_profile=versions.spot_profile())
    if lamp.type == "SUN":
        arguments["angle"] = lamp.angle
    if lamp.type == "AREA":
        round_shape = lamp.shape in ("DISK", "ELLIPSE")
        uneven = lamp.shape in ("RECTANGLE", "ELLIPSE")
        arguments.update(
            kind="DISK" if round_shape else "RECTANGLE",
            size_x=lamp.size,
            size_y=lamp.size_y if uneven else lamp.size,
            spread=lamp.spread,
        )
    return arguments
