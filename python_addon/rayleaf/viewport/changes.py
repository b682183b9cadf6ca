"""What Blender says has changed since a view was told last."""

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

import bpy

# Data blocks that no picture of a view depends on: its camera is asked each time, trees belong to what uses them.
_CAMERAS_AND_TREES = (bpy.types.Camera, bpy.types.NodeTree)


def _is_only_reshaded(update: Any) -> bool:
    return bool(update.is_updated_shading and not (update.is_updated_geometry or update.is_updated_transform))


def is_driven(block: Any) -> bool:
    """Whether properties of a data block follow others: Blender does not say which of them have changed."""
    return block.animation_data is not None and len(block.animation_data.drivers) > 0


@dataclass
class Changes:
    """Data blocks that have changed, by the pointers of their originals."""

    materials: dict[int, Any] = field(default_factory=dict)
    moved: dict[int, Any] = field(default_factory=dict)  # objects that are elsewhere, and otherwise as they were
    world: bool = False
    lamps: bool = False
    images: bool = False
    # Whose shading is said to be another, and nothing else: since 4.3 all that show a material that has changed.
    reshaded: dict[int, Any] = field(default_factory=dict)
    is_simple: bool = True  # nothing but what is told apart above
    pointers: set[int] = field(default_factory=set)  # of all that may make other geometry or other programs

    @classmethod
    def of(cls, updates: Iterable[Any]) -> "Changes":
        """As a depsgraph lists them."""
        changes = cls()
        for update in updates:
            changes._add(update, update.id.original)
        return changes

    def _add(self, update: Any, block: Any) -> None:
        pointer = block.as_pointer()
        if isinstance(block, bpy.types.Object):
            self._add_object(update, block, pointer)
            return
        self.pointers.add(pointer)
        if isinstance(block, bpy.types.Material):
            self.materials[pointer] = block
        elif isinstance(block, bpy.types.World):
            self.world = True
        elif isinstance(block, bpy.types.Light):
            self.lamps = True
        elif isinstance(block, bpy.types.Image):
            self.images, self.is_simple = True, False
        elif _is_only_reshaded(update):
            self.reshaded[pointer] = block
        elif not isinstance(block, _CAMERAS_AND_TREES):
            self.is_simple = False

    def _add_object(self, update: Any, block: Any, pointer: int) -> None:
        only_moved = not (update.is_updated_geometry or update.is_updated_shading)
        if not only_moved:
            self.pointers.add(pointer)
        if block.type == "CAMERA":
            return
        if block.type == "LIGHT":
            self.lamps = True
            if is_driven(block):  # it may be hidden now
                self.is_simple = False
            if update.is_updated_shading:
                self.reshaded[pointer] = block
        elif _is_only_reshaded(update):
            self.reshaded[pointer] = block
        elif only_moved and update.is_updated_transform:
            self.moved[pointer] = block
        else:
            self.is_simple = False
