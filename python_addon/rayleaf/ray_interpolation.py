"""Ray interpolation as an artist sets it: of a scene, of an object, of a material, and its passes of a view layer."""

import math
from typing import Any

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, FloatVectorProperty, IntProperty, PointerProperty

from . import core_module
from .registration import registration_factory
from .setting_values import BYTES_PER_MEGABYTE, as_typed

MODES = (
    ("OFF", "Off", "Trace every ray"),
    ("AUTO", "Auto", "Interpolate rays against those objects where a probe of the frame shows that it is faster"),
    ("ON", "On", "Interpolate rays against every object that can have it"),
)
OBJECT_MODES = (("SCENE", "As Scene", "What the scene says"), *MODES)
VOLUME_KINDS = (
    ("EMISSION", "Emission", "The object glows by density times length"),
    ("ABSORPTION", "Absorption", "The object darkens what lies behind by density times length"),
)


def update_passes(_settings: Any, context: Any) -> None:
    context.view_layer.update_render_passes()


def _begin_with_those_in_force(settings: Any, _context: Any) -> None:
    """Ticked, Advanced changes nothing: its settings become those that the tolerance stood for."""
    if not settings.use_advanced:
        return
    try:
        in_force = core_module.load().RayInterpolation(error=as_typed(settings.error))
    except core_module.CoreError:
        return  # a render will say why
    settings.distance, settings.angle = in_force.distance_threshold, in_force.angle_threshold
    settings.depth, settings.rays_per_cell = in_force.depth_limit, in_force.rays_per_cell
    settings.cache_size = in_force.cache_bytes / BYTES_PER_MEGABYTE


class _Thresholds:
    """What scene and object both have."""

    error: FloatProperty(  # type: ignore
        name="Reflection Tolerance",
        description="Mean error that colours seen in a mirror or glass may have, on a scale from 0 to 1. "
        "Sets distance, angle and depth together; smaller is closer and slower",
        default=0.005,
        min=0.00001,
        max=1.0,
        soft_min=0.0005,
        soft_max=0.05,
        precision=4,
        step=0.1,
    )
    use_advanced: BoolProperty(  # type: ignore
        name="Advanced",
        description="Set distance, angle, depth, rays per cell and cache size one by one, beginning with those in force",
        default=False,
        update=_begin_with_those_in_force,
    )
    distance: FloatProperty(  # type: ignore
        name="Distance",
        description="Largest distance between true and interpolated ray, as a share of half the object's size",
        default=0.005,
        min=0.0,
        max=100.0,
        precision=4,
        step=0.1,
    )
    angle: FloatProperty(  # type: ignore
        name="Angle",
        description="Largest angle between rays that are blended. Smaller is closer and slower",
        default=math.radians(20.0),
        min=0.0,
        max=math.pi,
        subtype="ANGLE",
    )
    depth: IntProperty(  # type: ignore
        name="Depth",
        description="How often a cell of rays may be halved. More finds smaller details, and takes more memory",
        default=28,
        min=0,
        max=60,
    )
    rays_per_cell: FloatProperty(  # type: ignore
        name="Rays per Cell",
        description="How many of a frame's rays must cross a cell of rays to be worth its samples. What the frames of an "
        "animation see again is sampled in the end in any case: fewer make the first frames slower, and get there sooner",
        default=8.0,
        min=0.0,
        max=1e6,
        soft_min=1.0,
        soft_max=64.0,
    )
    cache_size: FloatProperty(  # type: ignore
        name="Cache Size",
        description="Megabytes that the rays of one object may take; less is slower, not different",
        default=100.0,
        min=0.0,
        max=1e6,
    )


class RayleafRayInterpolation(_Thresholds, bpy.types.PropertyGroup):
    """Of a scene."""

    mode: EnumProperty(  # type: ignore
        name="Ray Interpolation",
        description="Whether rays against smooth mirrors and glass are answered from rays traced before",
        items=MODES,
        default="OFF",
    )


class RayleafObjectRayInterpolation(_Thresholds, bpy.types.PropertyGroup):
    """Of an object, in place of the scene's."""

    mode: EnumProperty(  # type: ignore
        name="Ray Interpolation",
        description="Whether rays against this object are answered from rays traced before",
        items=OBJECT_MODES,
        default="SCENE",
    )
    use_own_error: BoolProperty(  # type: ignore
        name="Own Tolerance",
        description="Use another tolerance than the scene, for an object that shows its errors, or hides them",
        default=False,
    )


