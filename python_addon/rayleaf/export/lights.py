"""Blender's lamps to the core's."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import versions
from ..messages import Messages, Subject
from ..names import name_of
from .instances import VISIBLE_CAMERA
from .nodes.constants import lamp_emission


# How far light of a lamp may go where nobody has limited it.
_ANY_BOUNCES = 1024


def is_portal(lamp: Any) -> bool:
    """Whether an area lamp only shows Cycles where the world's light comes in."""
    return lamp.type == "AREA" and bool(versions.cycles_setting(lamp, "is_portal", False))


def _name_ignored(lamp: Any, subject: Subject, messages: Messages) -> None:
    if versions.cycles_setting(lamp, "max_bounces", _ANY_BOUNCES) < _ANY_BOUNCES:
        messages.warn(f"{subject}: a limit of bounces of its own is not supported; it has none", subject)
    if not getattr(lamp, "use_soft_falloff", True):  # 4.2
        messages.warn(f"{subject}: a lamp without soft falloff is not supported; it has one", subject)
    if not getattr(lamp, "normalize", True):  # 4.5
        messages.warn(f"{subject}: power by area is not supported; taken as power in all", subject)


def describe(lamp_object: Any, matrix: NDArray[np.float64], visibility: int, messages: Messages) -> dict[str, Any]:
    """The arguments of the core's `add_lamp`."""
    lamp, subject = lamp_object.data, Subject("Light", name_of(lamp_object))
    _name_ignored(lamp, subject, messages)
    factor = np.full(3, versions.lamp_factor(lamp))
    if lamp.use_nodes and lamp.node_tree is not None:
        factor *= lamp_emission(lamp, subject, messages)
    arguments: dict[str, Any] = dict(
        name=subject.name,
        kind=lamp.type,
        matrix=matrix,
        strength=[float(channel) for channel in np.array(versions.lamp_color(lamp)) * lamp.energy * factor],
        casts_shadow=bool(lamp.use_shadow and versions.cycles_setting(lamp, "cast_shadow", True)),
        visibility=visibility & ~VISIBLE_CAMERA,  # Cycles never shows lamps to the camera
    )
    if lamp.type in ("POINT", "SPOT"):
        arguments["radius"] = lamp.shadow_soft_size
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
