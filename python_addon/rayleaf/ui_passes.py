"""Panels of passes that a view layer lists by name: Blender's own, below Rayleaf's passes; and of what shines in a group."""

from typing import Any

import bpy
from bl_ui import properties_view_layer

from .ui import ENGINE, _Panel


def _drawing(name: str) -> Any:
    """What Blender's own panel of this name draws. Since 4.3 that is no panel itself, and has another name."""
    panel = f"ViewLayer{name}Panel"
    return getattr(properties_view_layer, f"{panel}Helper", None) or getattr(properties_view_layer, panel)


_Cryptomatte: Any = _drawing("Cryptomatte")
_Aov: Any = _drawing("AOV")
_Lightgroups: Any = _drawing("Lightgroups")


class RAYLEAF_PT_passes_cryptomatte(_Cryptomatte, bpy.types.Panel):
    """Mattes of objects, materials and assets."""

    bl_context = "view_layer"
    bl_parent_id = "RAYLEAF_PT_passes"
    COMPAT_ENGINES = {ENGINE}


class RAYLEAF_PT_passes_aov(_Aov, bpy.types.Panel):
    """What shaders write."""

    bl_context = "view_layer"
    bl_parent_id = "RAYLEAF_PT_passes"
    COMPAT_ENGINES = {ENGINE}


class RAYLEAF_PT_passes_lightgroups(_Lightgroups, bpy.types.Panel):
    """Light by what sends it."""

    bl_context = "view_layer"
    bl_parent_id = "RAYLEAF_PT_passes"
    COMPAT_ENGINES = {ENGINE}


def _draw_light_group(panel: Any, owner: Any, view_layer: Any) -> None:
    """The group in which something shines."""
    row = panel.layout.row(align=True)
    row.use_property_split, row.use_property_decorate = True, False
    row.prop_search(owner, "lightgroup", view_layer, "lightgroups", text="Light Group", results_are_suggestions=True)
    add = row.column(align=True)
    add.enabled = bool(owner.lightgroup) and owner.lightgroup not in view_layer.lightgroups
    add.operator("scene.view_layer_add_lightgroup", icon="ADD", text="").name = owner.lightgroup


class RAYLEAF_PT_object_lightgroup(_Panel, bpy.types.Panel):
    """Of lamps and of objects that emit."""

    bl_label = "Light Group"
    bl_context = "object"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: Any) -> None:
        _draw_light_group(self, context.object, context.view_layer)


class RAYLEAF_PT_world_lightgroup(_Panel, bpy.types.Panel):
    """Of the world."""

    bl_label = "Light Group"
    bl_context = "world"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context: Any) -> bool:
        return context.world is not None and super().poll(context)

    def draw(self, context: Any) -> None:
        _draw_light_group(self, context.world, context.view_layer)


PANELS = (
    RAYLEAF_PT_passes_cryptomatte,
    RAYLEAF_PT_passes_aov,
    RAYLEAF_PT_passes_lightgroups,
    RAYLEAF_PT_object_lightgroup,
    RAYLEAF_PT_world_lightgroup,
)
register, unregister = bpy.utils.register_classes_factory(PANELS)
