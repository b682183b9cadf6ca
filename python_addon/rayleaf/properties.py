"""The settings that an artist sees, as `scene.rayleaf`. Meanings and units: core/scene/settings.h."""

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, PointerProperty

from . import ray_interpolation
from .light_paths import LightPaths
from .ray_interpolation import update_passes
from .registration import registration_factory

FILTERS = (
    ("BOX", "Box", "Every sample of a pixel counts alike"),
    ("GAUSSIAN", "Gaussian", "Bell-shaped"),
    ("BLACKMAN_HARRIS", "Blackman-Harris", "Smooth and compact; the default"),
)
INTEGRATORS = (
    ("PATH", "Path Tracing", "One ray goes on from each surface; all light, with noise that more samples remove"),
    (
        "DISTRIBUTION",
        "Distribution Ray Tracing",
        "Many rays go on from each surface the camera sees, few beyond; at most one diffuse bounce",
    ),
)
INDIRECT = (
    ("NONE", "None", "Surfaces are lit straight from lights and the world"),
    ("AMBIENT_OCCLUSION", "Ambient Occlusion", "The world lights what nothing nearby hides from it"),
    ("COLOR_BLEEDING", "Color Bleeding", "Light by way of one more diffuse surface as well"),
)

DENOISING_PASSES = (
    ("RGB", "None", "The picture alone"),
    ("RGB_ALBEDO", "Albedo", "Colours of surfaces as well"),
    ("RGB_ALBEDO_NORMAL", "Albedo and Normal", "Colours and directions of surfaces as well"),
)
DENOISING_PREFILTERS = (
    ("NONE", "None", "Take them as they are: right where they have no noise"),
    ("FAST", "Fast", "Denoise them together with the picture"),
    ("ACCURATE", "Accurate", "Denoise them first; the best picture"),
)
CACHE_MODES = (
    ("MULTI", "Three Resolutions", "Each ray sees facets as fine as its width needs"),
    ("SINGLE", "One Resolution", "All rays see fine facets; to compare"),
    ("NONE", "No Cache", "Three resolutions, made anew for each ray; to compare"),
)

STRAND_SHAPES = (
    ("ROUND", "Round", "Closed tubes with round ends, exact at any distance"),
    ("RIBBON", "Ribbon", "Flat bands that face the ray, shaded as if round"),
)
CURVE_PRIMITIVES = (
    ("EXACT", "Exact", "Hair as its shape says, bevelled curves from their definition"),
    ("RIBBON", "Ribbon", "Flat bands that face the ray"),
    ("SPHERES", "Spheres", "Chains of balls"),
    ("TRIANGLES", "Triangles", "Tubes of triangles"),
    ("QUADS", "Quads", "Tubes of quadrangles"),
    ("EMBREE_ROUND", "Embree", "Embree's own round curves"),
)

_TARGET_ERROR = (
    "The error that the picture may have, in colours from 0 to 1: sets samples, interpolated rays and facets. It is "
    "estimated, no bound. 0: off"
)
_SHARES = dict(default=0.0, min=0.0, soft_max=0.1, max=1.0, precision=4, step=0.1)


