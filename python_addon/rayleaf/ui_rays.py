"""Panels of which rays see what, of where shadows begin, and of ray interpolation and volume visualisation."""

import textwrap
from typing import Any

import bpy

from . import ray_report, statistics
from .names import name_of
from .ui import _Panel

_SHAPES = {"MESH", "CURVE", "SURFACE", "FONT", "META"}
_LINE = 44  # characters that a panel of usual width shows
_MOST_LISTED = 20  # objects in the panel of the scene


def _draw_thresholds(column: Any, settings: Any) -> None:
    error = column.row()
    error.enabled = not settings.use_advanced
    error.prop(settings, "error")
    column.prop(settings, "use_advanced")
    if settings.use_advanced:
        advanced = column.column(align=True)
        advanced.prop(settings, "distance")
        advanced.prop(settings, "angle")
        advanced.prop(settings, "depth")
        advanced.prop(settings, "rays_per_cell")
        advanced.prop(settings, "cache_size", text="Cache Size (MB)")


def _draw_outcome(column: Any, cache: dict[str, Any]) -> None:
    """What became of rays against an object in the last render, and why."""
    column.label(text=ray_report.names(cache), icon="CHECKMARK" if cache["used"] else "X")
    for part in ray_report.outcome(cache):
        for line in textwrap.wrap(part, _LINE):
            column.label(text=line, icon="BLANK1")


class RAYLEAF_PT_ray_interpolation(_Panel, bpy.types.Panel):
    """Rays answered from rays traced before."""

    bl_label = "Ray Interpolation"

    def draw(self, context: Any) -> None:
        column, settings = self._column(), context.scene.rayleaf.ray_interpolation
        column.row().prop(settings, "mode", expand=True)
        thresholds = column.column()
        thresholds.active = settings.mode != "OFF"
        _draw_thresholds(thresholds, settings)


class RAYLEAF_PT_ray_interpolation_outcome(_Panel, bpy.types.Panel):
    """What it did in the last render, object by object."""

    bl_label = "Last Render"
    bl_parent_id = "RAYLEAF_PT_ray_interpolation"

    @classmethod
    def poll(cls, context: Any) -> bool:
        return bool(ray_report.caches(statistics.last(name_of(context.scene)))) and super().poll(context)

    def draw(self, context: Any) -> None:
        column = self.layout.column(align=True)
        found = ray_report.caches(statistics.last(name_of(context.scene)))
        for cache in found[:_MOST_LISTED]:
            _draw_outcome(column, cache)
        if len(found) > _MOST_LISTED:
            column.label(text=f"and {len(found) - _MOST_LISTED} more")


class RAYLEAF_PT_object_ray_interpolation(_Panel, bpy.types.Panel):
    """The same for one object."""

    bl_label = "Ray Interpolation"
    bl_context = "object"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context: Any) -> bool:
        return context.object is not None and context.object.type in _SHAPES and super().poll(context)

    def draw(self, context: Any) -> None:
        column, settings = self._column(), context.object.rayleaf.ray_interpolation
        column.prop(settings, "mode")
        column.prop(settings, "use_own_error")
        if settings.use_own_error:
            _draw_thresholds(column, settings)
        cache = ray_report.of_object(statistics.last(name_of(context.scene)), name_of(context.object))
        if cache is not None:
            column.separator()
            column.label(text="Last render:")
            _draw_outcome(column.column(align=True), cache)


class RAYLEAF_PT_volume(_Panel, bpy.types.Panel):
    """An object as an x-ray shows it."""

    bl_label = "Volume Visualisation"
    bl_context = "material"

    @classmethod
    def poll(cls, context: Any) -> bool:
        return context.material is not None and super().poll(context)

    def draw_header(self, context: Any) -> None:
        self.layout.prop(context.material.rayleaf, "use_volume", text="")

    def draw(self, context: Any) -> None:
        column, settings = self._column(), context.material.rayleaf
        column.active = settings.use_volume
        column.prop(settings, "volume_kind")
        column.prop(settings, "volume_density")
        column.prop(settings, "volume_color")


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
    _OFFSET = "shadow_terminator_geometry_offset"

    @classmethod
    def poll(cls, context: Any) -> bool:
        shown = context.object is not None and context.object.type in {"MESH", "CURVE", "FONT", "META"}
        return shown and cls._holder(context.object) is not None and super().poll(context)

    @classmethod
    def _holder(cls, owner: Any) -> Any:
        """What has the property: the object in later versions, what Blender's Cycles add-on keeps with it in earlier."""
        return owner if hasattr(owner, cls._OFFSET) else getattr(owner, "cycles", None)

    def draw(self, context: Any) -> None:
        self._column().prop(self._holder(context.object), self._OFFSET, text="Geometry Offset")


PANELS = (
    RAYLEAF_PT_ray_interpolation,
    RAYLEAF_PT_ray_interpolation_outcome,
    RAYLEAF_PT_object_ray_interpolation,
    RAYLEAF_PT_volume,
    RAYLEAF_PT_ray_visibility,
    RAYLEAF_PT_world_visibility,
    RAYLEAF_PT_shadow_terminator,
)
register, unregister = bpy.utils.register_classes_factory(PANELS)
