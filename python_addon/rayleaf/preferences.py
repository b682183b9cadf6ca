"""Rayleaf's page in Blender's preferences: what it is made of, whether it works here."""

from typing import Any

import bpy

from . import __version__, core_module, enabling, self_test
from .messages import wrapped

_SELF_TEST = "rayleaf.self_test"


class RAYLEAF_OT_self_test(bpy.types.Operator):
    """Render three triangles whose picture is known, and say whether it came out right"""

    bl_idname = _SELF_TEST
    bl_label = "Self-Test"

    def execute(self, _context: Any) -> set[str]:
        problem = self_test.run()
        enabling.problem = problem
        if problem:
            self.report({"ERROR"}, problem)
            return {"CANCELLED"}
        self.report({"INFO"}, "Rayleaf works in this Blender")
        return {"FINISHED"}


class RayleafPreferences(bpy.types.AddonPreferences):
    """The page. It loads no core: what the core says of itself is shown once it is there."""

    bl_idname = __package__

    def draw(self, context: Any) -> None:
        column = self.layout.column()
        for line in lines(context.scene.render):
            column.label(text=line)
        if enabling.problem:
            box = self.layout.box()
            box.alert = True
            for number, line in enumerate(wrapped(enabling.problem)):
                box.label(text=line, icon="BLANK1" if number else "ERROR")
        row = self.layout.row()
        row.operator(_SELF_TEST)
        if hasattr(bpy.types, "RAYLEAF_OT_measure_settings"):
            row.operator("rayleaf.measure_settings", text="Find Best Settings")


def lines(render: Any) -> list[str]:
    """Version, parts, threads."""
    core = core_module.loaded()
    built = (
        ", ".join(f"{name} {number}" for name, number in core.built_with.items())
        if core
        else "shown after the self-test"
    )
    threads = f"{render.threads}, " + (
        "as set" if render.threads_mode == "FIXED" else "one for each of the processor's"
    )
    return [
        f"Version: {__version__}",
        f"Core: {core_module.path()}",
        f"Built with: {built}",
        f"Threads: {threads} in Render Properties > Performance",
    ]


CLASSES = (RAYLEAF_OT_self_test, RayleafPreferences)
register, unregister = bpy.utils.register_classes_factory(CLASSES)