class RayleafSceneSettings(LightPaths, bpy.types.PropertyGroup):
    """What is set per scene."""

    samples: IntProperty(  # type: ignore
        name="Samples",
        description="Paths per pixel of a final render. Raise it where the picture is noisy: four times as many halve the"
        " noise. Powers of two are spread most evenly",
        default=64,
        min=1,
        max=1 << 20,
    )
    use_denoising: BoolProperty(  # type: ignore
        name="Denoise",
        description="Remove the noise of the finished picture by Open Image Denoise; the pass Noisy Image keeps it. Smooths"
        " fine detail where samples are few",
        default=False,
        update=update_passes,
    )
    denoising_input_passes: EnumProperty(  # type: ignore
        name="Passes",
        description="What the denoiser sees beside the picture; more keeps more detail",
        items=DENOISING_PASSES,
        default="RGB_ALBEDO_NORMAL",
    )
    denoising_prefilter: EnumProperty(  # type: ignore
        name="Prefilter",
        description="How noise in those passes is dealt with",
        items=DENOISING_PREFILTERS,
        default="ACCURATE",
    )
    use_preview_denoising: BoolProperty(  # type: ignore
        name="Denoise View",
        description="Remove the noise of pictures in the 3-D view, too",
        default=False,
    )
    target_error: FloatProperty(name="Target Error", description=_TARGET_ERROR, **_SHARES)  # type: ignore
    use_noise_threshold: BoolProperty(  # type: ignore
        name="Noise Threshold",
        description="Samples go where the noise is, until the picture is calm",
        default=False,
    )
    noise_threshold: FloatProperty(  # type: ignore
        name="Threshold",
        description="The noise that the whole picture may have, in Cycles' unit. Lower it where the finished picture is noisy;"
        " half the threshold takes four times as many samples",
        default=0.01,
        min=0.0001,
        soft_max=0.2,
        max=10.0,
        precision=4,
        step=0.1,
    )
    least_samples: IntProperty(  # type: ignore
        name="Min Samples",
        description="Samples of every pixel before its noise counts. 0: by the threshold. Raise it where small bright"
        " features are missed",
        default=0,
        min=0,
        max=1 << 20,
    )
    time_limit: FloatProperty(  # type: ignore
        name="Time Limit",
        description="A render takes no further samples after this time, whatever it has; 0: no limit. The picture then"
        " depends on how fast the machine is",
        default=0.0,
        min=0.0,
        soft_max=3600.0,
        max=1e9,
        unit="TIME_ABSOLUTE",
        step=100,
    )
    preview_samples: IntProperty(  # type: ignore
        name="Viewport Samples",
        description="Paths per pixel of 3-D views in Rendered shading, which are refined until they have as many",
        default=32,
        min=1,
        max=1 << 20,
    )
    seed: IntProperty(name="Seed", description="Another number gives other noise, of the same strength", default=0, min=0)  # type: ignore
    use_animated_seed: BoolProperty(  # type: ignore
        name="Animate Seed",
        description="Other noise in every frame, so that it does not stick to the picture",
        default=False,
    )

    integrator: EnumProperty(  # type: ignore
        name="Integrator",
        description="How light is gathered: all of it with noise, or calm with few bounces",
        items=INTEGRATORS,
        default="PATH",
    )
    glossy_rays: IntProperty(  # type: ignore
        name="Glossy Rays",
        description="Rays from a rough mirror or rough glass, per sample. Raise it where blurred reflections are noisy",
        default=4,
        min=1,
        max=4096,
    )
    light_rays: IntProperty(  # type: ignore
        name="Shadow Rays",
        description="Rays from a surface to lights, per sample. Raise it where soft shadows are noisy",
        default=4,
        min=1,
        max=4096,
    )
    hemisphere_rays: IntProperty(  # type: ignore
        name="Diffuse Rays",
        description="Rays from a matte surface into all directions, per sample. Raise it where indirect light is blotchy",
        default=4,
        min=1,
        max=4096,
    )
    indirect: EnumProperty(  # type: ignore
        name="Indirect Light",
        description="What light that does not come straight from a lamp is made of",
        items=INDIRECT,
        default="COLOR_BLEEDING",
    )
    use_irradiance_cache: BoolProperty(  # type: ignore
        name="Irradiance Cache",
        description="Gather light on matte surfaces at few points before the frame, and interpolate between them: much"
        " faster where surfaces are smooth",
        default=False,
    )
    irradiance_error: FloatProperty(  # type: ignore
        name="Cache Tolerance",
        description="How far apart the points of the irradiance cache may lie. Lower it where indirect light is blotchy or"
        " corners lack shadow; lower is slower",
        default=0.2,
        min=0.01,
        max=1.0,
    )
    occlusion_distance: FloatProperty(  # type: ignore
        name="Occlusion Distance",
        description="Farther things hide nothing in ambient occlusion, as light and as a pass; 0 for no limit",
        default=0.0,
        min=0.0,
        subtype="DISTANCE",
    )

    film_exposure: FloatProperty(  # type: ignore
        name="Exposure", description="Factor on all light: 2 is twice as bright", default=1.0, min=0.0, soft_max=10.0
    )
    filter_type: EnumProperty(  # type: ignore
        name="Pixel Filter",
        description="How the samples around a pixel are weighted: what makes edges smooth",
        items=FILTERS,
        default="BLACKMAN_HARRIS",
    )
    filter_width: FloatProperty(  # type: ignore
        name="Width",
        description="Full width of the filter, in pixels; wider is softer",
        default=1.5,
        min=0.01,
        max=10.0,
    )

    facet_memory: FloatProperty(  # type: ignore
        name="Memory (MB)",
        description="Memory for tessellated surfaces that stay, in megabytes. What does not fit goes through the cache,"
        " which is slower. -1: a quarter of the machine's memory",
        default=-1.0,
        min=-1.0,
        soft_max=65536.0,
    )
    geometry_cache_size: FloatProperty(  # type: ignore
        name="Cache Size (MB)",
        description="Memory for tessellated surfaces that do not stay, in megabytes. The picture is the same for any; more"
        " is faster where much does not fit",
        default=30.0,
        min=0.0,
        soft_max=4096.0,
    )
    geometry_cache_mode: EnumProperty(  # type: ignore
        name="Tessellation Cache",
        description="What is kept of tessellated surfaces that do not stay; to compare",
        items=CACHE_MODES,
        default="MULTI",
    )
    tessellation_factor: FloatProperty(  # type: ignore
        name="Dicing Rate",
        description="How long facets may be, in pixels as the rays that meet them see it. Larger is coarser and faster;"
        " lower it where an outline or a displacement lacks detail",
        default=1.0,
        min=0.01,
        max=100.0,
    )
    use_stochastic_levels: BoolProperty(  # type: ignore
        name="Stochastic Levels",
        description="Choose between two levels of tessellation at random for each ray, so that no change of level"
        " shows in an animation",
        default=False,
    )
    use_importance_levels: BoolProperty(  # type: ignore
        name="Coarser Where Dim",
        description="Rays that bring little of a pixel's light see coarser facets: faster, where there are many such",
        default=False,
    )
    least_mirrored_spread: FloatProperty(  # type: ignore
        name="Widen Mirrored Rays",
        description="Rays that surfaces send on open up by at least this angle, for dicing alone: faster behind bodies"
        " of many small flat mirrors. 0: as much as they do",
        subtype="ANGLE",
        default=0.0,
        min=0.0,
        max=1.0,
    )

    strand_shape: EnumProperty(  # type: ignore
        name="Hair Shape",
        description="What hair is: tubes, or bands, which are a little faster for hair thinner than a pixel",
        items=STRAND_SHAPES,
    )
    curve_primitive: EnumProperty(  # type: ignore
        name="Curve Primitive",
        description="What hair and round bevelled curves are rendered as; all but the first are there to compare with",
        items=CURVE_PRIMITIVES,
    )
    curve_detail: IntProperty(  # type: ignore
        name="Curve Detail",
        description="Balls a segment of a curve; rings a segment and sides of a tube",
        default=16,
        min=3,
        max=256,
    )

    use_subdivision_surfaces: BoolProperty(  # type: ignore
        name="Exact Subdivision",
        description="Render the limit of Subdivision Surface modifiers that are last in their stack, not Blender's"
        " mesh",
        default=True,
    )

    texture_memory: IntProperty(  # type: ignore
        name="Texture Memory",
        description="Megabytes of image textures kept at once. Raise it where many large pictures make a render slow",
        default=1024,
        min=16,
        max=1 << 20,
    )
    ray_interpolation: PointerProperty(type=ray_interpolation.RayleafRayInterpolation)  # type: ignore


_register, _unregister = registration_factory((RayleafSceneSettings,), {bpy.types.Scene: RayleafSceneSettings})


def register() -> None:
    """Make the settings part of every scene, object, material and view layer."""
    ray_interpolation.register()
    _register()


def unregister() -> None:
    """Take them away again."""
    _unregister()
    ray_interpolation.unregister()
