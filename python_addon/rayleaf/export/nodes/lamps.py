"""Nodes for lamps: the IES Texture; and whether a lamp's tree is more than a constant colour."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ... import cycles_versions, versions
from ...names import name_of, text_of
from .. import ies
from ..instance_values import NONE, OBJECT_COLOR, Value, number_value, of_object, property_of
from .compiler import Compiler, NodeView, value_node
from .emitter import UNCONNECTED, Emitter, Register
from .graph import output_of

_WORLD, _OBJECT = 0, 1  # spaces of the operation `transform`
# More than any manufacturer's.
_LARGEST_FILE = 1 << 24


def _text_of(node: Any) -> str:
    """What the node's file says. Raises OSError, IesError."""
    if node.mode == "INTERNAL":
        if node.ies is None:
            raise ies.IesError("no text is chosen")
        return str(node.ies.as_string())
    path = versions.absolute_path(text_of(node, "filepath"), node.id_data)
    with open(path, encoding="latin-1") as file:
        return file.read(_LARGEST_FILE)


def _shining(emitter: Emitter) -> Register:
    """The direction of the light, in the lamp's space."""
    if cycles_versions.area_lamps_shine_by_direction():
        return emitter.operation("transform", [emitter.operation("incoming")], [_WORLD, _OBJECT], text="VECTOR")
    return emitter.operation("object_normal")


@value_node("ShaderNodeTexIES")
def ies_texture(view: NodeView, output: str) -> Register:
    """IES Texture: by the direction in which the lamp shines, in its own space."""
    emitter, strength = view.emitter, view.input("Strength")
    try:
        table = ies.parse(_text_of(view.node))
    except (OSError, ies.IesError) as error:
        view.warn(f"its IES file cannot be used: {error}; the lamp shines alike everywhere")
        return strength
    direction = view.linked("Vector")
    if direction == UNCONNECTED:
        direction = _shining(emitter)
    value = emitter.operation("ies", [direction], floats=table)
    return emitter.math("MULTIPLY", value, strength)


@dataclass(frozen=True)
class LampOwner:
    """The object that a lamp's nodes may ask about."""

    object: Any  # evaluated
    random: float  # 0..1

    def info(self, output: str) -> Value | None:
        """What Object Info tells of it; None where that is the core's to tell."""
        if output == "Random":
            return number_value(self.random)
        if output == "Material Index" or (output == "Location" and cycles_versions.lamps_have_a_space()):
            return None
        if not cycles_versions.lamps_have_a_space():
            return NONE
        if output == "Object Index":
            return number_value(self.object.pass_index)
        color = of_object(self.object, OBJECT_COLOR)
        return number_value(color[3]) if output == "Alpha" else color

    def property(self, name: str) -> Value:
        """Of the object, else of the lamp."""
        return property_of(self.object, name) if cycles_versions.lamps_have_a_space() else NONE


def constant_emission(compiler: Compiler, tree: Any) -> NDArray[np.float64] | None:
    """Colour times strength where a tree is one Emission node without links; None for other trees."""
    output = output_of(tree)
    link = None if output is None else compiler.links.into(output.inputs["Surface"])
    node = None if link is None else link.from_node
    if node is None or node.mute or node.bl_idname != "ShaderNodeEmission":
        return None
    if any(compiler.links.into(socket) is not None for socket in node.inputs):
        return None
    color, strength = (next(s for s in node.inputs if name_of(s) == name) for name in ("Color", "Strength"))
    return np.array(color.default_value[:3]) * strength.default_value
