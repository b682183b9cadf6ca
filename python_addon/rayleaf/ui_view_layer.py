"""Panels of a view layer: its passes, what it shows, and what it sets for itself."""

from typing import Any

import bpy

from . import passes
from .ui import _Panel


class RAYLEAF_PT_passes(_Panel, bpy.types.Panel):
    """The passes of a view layer, from the pass table."""

    bl_label = "Passes"
    bl_context = "view_layer"

    def draw(self, context: Any) -> None:
        groups: dict[str, list[passes.Pass]] = {}
        for entry in passes.table():
            if entry.switch and not entry.is_for_developers and not entry.is_hidden:
                groups.setdefault(entry.group, []).append(entry)
        for heading, entries in groups.items():
            column = self._column().column(heading=heading, align=True)
            for entry in {entry.switch: entry for entry in entries}.values():
                column.prop(*entry.place(context.view_layer), text=entry.label)


class RAYLEAF_PT_filter(_Panel, bpy.types.Panel):
    """What a view layer shows of the scene."""

    bl_label = "Filter"
    bl_context = "view_layer"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: Any) -> None:
        column = self._column().column(heading="Include")
        column.prop(context.view_layer, "use_sky", text="Environment")
        column.prop(context.view_layer, "use_solid", text="Surfaces")
        column.prop(context.view_layer, "use_strand", text="Hair")


class RAYLEAF_PT_override(_Panel, bpy.types.Panel):
    """What a view layer sets in place of the scene."""

    bl_label = "Override"
    bl_context = "view_layer"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: Any) -> None:
        column = self._column()
        column.prop(context.view_layer, "material_override")
        column.prop(context.view_layer, "samples")


PANELS = (RAYLEAF_PT_passes, RAYLEAF_PT_filter, RAYLEAF_PT_override)
register, unregister = bpy.utils.register_classes_factory(PANELS)
