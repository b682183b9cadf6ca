"""Panels: Rayleaf's own, and Blender's that suit it."""

from collections.abc import Iterator
from typing import Any

import bpy

from . import sampling_presets

ENGINE = "RAYLEAF"

# Blender's panels that any engine may take carry this engine's name.
_FOR_ANY_ENGINE = "BLENDER_RENDER"
# Of those, the ones that show what Rayleaf has not, or shows in panels of its own.
_UNSUITABLE = {
    "DATA_PT_area",
    "DATA_PT_falloff_curve",
    "DATA_PT_light",
    "DATA_PT_spot",
    "NODE_DATA_PT_light",
    "RENDER_PT_freestyle",
    "MATERIAL_PT_freestyle_line",
}
_UNSUITABLE_PREFIX = ("VIEWLAYER_PT_freestyle", "DATA_PT_lightprobe", "TEXTURE_PT_")
# Panels meant for other engines that suit as they are: nodes of materials and worlds, depth of field.
_SUITABLE = {
    "EEVEE_MATERIAL_PT_context_material",
    "EEVEE_MATERIAL_PT_surface",
    "EEVEE_WORLD_PT_mist",
    "EEVEE_WORLD_PT_surface",
    "DATA_PT_camera_dof",
    "MATERIAL_PT_preview",
    "DATA_PT_camera_dof_aperture",
}


def _subclasses(base: type) -> Iterator[type]:
    for subclass in base.__subclasses__():
        yield subclass
        yield from _subclasses(subclass)


def blender_panels() -> list[Any]:
    """Blender's own panels that Rayleaf shows."""
    chosen = []
    for panel in _subclasses(bpy.types.Panel):
        engines, name = getattr(panel, "COMPAT_ENGINES", None), panel.__name__
        if engines is None or not panel.__module__.startswith("bl_ui."):
            continue
        general = _FOR_ANY_ENGINE in engines and name not in _UNSUITABLE and not name.startswith(_UNSUITABLE_PREFIX)
        if general or name in _SUITABLE:
            chosen.append(panel)
    return chosen


class _Panel:
    """What Rayleaf's panels share: their place, and that they show only with Rayleaf chosen."""

    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "render"
    COMPAT_ENGINES = {ENGINE}

    @classmethod
    def poll(cls, context: Any) -> bool:
        return context.engine in cls.COMPAT_ENGINES

    def _column(self) -> Any:
        layout = self.layout  # type: ignore[attr-defined]
        layout.use_property_split = True
        layout.use_property_decorate = False
        return layout.column()


class RAYLEAF_PT_sampling(_Panel, bpy.types.Panel):
    """How many paths, and their random numbers."""

    bl_label = "Sampling"

    def draw(self, context: Any) -> None:
        column, settings = self._column(), context.scene.rayleaf
        presets = column.row(align=True)
        for name in sampling_presets.PRESETS:
            presets.operator("rayleaf.preset", text=name.title()).preset = name
        column.prop(settings, "target_error")
        counted = column.column()
        counted.active = settings.target_error == 0.0
        counted.prop(settings, "samples", text="Max Samples" if settings.use_noise_threshold else "Samples")
        counted.prop(settings, "use_noise_threshold")
        adaptive = counted.column()
        adaptive.active = settings.use_noise_threshold
        adaptive.prop(settings, "noise_threshold")
        adaptive.prop(settings, "least_samples")
        column.prop(settings, "time_limit")
        column.prop(settings, "preview_samples")
        column.prop(settings, "use_denoising")
        column.prop(settings, "use_preview_denoising")
        denoising = column.column()
        denoising.active = settings.use_denoising or settings.use_preview_denoising
        denoising.prop(settings, "denoising_input_passes")
        denoising.prop(settings, "denoising_prefilter")
        row = column.row(align=True)
        row.prop(settings, "seed")
        row.prop(settings, "use_animated_seed", text="", icon="TIME")
        column.operator("rayleaf.copy_cycles_settings")


