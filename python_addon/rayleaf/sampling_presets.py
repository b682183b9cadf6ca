"""Presets of sampling and bounces, and the settings of Cycles taken over."""

from typing import Any

import bpy
from bpy.props import EnumProperty

_KINDS = ("diffuse", "glossy", "transmission", "transparent", "volume")
_BOUNCES = ("max_bounces", *(f"{kind}_bounces" for kind in _KINDS))
_OF_PRESETS = ("samples", "preview_samples", "roulette_start", "clamp_indirect", *_BOUNCES)
# What a preset sets beside the defaults.
PRESETS: dict[str, dict[str, float]] = {
    "PREVIEW": {
        **{"samples": 16, "preview_samples": 8, "roulette_start": 2, "max_bounces": 6, "diffuse_bounces": 2},
        **{"glossy_bounces": 2, "transmission_bounces": 6},
    },
    "DEFAULT": {},
    "FINAL": {
        **{"samples": 512, "preview_samples": 64, "roulette_start": 4, "clamp_indirect": 0.0, "max_bounces": 24},
        **{"diffuse_bounces": 8, "glossy_bounces": 8, "transmission_bounces": 24, "transparent_bounces": 32},
        **{"volume_bounces": 4},
    },
}
_ITEMS = (
    ("PREVIEW", "Preview", "Few samples and bounces: seconds instead of minutes, with noise"),
    ("DEFAULT", "Default", "What a new scene has"),
    ("FINAL", "Final", "Many samples and bounces, nothing clamped: calm and complete, and slow"),
)

# Cycles' settings of a scene -> Rayleaf's with the same meaning and unit.
FROM_CYCLES = {
    "samples": "samples",
    "preview_samples": "preview_samples",
    "use_adaptive_sampling": "use_noise_threshold",
    "adaptive_threshold": "noise_threshold",
    "adaptive_min_samples": "least_samples",
    "time_limit": "time_limit",
    "use_denoising": "use_denoising",
    "use_preview_denoising": "use_preview_denoising",
    "denoising_input_passes": "denoising_input_passes",
    "denoising_prefilter": "denoising_prefilter",
    "seed": "seed",
    "use_animated_seed": "use_animated_seed",
    "max_bounces": "max_bounces",
    "diffuse_bounces": "diffuse_bounces",
    "glossy_bounces": "glossy_bounces",
    "transmission_bounces": "transmission_bounces",
    "transparent_max_bounces": "transparent_bounces",
    "volume_bounces": "volume_bounces",
    "sample_clamp_direct": "clamp_direct",
    "sample_clamp_indirect": "clamp_indirect",
    "blur_glossy": "filter_glossy",
    "caustics_reflective": "use_reflective_caustics",
    "caustics_refractive": "use_refractive_caustics",
    "film_exposure": "film_exposure",
    "pixel_filter_type": "filter_type",
    "filter_width": "filter_width",
    "dicing_rate": "tessellation_factor",
}
_STRAND_SHAPES = {"RIBBONS": "RIBBON", "THICK": "ROUND"}


class RAYLEAF_OT_preset(bpy.types.Operator):
    """Set samples, bounces and clamping together"""

    bl_idname = "rayleaf.preset"
    bl_label = "Use Preset"
    bl_options = {"REGISTER", "UNDO"}

    preset: EnumProperty(  # type: ignore
        name="Preset", description="How much time a picture may take", items=_ITEMS, default="DEFAULT"
    )

    def execute(self, context: Any) -> set[str]:
        settings, chosen = context.scene.rayleaf, PRESETS[self.preset]
        for name in _OF_PRESETS:
            setattr(settings, name, chosen.get(name, settings.bl_rna.properties[name].default))
        return {"FINISHED"}


class RAYLEAF_OT_copy_cycles_settings(bpy.types.Operator):
    """Take sampling, bounces, clamping, caustics, exposure, pixel filter, dicing rate and hair shape from Cycles' settings"""

    bl_idname = "rayleaf.copy_cycles_settings"
    bl_label = "Copy Settings from Cycles"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context: Any) -> set[str]:
        scene = context.scene
        theirs = getattr(scene, "cycles", None)
        if theirs is None:
            self.report(
                {"ERROR"}, "The Cycles add-on is off, so its settings cannot be read; enable it in the preferences"
            )
            return {"CANCELLED"}
        for name, ours in FROM_CYCLES.items():
            if hasattr(theirs, name):
                setattr(scene.rayleaf, ours, getattr(theirs, name))
        shape = getattr(getattr(scene, "cycles_curves", None), "shape", None)
        if shape in _STRAND_SHAPES:
            scene.rayleaf.strand_shape = _STRAND_SHAPES[shape]
        return {"FINISHED"}


CLASSES = (RAYLEAF_OT_preset, RAYLEAF_OT_copy_cycles_settings)
register, unregister = bpy.utils.register_classes_factory(CLASSES)
