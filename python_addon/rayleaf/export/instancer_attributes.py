"""What Attribute nodes of type Instancer read: a property of the particle system, else an attribute of the instance, else a
property of what makes it, else of the object or its data, as Cycles finds them.

Geometry nodes keep the attributes of the instances that they make, but Blender does not say which of them an instance of the
depsgraph's list is. It gives numbers to each, one a level of instancing, and these are followed from the outermost level in.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

from .. import versions
from ..messages import Messages, Subject
from ..names import name_of
from .attributes import Floats, flat_values, integers
from .instance_values import NONE, Value, found_property, property_of

_UNUSED = 2**31 - 1  # what stands behind an instance's last number


def _as_colors(values: Floats) -> list[Value]:
    """Of one to four channels, as Blender converts them to colours."""
    count, channels = values.shape
    if channels == 1:
        values = np.repeat(values, 3, axis=1)
    colors = np.zeros((count, 4), np.float32)
    colors[:, 3] = 1.0
    colors[:, : values.shape[1]] = values
    return [(red, green, blue, alpha) for red, green, blue, alpha in colors.tolist()]


class _Level:
    """The instances that one geometry holds."""

    def __init__(self, cloud: Any, references: Sequence[Any], name: str) -> None:
        """`cloud`: a point an instance."""
        values = flat_values(cloud.attributes, name, "POINT")
        self.values: list[Value] | None = None if values is None else _as_colors(values)
        self.references = references
        kinds = integers(cloud.attributes, ".reference_index")
        self.reference_of: list[int] | None = None if kinds is None else kinds.tolist()
        self.below: dict[int, _Level | None] = {}  # by reference
        self._count = len(cloud.points)
        self._rows: dict[int, int] | None = None  # by number; None: it is the number
        self._repeated: list[int] = []
        ids = integers(cloud.attributes, "id")
        if ids is not None:
            self._rows = {}
            for row, number in enumerate(ids.tolist()):
                if self._rows.setdefault(number, row) != row:
                    self._repeated.append(row)
            self._repeated.reverse()

    def row(self, number: int) -> int | None:
        """The instance of a number. Blender renumbers those whose number is another's already; they come in their order."""
        if self._rows is None:
            return number if 0 <= number < self._count else None
        if number not in self._rows and self._repeated:
            self._rows[number] = self._repeated.pop()
        return self._rows.get(number)

    def reference(self, row: int) -> tuple[int, Any]:
        """What an instance shows: its index, and an Object, Collection or GeometrySet."""
        index = 0 if self.reference_of is None else self.reference_of[row]
        return index, self.references[index] if 0 <= index < len(self.references) else None


def of_instancers(depsgraph: Any, name: str, messages: Messages) -> Floats:
    """(n, 4): an attribute of all in the depsgraph's list; 0 without."""
    attribute = _Attribute(depsgraph, name)
    rows = [attribute.value(instance) for instance in depsgraph.object_instances]  # to the end: see instances.collect
    for maker in sorted(attribute.unread):
        subject = Subject("Object", maker)
        reason = "this Blender does not show attributes of instances (4.5 does)"
        messages.warn(f"{subject}: {reason}; their {name} is 0", subject)
    return np.array(rows, np.float32).reshape(-1, 4)


class _Attribute:
    """One attribute, of any instance."""

    def __init__(self, depsgraph: Any, name: str) -> None:
        self.unread: set[str] = set()  # objects whose instances' attributes this Blender does not show
        self._depsgraph, self._name = depsgraph, name
        self._is_render = depsgraph.mode == "RENDER"
        self._levels: dict[int, _Level | None] = {}  # by the pointer of the original object
        self._properties: dict[int, Value | None] = {}  # by the pointer of the original object or particle settings
        self._of_objects: dict[int, Value] = {}

    def value(self, instance: Any) -> Value:
        """Of a member of the depsgraph's list."""
        if instance.is_instance:
            system, maker = instance.particle_system, instance.parent
            found = None if system is None else self._property(system.settings)
            found = found or self._of_instance(instance, maker) or self._property(maker)
            if found is not None:
                return found
        key = instance.object.original.as_pointer()
        if key not in self._of_objects:
            self._of_objects[key] = property_of(instance.object, self._name)
        value = self._of_objects[key]
        if instance.is_instance and value == NONE and not versions.shows_geometry():
            self._note_unread(instance.parent)
        return value

    def _note_unread(self, maker: Any) -> None:
        if any(modifier.type == "NODES" for modifier in maker.modifiers):
            self.unread.add(name_of(maker))

    def _property(self, holder: Any) -> Value | None:
        key = holder.original.as_pointer()
        if key not in self._properties:
            self._properties[key] = found_property(holder, self._name)
        return self._properties[key]

    def _of_instance(self, instance: Any, maker: Any) -> Value | None:
        level = self._level_of(maker)
        if level is None and maker.instance_type != "COLLECTION":
            return None
        numbers = [number for number in reversed(instance.persistent_id[:]) if number != _UNUSED]
        made = instance.object.original
        return (
            self._in(level, numbers, made) if level else self._in_collection(maker.instance_collection, numbers, made)
        )

    def _in(self, level: _Level | None, numbers: list[int], made: Any) -> Value | None:
        """The innermost value that an instance has from a level on; None where it has none, and where the last number is
        that of geometry that lies beside the instances."""
        row = level.row(numbers[0]) if level and numbers else None
        if level is None or row is None:
            return None
        index, reference = level.reference(row)
        kind = type(reference).__name__
        if len(numbers) == 1:
            inner = None
            if kind != "Object" or reference.original != made:
                return None
        elif kind == "Object":
            inner = self._in_object(reference, numbers[1:], made)
        elif kind == "Collection":
            inner = self._in_collection(reference, numbers[1:], made)
        elif kind == "GeometrySet":
            if index not in level.below:
                level.below[index] = self._level(reference)
            inner = self._in(level.below[index], numbers[1:], made)
        else:
            return None
        if inner is not None or level.values is None:
            return inner
        return level.values[row]

    def _in_object(self, owner: Any, numbers: list[int], made: Any) -> Value | None:
        level = self._level_of(owner.evaluated_get(self._depsgraph))
        if level is None and owner.instance_type == "COLLECTION":
            return self._in_collection(owner.instance_collection, numbers, made)
        return self._in(level, numbers, made)

    def _in_collection(self, collection: Any, numbers: list[int], made: Any) -> Value | None:
        """Of an instance of what a member of a collection makes; numbers count the members that are shown."""
        if len(numbers) < 2 or collection is None:
            return None
        hidden = "hide_render" if self._is_render else "hide_viewport"
        members = [member for member in collection.all_objects if not getattr(member, hidden)]
        return self._in_object(members[numbers[0]], numbers[1:], made) if numbers[0] < len(members) else None

    def _level_of(self, owner: Any) -> _Level | None:
        key = owner.original.as_pointer()
        if key not in self._levels:
            geometry = versions.evaluated_geometry(owner)
            self._levels[key] = None if geometry is None else self._level(geometry)
        return self._levels[key]

    def _level(self, geometry: Any) -> _Level | None:
        cloud = geometry.instances_pointcloud()
        return None if cloud is None else _Level(cloud, geometry.instance_references(), self._name)
