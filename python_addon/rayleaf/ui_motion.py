"""The panels of motion blur: Blender's own settings, and those that Cycles keeps."""

from typing import Any

import bpy

from .ui import _Panel


class RAYLEAF_PT_motion_blur(_Panel, bpy.types.Panel):
    """Motion blur of final renders."""

    bl_label = "Motion Blur"
    bl_context = "render"
    bl_options = {"DEFAULT_CLOSED"}

    def draw_header(self, context: Any) -> None:
        self.layout.prop(context.scene.render, "use_motion_blur", text="")

    def draw(self, context: Any) -> None:
        scene, column = context.scene, self._column()
        column.active = scene.render.use_motion_blur
        kept = scene.render if hasattr(scene.render, "motion_blur_position") else getattr(scene, "cycles", None)
        if kept is not None:
            column.prop(kept, "motion_blur_position", text="Position")
        column.prop(scene.render, "motion_blur_shutter")
        if hasattr(scene, "cycles"):
            column.prop(scene.cycles, "rolling_shutter_type", text="Rolling Shutter")
            row = column.row()
            row.active = scene.cycles.rolling_shutter_type != "NONE"
            row.prop(scene.cycles, "rolling_shutter_duration", text="Rolling Shutter Duration")


class RAYLEAF_PT_shutter_curve(_Panel, bpy.types.Panel):
    """How far the shutter is open, by time."""

    bl_label = "Shutter Curve"
    bl_parent_id = "RAYLEAF_PT_motion_blur"
    bl_context = "render"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: Any) -> None:
        render = context.scene.render
        self.layout.active = render.use_motion_blur
        self.layout.template_curve_mapping(render, "motion_blur_shutter_curve")


class RAYLEAF_PT_object_motion_blur(_Panel, bpy.types.Panel):
    """Whether an object or a camera is blurred, and how closely its motion is followed."""

    bl_label = "Motion Blur"
    bl_context = "object"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context: Any) -> bool:
        shown = context.object is not None and hasattr(context.object, "cycles")
        return shown and context.scene.render.use_motion_blur and super().poll(context)

    def draw_header(self, context: Any) -> None:
        self.layout.prop(context.object.cycles, "use_motion_blur", text="")

    def draw(self, context: Any) -> None:
        column = self._column()
        column.active = context.object.cycles.use_motion_blur
        column.prop(context.object.cycles, "motion_steps", text="Steps")
        if context.object.type != "CAMERA":
            column.prop(context.object.cycles, "use_deform_motion", text="Deformation")


CLASSES = (RAYLEAF_PT_motion_blur, RAYLEAF_PT_shutter_curve, RAYLEAF_PT_object_motion_blur)
register, unregister = bpy.utils.register_classes_factory(CLASSES)
