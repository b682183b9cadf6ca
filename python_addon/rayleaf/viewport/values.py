"""What data blocks and groups of properties are set to, as values that can be compared."""

from functools import cache
from typing import Any

import bpy

_PLAIN = {"BOOLEAN", "INT", "FLOAT", "STRING", "ENUM"}


@cache
def _names(kind: Any) -> tuple[tuple[str, ...], tuple[str, ...], tuple[str, ...]]:
    """Of an RNA type's properties: those with one value, those with a row of them, and those that are groups."""
    single, rows, groups = [], [], []
    for item in kind.bl_rna.properties:
        if item.type in _PLAIN and not getattr(item, "is_array", False):
            single.append(item.identifier)
        elif item.type in _PLAIN and item.array_dimensions[1] == 0:
            rows.append(item.identifier)
        elif item.type == "POINTER" and isinstance(item.fixed_type, bpy.types.PropertyGroup):
            groups.append(item.identifier)
    return tuple(single), tuple(rows), tuple(groups)


def values_of(block: Any) -> tuple[Any, ...]:
    """Of all properties, and of the add-ons' groups of them."""
    kind: Any = type(block)
    single, rows, groups = _names(kind)
    found: list[Any] = [getattr(block, name) for name in single]
    found += [tuple(getattr(block, name)) for name in rows]
    found += [values_of(getattr(block, name)) for name in groups]
    return tuple(found)


def look_of(block: Any) -> tuple[Any, ...]:
    """Beside these, which materials it has."""
    slots = getattr(block, "materials", None)
    if slots is None:
        slots = [slot.material for slot in getattr(block, "material_slots", ())]
    return values_of(block), tuple(0 if each is None else each.as_pointer() for each in slots)
