"""Which pass a view shows."""

from typing import Any

import bpy
from bpy.props import EnumProperty

from .. import passes
from ..registration import registration_factory

# Passes that are pictures or look like one; the others hold places and numbers of any size.
_LEFT_OUT = ("depth", "position")


def _items() -> list[tuple[str, str, str]]:
    shown = [entry for entry in passes.table() if entry.identifier not in _LEFT_OUT and not entry.is_hidden]
    return [(entry.identifier, _label(entry), entry.meaning.capitalize()) for entry in shown]


def _label(entry: passes.Pass) -> str:
    kind = entry.group if entry.switch.endswith(("_direct", "_indirect", "_color")) else ""
    return f"{kind} {entry.label}".strip()


class RayleafShadingSettings(bpy.types.PropertyGroup):
    """What is set per 3-D view."""

    render_pass: EnumProperty(  # type: ignore
        name="Pass", description="What the view shows in Rendered shading", items=_items(), default="combined"
    )


def entry_of(space: Any) -> passes.Pass:
    """The pass that a view shows."""
    chosen = space.shading.rayleaf.render_pass
    return next(entry for entry in passes.table() if entry.identifier == chosen)


class RAYLEAF_PT_shading_pass(bpy.types.Panel):
    """Among the options of a view's shading."""

    bl_label = "Render Pass"
    bl_space_type = "VIEW_3D"
    bl_region_type = "HEADER"
    bl_parent_id = "VIEW3D_PT_shading"

    @classmethod
    def poll(cls, context: Any) -> bool:
        return bool(context.engine == "RAYLEAF" and context.space_data.shading.type == "RENDERED")

    def draw(self, context: Any) -> None:
        self.layout.prop(context.space_data.shading.rayleaf, "render_pass", text="")


register, unregister = registration_factory(
    (RayleafShadingSettings, RAYLEAF_PT_shading_pass), {bpy.types.View3DShading: RayleafShadingSettings}
)
