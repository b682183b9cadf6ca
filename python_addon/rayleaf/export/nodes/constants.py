"""Lamp node trees: a lamp's nodes may tint and scale its light by constants."""

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...messages import Messages, Subject
from ...names import name_of

_ONE = np.array([1.0, 1.0, 1.0])


def lamp_emission(lamp: Any, subject: Subject, messages: Messages) -> NDArray[np.float64]:
    """Colour times strength of the Emission node at a lamp's output; one, and a message, for other trees."""
    output = lamp.node_tree.get_output_node("CYCLES")
    if output is None or not output.inputs["Surface"].is_linked:
        return _ONE * 0.0
    node = output.inputs["Surface"].links[0].from_node
    while node.bl_idname == "NodeReroute" and node.inputs[0].is_linked:
        node = node.inputs[0].links[0].from_node
    if node.bl_idname != "ShaderNodeEmission":
        messages.warn(f"{subject}: of its nodes only an Emission node is supported; they are ignored", subject)
        return _ONE
    if node.inputs["Color"].is_linked or node.inputs["Strength"].is_linked:
        subject = replace(subject, node=name_of(node))
        messages.warn(f"{subject}: linked inputs are not supported; their own values are used", subject)
    return np.array(node.inputs["Color"].default_value[:3]) * node.inputs["Strength"].default_value
