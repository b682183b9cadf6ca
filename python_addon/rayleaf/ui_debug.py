"""What only developers compare: shown where Blender's preferences show Developer Extras."""

from typing import Any

import bpy

from . import passes
from .ui import _Panel


class _ForDevelopers:
    """Shown with Developer Extras alone."""

    bl_label = "Debug"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context: Any) -> bool:
        return bool(context.preferences.view.show_developer_ui) and super().poll(context)  # type: ignore[misc]


class RAYLEAF_PT_debug(_ForDevelopers, _Panel, bpy.types.Panel):
    """Other ways to render the same, to compare."""

    def draw(self, context: Any) -> None:
        column, settings = self._column(), context.scene.rayleaf
        column.prop(settings, "curve_primitive")
        detail = column.row()
        detail.active = settings.curve_primitive in ("SPHERES", "TRIANGLES", "QUADS")
        detail.prop(settings, "curve_detail")
        column.prop(settings, "geometry_cache_mode")
        levels = column.column()
        levels.active = settings.geometry_cache_mode != "SINGLE"
        levels.prop(settings, "use_importance_levels")
        levels.prop(settings, "least_mirrored_spread")


class RAYLEAF_PT_debug_passes(_ForDevelopers, _Panel, bpy.types.Panel):
    """Passes that tell how a picture was made."""

    bl_context = "view_layer"
    bl_parent_id = "RAYLEAF_PT_passes"

    def draw(self, context: Any) -> None:
        column = self._column().column(align=True)
        for entry in passes.table():
            if entry.is_for_developers:
                column.prop(*entry.place(context.view_layer), text=entry.label)


PANELS = (RAYLEAF_PT_debug, RAYLEAF_PT_debug_passes)
register, unregister = bpy.utils.register_classes_factory(PANELS)
