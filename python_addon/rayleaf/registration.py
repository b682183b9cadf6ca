"""Classes that Blender is to know, and groups of settings as properties of its own types."""

from collections.abc import Callable, Mapping, Sequence

import bpy
from bpy.props import PointerProperty


def registration_factory(
    classes: Sequence[type], groups: Mapping[type, type], attribute: str = "rayleaf"
) -> tuple[Callable[[], None], Callable[[], None]]:
    """A register and an unregister function for classes, of which `groups` has some as what an `attribute` of a type holds."""

    def register() -> None:
        for each in classes:
            bpy.utils.register_class(each)
        for owner, group in groups.items():
            setattr(owner, attribute, PointerProperty(type=group))

    def unregister() -> None:
        for owner in groups:
            delattr(owner, attribute)
        for each in reversed(classes):
            bpy.utils.unregister_class(each)

    return register, unregister
