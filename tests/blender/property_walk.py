"""Runs inside Blender: changes every property and input of a node or lamp in turn, and tells which changes nobody notices.

What is noticed changes what the core is sent, or is named by a message.
"""

from dataclasses import dataclass
from itertools import combinations
from typing import Any, Callable

from oracle_case import put


@dataclass(frozen=True)
class Change:
    """One thing that a user may set otherwise."""

    name: str  # of the property or input
    value: str
    apply: Callable[[Any], bool]  # makes the change; False where Blender does not let it be made

    def __str__(self) -> str:
        return f"{self.name}={self.value}"


def property_changes(thing, base, pointers):
    """The changes of the properties that a thing has beside those of all of its base; `pointers` gives what to point at, by
    type."""
    shared = {prop.identifier for prop in base.bl_rna.properties}
    return [
        Change(prop.identifier, str(value), setter(prop.identifier, value))
        for prop in thing.bl_rna.properties
        if prop.identifier not in shared and not prop.is_readonly
        for value in other_values(thing, prop, pointers)
    ]


def setter(path, value):
    """A function that sets a property, by its path from the thing."""

    def apply(thing):
        put(thing, path, value)
        return True

    return apply


def other_values(thing, prop, pointers):
    """Values that a property may have instead of its own."""
    value = getattr(thing, prop.identifier)
    if prop.type == "ENUM":
        others = [item.identifier for item in prop.enum_items if item.identifier != value]
        return [other for other in others if accepts(thing, prop.identifier, other)]
    if prop.type == "BOOLEAN":
        return [other for other in (not value,) if accepts(thing, prop.identifier, other)]
    if prop.type == "STRING":
        return ["Other"]
    if prop.type == "POINTER":
        return [pointers[prop.fixed_type.identifier]] if prop.fixed_type.identifier in pointers else []
    return [[other_number(prop, each) for each in value] if prop.is_array else other_number(prop, value)]


def accepts(thing, name, value):
    """Whether a property can have this value: some entries are for geometry nodes alone, and some switches are only kept for
    old scripts, like 5.0's use_nodes. It is left as it was."""
    before = getattr(thing, name)
    try:
        setattr(thing, name, value)
    except TypeError:
        return False
    is_taken = getattr(thing, name) == value
    setattr(thing, name, before)
    return is_taken


def other_number(prop, value):
    """A number that the property may hold."""
    step = 1 if prop.type == "INT" else 0.25
    return value + step if value + step <= min(prop.hard_max, prop.soft_max) else value - step


def input_changes(node):
    """Another value for each input, or a link where it has none to write."""
    return [
        Change(f"input {socket.identifier}", "other", lambda other, i=index: change_input(other, i))
        for index, socket in enumerate(node.inputs)
        if socket.type != "SHADER"
    ]


def change_input(node, index):
    """False where the node hides the input."""
    socket = node.inputs[index]
    if not socket.enabled or socket.is_unavailable:
        return False
    if socket.hide_value or not hasattr(socket, "default_value"):
        tree = socket.id_data
        tree.links.new(tree.nodes.new("ShaderNodeTexCoord").outputs["Reflection"], socket)
        return True
    value = socket.default_value
    if isinstance(value, (str, bool)):
        socket.default_value = value + "x" if isinstance(value, str) else not value
        return True
    socket.default_value = value * 0.5 + 0.3125 if isinstance(value, float) else [x * 0.5 + 0.3125 for x in value]
    return True


KEPT = []


def keep_two(collection, thing):
    """Remove what was made before the last two data blocks: a comparison takes two, and thousands of names take long."""
    KEPT.append(thing)
    if len(KEPT) > 2:
        collection.remove(KEPT.pop(0))


def unnoticed(make, changes, look, most):
    """The changes that make no difference, alone or after others, of which `most` may have to be made first. `make` makes a
    fresh thing, `look` tells what is sent and said of it."""

    def is_noticed(change):
        return any(noticed(make, look, change, context) for context in contexts(changes, change, most))

    return [change for change in changes if not is_noticed(change)]


def contexts(changes, change, most):
    """What may have to be set first, the simplest first."""
    others = [other for other in changes if other.name != change.name]
    for count in range(most + 1):
        for chosen in combinations([o for o in others if count < 2 or not o.name.startswith("input ")], count):
            if len({other.name for other in chosen}) == count:
                yield chosen


def noticed(make, look, change, context):
    """Whether a change makes a difference after others."""
    before, after = make(), make()
    for thing in (before, after):
        if not all(other.apply(thing) for other in context):
            return False
    return change.apply(after) and look(before) != look(after)
