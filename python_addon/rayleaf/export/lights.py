"""Blender's lamps to the core's."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import versions
from ..messages import Messages, Subject
from ..names import name_of
from .instances import VISIBLE_CAMERA
from .nodes.constants import lamp_emission


def describe(lamp_object: Any, matrix: NDArray[np.float64], visibility: int, messages: Messages) -> dict[str, Any]:
    """The arguments of the core's `add_lamp`."""
    lamp, subject = lamp_object.data, Subject("Light", name_of(lamp_object))
    factor = np.full(3, versions.lamp_factor(lamp))
    if lamp.use_nodes and lamp.node_tree is not None:
        factor *= lamp_emission(lamp, subject, messages)
    arguments: dict[str, Any] = dict(
        name=subject.name,
        kind=lamp.type,
        matrix=matrix,
        strength=[float(channel) for channel in np.array(lamp.color) * lamp.energy * factor],
        casts_shadow=bool(lamp.use_shadow),
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