class RayleafObjectSettings(bpy.types.PropertyGroup):
    """What is set per object."""

    ray_interpolation: PointerProperty(type=RayleafObjectRayInterpolation)  # type: ignore
    use_subdivision_surface: BoolProperty(  # type: ignore
        name="Exact Subdivision",
        description="Render the limit of a Subdivision Surface modifier that is last in the stack, not Blender's mesh",
        default=True,
    )


class RayleafMaterialSettings(bpy.types.PropertyGroup):
    """What is set per material, beside its nodes."""

    use_volume: BoolProperty(  # type: ignore
        name="Volume Visualisation",
        description="Show how long rays are inside the object, as an x-ray does, in place of its surface",
        default=False,
    )
    volume_kind: EnumProperty(  # type: ignore
        name="Kind", description="Whether the object glows or darkens", items=VOLUME_KINDS, default="EMISSION"
    )
    volume_density: FloatProperty(  # type: ignore
        name="Density",
        description="How much it glows or darkens per unit of length",
        default=1.0,
        min=0.0,
        soft_max=10.0,
    )
    volume_color: FloatVectorProperty(  # type: ignore
        name="Color",
        description="Of the glow, or of what is left of light",
        subtype="COLOR",
        size=3,
        default=(1.0, 1.0, 1.0),
        min=0.0,
        soft_max=1.0,
    )


class RayleafViewLayerSettings(bpy.types.PropertyGroup):
    """The passes that Blender has no switch for."""

    use_pass_sample_count: BoolProperty(  # type: ignore
        name="Sample Count",
        description="How many samples each pixel took",
        default=False,
        update=update_passes,
    )
    # These four are Cycles' where it is enabled, so that its files find their passes.
    use_pass_volume_direct: BoolProperty(  # type: ignore
        name="Volume Direct", description="Light that volumes scatter straight from lights", update=update_passes
    )
    use_pass_volume_indirect: BoolProperty(  # type: ignore
        name="Volume Indirect", description="Light that volumes scatter after further bounces", update=update_passes
    )
    use_pass_shadow_catcher: BoolProperty(  # type: ignore
        name="Shadow Catcher",
        description="How much the other objects change the light on shadow catchers; Combined is without their shadow then",
        update=update_passes,
    )
    denoising_store_passes: BoolProperty(  # type: ignore
        name="Denoising Data",
        description="Normal, albedo and depth as denoisers want them: seen through mirrors and clear glass",
        update=update_passes,
    )
    use_pass_mask: BoolProperty(  # type: ignore
        name="Mask",
        description="How each pixel's ray was answered: 0 no interpolation, 1 traced, 2 interpolated, "
        "3 followed through convex glass, 4 missed without tracing",
        default=False,
        update=update_passes,
    )
    use_pass_mask_colors: BoolProperty(  # type: ignore
        name="Mask Colors",
        description="The mask as a picture: white traced, blue interpolated, orange followed through convex glass, "
        "dark grey missed without tracing",
        default=False,
        update=update_passes,
    )
    use_pass_error: BoolProperty(  # type: ignore
        name="Error",
        description="The estimated error of interpolated rays, as a share of half the object's size",
        default=False,
        update=update_passes,
    )
    use_pass_tree: BoolProperty(  # type: ignore
        name="Tree",
        description="The number of the tree that answers for the object in each pixel, as the statistics list them, "
        "from 1; objects that share a tree share the number; 0 without a tree",
        default=False,
        update=update_passes,
    )
    use_pass_path_length: BoolProperty(  # type: ignore
        name="Path Length",
        description="The length of rays inside objects with Volume Visualisation",
        default=False,
        update=update_passes,
    )
    use_pass_level: BoolProperty(  # type: ignore
        name="Level",
        description="How finely the surface was diced that each pixel's ray hit: 1, 2, 3 for 1, 4, 16 quads along a "
        "part's side, more where parts were split on demand; 0 elsewhere",
        default=False,
        update=update_passes,
    )
    use_pass_cache_misses: BoolProperty(  # type: ignore
        name="Cache Misses",
        description="How many tessellations each sample had to make, which the geometry cache did not hold",
        default=False,
        update=update_passes,
    )


CLASSES = (
    RayleafRayInterpolation,
    RayleafObjectRayInterpolation,
    RayleafObjectSettings,
    RayleafMaterialSettings,
    RayleafViewLayerSettings,
)


# The scene's settings are in properties.py.
register, unregister = registration_factory(
    CLASSES,
    {
        bpy.types.Object: RayleafObjectSettings,
        bpy.types.Material: RayleafMaterialSettings,
        bpy.types.ViewLayer: RayleafViewLayerSettings,
    },
)
