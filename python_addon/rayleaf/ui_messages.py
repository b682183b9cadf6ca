"""The panel of what the last render left out or replaced; a click selects what a warning is about."""

import textwrap
from typing import Any

import bpy
from bpy.props import StringProperty

from . import kept_messages, subjects
from .messages import Message, Subject
from .ui import _Panel

_MOST_LISTED = 20
_CHARACTER = 7.0  # pixels that a letter takes, at a user interface's scale of 1
_MARGIN = 60.0  # pixels beside the text
_ICONS = {
    "Object": "OBJECT_DATA",
    "Light": "LIGHT",
    "Camera": "CAMERA_DATA",
    "Material": "MATERIAL",
    "World": "WORLD",
    "Image": "IMAGE_DATA",
    "Scene": "SCENE_DATA",
    "View layer": "RENDERLAYERS",
}


class RAYLEAF_OT_select_subject(bpy.types.Operator):
    """Select the object, and in its material the node, that this warning is about"""

    bl_idname = "rayleaf.select_subject"
    bl_label = "Select What Is Meant"
    bl_options = {"INTERNAL", "UNDO"}

    kind: StringProperty()  # type: ignore
    name: StringProperty()  # type: ignore
    node: StringProperty()  # type: ignore

    def execute(self, context: Any) -> set[str]:
        subject = Subject(self.kind, self.name, self.node)
        if not subjects.select(context, bpy.data, subject):
            self.report({"INFO"}, f"{subject} is not in this view layer")
            return {"CANCELLED"}
        return {"FINISHED"}


def _line_length(context: Any) -> int:
    """Characters that a line of the panel has room for."""
    scale = context.preferences.system.ui_scale
    return max(20, int((context.region.width - _MARGIN * scale) / (_CHARACTER * scale)))


def _draw_message(layout: Any, message: Message, length: int) -> None:
    column = layout.box().column(align=True)
    text, about = message.text, message.about
    if about is not None:
        row = column.row()
        row.alignment = "LEFT"
        icon = _ICONS.get(about.kind, "DOT")  # tells the kind, so that names have room
        label = f"{about.name} / {about.node}" if about.node else about.name
        if about.kind in subjects.SELECTABLE:
            button = row.operator(RAYLEAF_OT_select_subject.bl_idname, text=label, icon=icon, emboss=False)
            button.kind, button.name, button.node = about.kind, about.name, about.node
        else:
            row.label(text=label, icon=icon)
        text = text.removeprefix(f"{about}: ")
    icons = ["CANCEL" if message.kind == "ERROR" else "ERROR"]
    for line in textwrap.wrap(text, length):
        column.label(text=line, icon=icons.pop() if icons else "BLANK1")


class RAYLEAF_PT_messages(_Panel, bpy.types.Panel):
    """What the last render left out, replaced, or failed by."""

    bl_label = "Warnings"

    @classmethod
    def poll(cls, context: Any) -> bool:
        return bool(kept_messages.kept()) and super().poll(context)

    def draw_header_preset(self, _context: Any) -> None:
        self.layout.label(text=str(len(kept_messages.kept())))

    def draw(self, context: Any) -> None:
        column, length = self.layout.column(), _line_length(context)
        found = kept_messages.kept()
        for message in found[:_MOST_LISTED]:
            _draw_message(column, message, length)
        if len(found) > _MOST_LISTED:
            column.label(text=f"and {len(found) - _MOST_LISTED} more, in the Info editor")


CLASSES = (RAYLEAF_OT_select_subject, RAYLEAF_PT_messages)
register, unregister = bpy.utils.register_classes_factory(CLASSES)