class RAYLEAF_PT_integrator(_Panel, bpy.types.Panel):
    """How light is gathered."""

    bl_label = "Integrator"

    def draw(self, context: Any) -> None:
        column, settings = self._column(), context.scene.rayleaf
        column.prop(settings, "integrator", text="Integrator")
        if settings.integrator == "DISTRIBUTION":
            rays = column.column(align=True, heading="Rays")
            rays.prop(settings, "glossy_rays", text="Glossy")
            rays.prop(settings, "light_rays", text="Shadow")
            rays.prop(settings, "hemisphere_rays", text="Diffuse")
            column.prop(settings, "indirect")
            column.prop(settings, "use_irradiance_cache")
            error = column.row()
            error.enabled = settings.use_irradiance_cache
            error.prop(settings, "irradiance_error")
        column.prop(settings, "occlusion_distance")


class RAYLEAF_PT_light_paths(_Panel, bpy.types.Panel):
    """How far light is followed."""

    bl_label = "Light Paths"

    def draw(self, context: Any) -> None:
        column, settings = self._column(), context.scene.rayleaf
        bounces = column.column(align=True, heading="Max Bounces")
        bounces.prop(settings, "max_bounces")
        bounces.prop(settings, "diffuse_bounces")
        bounces.prop(settings, "glossy_bounces")
        bounces.prop(settings, "transmission_bounces")
        bounces.prop(settings, "transparent_bounces")
        bounces.prop(settings, "volume_bounces")
        column.prop(settings, "roulette_start")
        column.prop(settings, "shadow_bias")
        clamping = column.column(align=True, heading="Clamping")
        clamping.prop(settings, "clamp_direct", text="Clamp Direct")
        clamping.prop(settings, "clamp_indirect", text="Clamp Indirect")
        column.prop(settings, "filter_glossy")
        caustics = column.column(align=True, heading="Caustics")
        caustics.prop(settings, "use_reflective_caustics")
        caustics.prop(settings, "use_refractive_caustics")


class RAYLEAF_PT_film(_Panel, bpy.types.Panel):
    """From light to pixels."""

    bl_label = "Film"

    def draw(self, context: Any) -> None:
        column, settings = self._column(), context.scene.rayleaf
        column.prop(settings, "film_exposure")
        column.prop(context.scene.render, "film_transparent")
        if hasattr(context.scene, "cycles"):
            glass = column.column()
            glass.active = context.scene.render.film_transparent
            glass.prop(context.scene.cycles, "film_transparent_glass", text="Transparent Glass")
            threshold = glass.column()
            threshold.active = context.scene.cycles.film_transparent_glass
            threshold.prop(context.scene.cycles, "film_transparent_roughness", text="Roughness Threshold")
        column.prop(settings, "filter_type")
        row = column.row()
        row.active = settings.filter_type != "BOX"
        row.prop(settings, "filter_width")


class RAYLEAF_PT_curves(_Panel, bpy.types.Panel):
    """What hair is."""

    bl_label = "Hair"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: Any) -> None:
        column, settings = self._column(), context.scene.rayleaf
        column.prop(settings, "strand_shape")


class RAYLEAF_PT_subdivision(_Panel, bpy.types.Panel):
    """Whether subdivided meshes are rendered as their limits."""

    bl_label = "Subdivision"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: Any) -> None:
        self._column().prop(context.scene.rayleaf, "use_subdivision_surfaces")


class RAYLEAF_PT_object_subdivision(_Panel, bpy.types.Panel):
    """The same for one object."""

    bl_label = "Subdivision"
    bl_context = "object"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context: Any) -> bool:
        return context.object is not None and context.object.type == "MESH" and super().poll(context)

    def draw(self, context: Any) -> None:
        column = self._column()
        column.active = context.scene.rayleaf.use_subdivision_surfaces
        column.prop(context.object.rayleaf, "use_subdivision_surface")


class RAYLEAF_PT_performance(_Panel, bpy.types.Panel):
    """What the machine gives."""

    bl_label = "Performance"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: Any) -> None:
        column, render = self._column(), context.scene.render
        column.prop(render, "threads_mode")
        threads = column.row()
        threads.enabled = render.threads_mode == "FIXED"
        threads.prop(render, "threads")
        column.prop(context.scene.rayleaf, "texture_memory")


