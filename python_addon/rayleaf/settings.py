"""A scene's settings as the core's."""

from types import ModuleType
from typing import Any

from . import versions
from .export import ray_interpolation
from .export.camera import CropRectangle, Frame
from .passes import Pass, Slots

_LARGEST_SEED = 0xFFFFFFFF  # frames before the first count down from here


# Of a pixel, where an error is set in place of their number.
_MOST_SAMPLES = 1 << 18
_MIST_FALLOFF = {"QUADRATIC": 2.0, "LINEAR": 1.0, "INVERSE_QUADRATIC": 0.5}  # exponents


def _mist(world: Any) -> dict[str, float]:
    """Where the world's mist begins and how deep it is; without a world, nowhere in particular."""
    if world is None:
        return {}
    mist = world.mist_settings
    return dict(mist_start=mist.start, mist_depth=mist.depth, mist_falloff=_MIST_FALLOFF[mist.falloff])


def _film_glass_roughness(scene: Any) -> float:
    """Up to which roughness glass shows no world where the film is transparent; -1: all shows it."""
    if not versions.cycles_setting(scene, "film_transparent_glass", False):
        return -1.0
    return float(versions.cycles_setting(scene, "film_transparent_roughness", 0.1))


def counted_samples(scene: Any, view_layer: Any) -> int:
    """Of a pixel, where no error is set."""
    return int(view_layer.samples or scene.rayleaf.samples)


def core_settings(
    core: ModuleType, scene: Any, view_layer: Any, frame: Frame, crop: CropRectangle, passes: list[Pass]
) -> dict[str, Any]:
    """The keyword arguments of the core's Settings. A view layer may have a number of samples of its own."""
    own, render = scene.rayleaf, scene.render
    return dict(
        width=frame.width,
        height=frame.height,
        crop_x=crop.x,
        crop_y=crop.y,
        crop_width=crop.width,
        crop_height=crop.height,
        samples=_MOST_SAMPLES if own.target_error > 0.0 else counted_samples(scene, view_layer),
        target_error=own.target_error,
        noise_threshold=own.noise_threshold if own.use_noise_threshold else 0.0,
        least_samples=own.least_samples,
        time_limit=own.time_limit,
        seed=(own.seed + (scene.frame_current if own.use_animated_seed else 0)) & _LARGEST_SEED,
        threads=render.threads if render.threads_mode == "FIXED" else 0,
        max_bounces=own.max_bounces,
        diffuse_bounces=own.diffuse_bounces,
        glossy_bounces=own.glossy_bounces,
        transmission_bounces=own.transmission_bounces,
        transparent_bounces=own.transparent_bounces,
        volume_bounces=own.volume_bounces,
        roulette_start=own.roulette_start,
        shadow_bias=own.shadow_bias,
        clamp_direct=own.clamp_direct,
        clamp_indirect=own.clamp_indirect,
        filter_glossy=own.filter_glossy,
        reflective_caustics=own.use_reflective_caustics,
        refractive_caustics=own.use_refractive_caustics,
        film_transparent=render.film_transparent,
        film_glass_roughness=_film_glass_roughness(scene),
        **_mist(scene.world),
        filter=own.filter_type,
        filter_width=own.filter_width,
        exposure=own.film_exposure,
        ray_interpolation=ray_interpolation.of_scene(core, own.ray_interpolation),
        integrator=own.integrator,
        glossy_rays=own.glossy_rays,
        light_rays=own.light_rays,
        hemisphere_rays=own.hemisphere_rays,
        indirect=own.indirect,
        # It holds the light of all groups together.
        irradiance_cache=own.use_irradiance_cache and not Slots.of(view_layer).light_groups,
        irradiance_error=own.irradiance_error,
        occlusion_distance=own.occlusion_distance,
        resident_megabytes=own.facet_memory,
        geometry_cache_megabytes=own.geometry_cache_size,
        tessellation_factor=own.tessellation_factor,
        stochastic_levels=own.use_stochastic_levels,
        geometry_cache_mode=own.geometry_cache_mode,
        importance_levels=own.use_importance_levels,
        least_mirrored_spread=own.least_mirrored_spread,
        passes=[entry.identifier for entry in passes],
    )
