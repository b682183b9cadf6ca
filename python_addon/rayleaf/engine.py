"""Blender's RenderEngine: each method hands on."""

from typing import Any

import bpy

from . import core_module, enabling, failures, passes


class RayleafRenderEngine(bpy.types.RenderEngine):
    """Rayleaf in Blender's list of render engines."""

    bl_idname = "RAYLEAF"
    bl_label = "Rayleaf"
    bl_use_eevee_viewport = True
    bl_use_shading_nodes_custom = False

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)

    def render(self, depsgraph: Any) -> None:
        """Render one view layer of one frame. The core is loaded here first. Whatever goes wrong ends this render alone."""
        try:
            if enabling.problem is not None:
                raise core_module.CoreError(enabling.problem)
            core = core_module.load()
            from .animation import KEPT
            from .part_render import renderer

            ray_caches = KEPT.for_frame(core, depsgraph.scene_eval, self.is_animation)
            parts = KEPT.parts(core, depsgraph.scene_eval, self.is_animation)
            renderer()(self, depsgraph, core, ray_caches, parts).run()
        except Exception as error:
            failures.report(self, error)

    def update_render_passes(self, scene: Any, renderlayer: Any) -> None:
        """Tell Blender which passes come, for the compositor's sockets."""
        for entry in passes.enabled(renderlayer):
            self.register_pass(scene, renderlayer, entry.name, len(entry.channels), entry.channels, entry.socket_type)


def register() -> None:
    """Add the engine to Blender's list."""
    bpy.utils.register_class(RayleafRenderEngine)


def unregister() -> None:
    """Take it away."""
    bpy.utils.unregister_class(RayleafRenderEngine)
