"""The panels of which rays see objects and the world, and where shadows begin."""

from typing import Any

import bpy

from . import versions
from .ui import _Panel


class RAYLEAF_PT_ray_visibility(_Panel, bpy.types.Panel):
    """Which rays see an object."""

    bl_label = "Ray Visibility"
    bl_context = "object"
    bl_parent_id = "OBJECT_PT_visibility"

    @classmethod
    def poll(cls, context: Any) -> bool:
        shown = {"MESH", "CURVE", "SURFACE", "FONT", "META", "LIGHT", "EMPTY"}
        return context.object is not None and context.object.type in shown and super().poll(context)

    def draw(self, context: Any) -> None:
        column = self._column()
        if context.object.type == "EMPTY":  # of what it makes instances of
            column.prop(context.object, "is_shadow_catcher")
            return
        for kind in ("camera", "diffuse", "glossy", "transmission", "volume_scatter", "shadow"):
            column.prop(context.object, f"visible_{kind}", text=kind.replace("_", " ").title())
        column.prop(context.object, "is_holdout")
        column.prop(context.object, "is_shadow_catcher")


class RAYLEAF_PT_world_visibility(_Panel, bpy.types.Panel):
    """Which rays see the world."""

    bl_label = "Ray Visibility"
    bl_context = "world"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context: Any) -> bool:
        return context.world is not None and hasattr(context.world, "cycles_visibility") and super().poll(context)

    def draw(self, context: Any) -> None:
        column = self._column()
        for kind in ("camera", "diffuse", "glossy", "transmission", "scatter"):
            column.prop(context.world.cycles_visibility, kind, text="Volume Scatter" if kind == "scatter" else None)


class RAYLEAF_PT_shadow_terminator(_Panel, bpy.types.Panel):
    """Where shadow rays start on coarse meshes that are shaded smooth."""

    bl_label = "Shadow Terminator"
    bl_context = "object"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context: Any) -> bool:
        shown = context.object is not None and context.object.type in {"MESH", "CURVE", "FONT", "META"}
        return shown and versions.holder_of_shadow_terminator(context.object) is not None and super().poll(context)

    def draw(self, context: Any) -> None:
        holder = versions.holder_of_shadow_terminator(context.object)
        self._column().prop(holder, versions.SHADOW_TERMINATOR, text="Geometry Offset")


CLASSES = (RAYLEAF_PT_ray_visibility, RAYLEAF_PT_world_visibility, RAYLEAF_PT_shadow_terminator)
register, unregister = bpy.utils.register_classes_factory(CLASSES)