class RAYLEAF_PT_tessellation(_Panel, bpy.types.Panel):
    """How finely surfaces are diced, and what is kept of it."""

    bl_label = "Tessellation"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: Any) -> None:
        column, settings = self._column(), context.scene.rayleaf
        column.prop(settings, "tessellation_factor")
        column.prop(settings, "facet_memory")
        size = column.row()
        size.active = settings.geometry_cache_mode != "NONE"
        size.prop(settings, "geometry_cache_size")
        levels = column.column()
        levels.active = settings.geometry_cache_mode != "SINGLE"
        levels.prop(settings, "use_stochastic_levels")


class RAYLEAF_PT_light(_Panel, bpy.types.Panel):
    """A lamp."""

    bl_label = "Light"
    bl_context = "data"

    @classmethod
    def poll(cls, context: Any) -> bool:
        return context.light is not None and super().poll(context)

    def draw(self, context: Any) -> None:
        light = context.light
        self.layout.row().prop(light, "type", expand=True)
        column = self._column()
        column.prop(light, "color")
        column.prop(light, "energy", text="Strength" if light.type == "SUN" else "Power")
        if light.type in ("POINT", "SPOT"):
            column.prop(light, "shadow_soft_size", text="Radius")
        elif light.type == "SUN":
            column.prop(light, "angle")
        else:
            self._draw_area(column, light)
        column.prop(light, "use_shadow", text="Cast Shadow")

    @staticmethod
    def _draw_area(column: Any, light: Any) -> None:
        column.prop(light, "shape")
        size = column.column(align=True)
        if light.shape in ("RECTANGLE", "ELLIPSE"):
            size.prop(light, "size", text="Size X")
            size.prop(light, "size_y", text="Y")
        else:
            size.prop(light, "size")
        column.prop(light, "spread")


class RAYLEAF_PT_light_spot(_Panel, bpy.types.Panel):
    """A spot lamp's cone."""

    bl_label = "Beam Shape"
    bl_context = "data"
    bl_parent_id = "RAYLEAF_PT_light"

    @classmethod
    def poll(cls, context: Any) -> bool:
        return context.light is not None and context.light.type == "SPOT" and super().poll(context)

    def draw(self, context: Any) -> None:
        column = self._column()
        column.prop(context.light, "spot_size", text="Spot Size")
        column.prop(context.light, "spot_blend", text="Blend", slider=True)
        column.prop(context.light, "show_cone")


class RAYLEAF_PT_light_nodes(_Panel, bpy.types.Panel):
    """A lamp's nodes: an Emission node tints and scales its light."""

    bl_label = "Nodes"
    bl_context = "data"

    @classmethod
    def poll(cls, context: Any) -> bool:
        return context.light is not None and super().poll(context)

    def draw(self, context: Any) -> None:
        light = context.light
        column = self._column()
        column.prop(light, "use_nodes", icon="NODETREE")
        output = light.node_tree.get_output_node("ALL") if light.use_nodes and light.node_tree else None
        if output is not None:
            column.template_node_view(light.node_tree, output, output.inputs["Surface"])


PANELS = (
    RAYLEAF_PT_sampling,
    RAYLEAF_PT_integrator,
    RAYLEAF_PT_light_paths,
    RAYLEAF_PT_film,
    RAYLEAF_PT_curves,
    RAYLEAF_PT_subdivision,
    RAYLEAF_PT_object_subdivision,
    RAYLEAF_PT_performance,
    RAYLEAF_PT_tessellation,
    RAYLEAF_PT_light,
    RAYLEAF_PT_light_spot,
    RAYLEAF_PT_light_nodes,
)


def register() -> None:
    """Show the panels."""
    for panel in PANELS:
        bpy.utils.register_class(panel)
    for panel in blender_panels():
        panel.COMPAT_ENGINES.add(ENGINE)


def unregister() -> None:
    """Take them away."""
    for panel in blender_panels():
        panel.COMPAT_ENGINES.discard(ENGINE)
    for panel in reversed(PANELS):
        bpy.utils.unregister_class(panel)
