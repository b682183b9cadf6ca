"""What artists set for ray interpolation and volume visualisation, as the core's."""

from types import ModuleType
from typing import Any

from ..setting_values import BYTES_PER_MEGABYTE, as_typed

AS_SCENE = "SCENE"


def _thresholds(settings: Any) -> dict[str, Any]:
    values: dict[str, Any] = {"error": as_typed(settings.error), "cache_bytes": None}
    if settings.use_advanced:
        values.update(
            distance_threshold=as_typed(settings.distance),
            angle_threshold=settings.angle,
            depth_limit=settings.depth,
            cache_bytes=int(settings.cache_size * BYTES_PER_MEGABYTE),
            rays_per_cell=settings.rays_per_cell,
        )
    return values


def of_scene(core: ModuleType, settings: Any) -> Any:
    """The core's settings for objects without their own."""
    return core.RayInterpolation(mode=settings.mode, **_thresholds(settings))


def of_object(core: ModuleType, settings: Any, scene_settings: Any) -> Any | None:
    """Those of one object; None where it goes by the scene's."""
    mode = scene_settings.mode if settings.mode == AS_SCENE else settings.mode
    if settings.mode == AS_SCENE and not settings.use_own_error:
        return None
    thresholds = _thresholds(settings if settings.use_own_error else scene_settings)
    return core.RayInterpolation(mode=mode, **thresholds)


def volume_of(core: ModuleType, settings: Any) -> Any | None:
    """What a material shows of the length of rays; None for a surface."""
    if not settings.use_volume:
        return None
    return core.VolumeVisualisation(
        kind=settings.volume_kind, density=settings.volume_density, color=tuple(settings.volume_color)
    )
