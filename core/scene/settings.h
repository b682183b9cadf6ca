// What an artist sets for a render.
#pragma once

#include "film/pass.h"
#include "film/pixel_filter.h"
#include "film/sample_range.h"
#include "film/window.h"
#include "scene/ray_interpolation.h"
#include "tessellation/geometry_cache.h"

#include <cstdint>
#include <vector>

namespace rayleaf {

enum class IntegratorKind : uint8_t {
    Path,         ///< one ray on from each surface (integrators/path.h)
    Distribution  ///< many rays from each surface seen, few beyond (integrators/distribution.h)
};

/// What distribution ray tracing's hemisphere rays look for.
enum class IndirectLight : uint8_t {
    None,              ///< light that reaches a surface straight
    AmbientOcclusion,  ///< the world, where nothing nearer than the occlusion distance hides it
    ColorBleeding      ///< light over one more diffuse surface as well
};

struct Settings {
    int width = 0, height = 0;            ///< of the whole picture, pixels
    int crop_x = 0, crop_y = 0;           ///< lower left corner of the rendered part
    int crop_width = 0, crop_height = 0;  ///< its size; 0: the whole picture
    int samples = 64;                     ///< paths per pixel
    /// What is rendered of all that, where several share the work: a part of the crop, and some of the samples. What is
    /// decided for the picture as a whole is decided as if all of it were.
    int part_x = 0, part_y = 0;           ///< lower left corner in the whole picture
    int part_width = 0, part_height = 0;  ///< 0: the whole crop
    int first_sample = 0;
    int sample_count = 0;  ///< 0: all from there on
    /// The noise that the picture may have, in Cycles' unit (film/error_blocks.h); 0: all samples everywhere.
    double noise_threshold = 0;
    /// The error that noise and shortcuts together may leave (film/error_blocks.h); 0: none is set. `samples` are the
    /// most, and there is no noise threshold then.
    double target_error = 0;
    int least_samples = 0;  ///< of each pixel before its noise counts; 0: by the threshold, as Cycles does
    /// Seconds after which no round of samples begins, the scene's build included; 0: none. The picture depends on how
    /// far the machine comes.
    double time_limit = 0;
    bool keep_sums = false;  ///< exact sums, to be put together with other parts' (film/film_sums.h)
    /// For a first look, soon: coarse facets, nothing displaced, a coarse table of the world's light.
    bool draft = false;
    uint32_t seed = 0;
    int threads = 0;  ///< 0: all the machine's
    /// Pixels along the side of what a thread takes at a time, at most (render/tiles.h). The picture is the same for
    /// any.
    int tile_size = 64;
    /// Paths that a thread traces at once (integrators/path_stream.h); 0: one after the other, ray by ray. For tests:
    /// the picture is the same for any.
    int stream_paths = 512;

    int max_bounces = 12, diffuse_bounces = 4, glossy_bounces = 4, transmission_bounces = 12, transparent_bounces = 8;
    int volume_bounces = 0;
    int roulette_start = 3;                       ///< bounces after which Russian roulette may end a path
    float clamp_direct = 0, clamp_indirect = 10;  ///< largest mean of one contribution's channels; 0: no limit
    /// Surfaces that a path comes to by a scattering of a density below this, per solid angle, are as rough as if they
    /// were seen blurred: less noise, and softer caustics. 0: as they are. Off: no light over mirrors, or through
    /// glass, by rays from matte surfaces.
    float filter_glossy = 0;
    bool reflective_caustics = true, refractive_caustics = true;
    /// What is nearer than this to the start of a shadow ray casts no shadow, world units. 0: everything casts shadows,
    /// and surfaces need no more to be free of acne. For pictures like those of older ray tracers.
    double shadow_bias = 0;
    /// The pass Mist: where it begins, how deep it is (world units), and the exponent of its falloff.
    double mist_start = 5, mist_depth = 25;
    float mist_falloff = 2;
    /// With a transparent film the world behind glass up to this roughness is not drawn either, 0 to 1; -1: it is.
    float film_glass_roughness = -1;
    bool film_transparent = false;
    PixelFilterKind filter = PixelFilterKind::BlackmanHarris;
    float filter_width = 1.5f;  ///< pixels, as Blender's panel counts it (film/pixel_filter.h)
    float exposure = 1;         ///< factor on radiance, as Blender's Film exposure

    IntegratorKind integrator = IntegratorKind::Path;
    double occlusion_distance = 0;  ///< world units beyond which nothing occludes; 0: no limit
    // Of distribution ray tracing: rays from one surface point of a sample, and what for.
    int glossy_rays = 4, light_rays = 4, hemisphere_rays = 4;
    IndirectLight indirect = IndirectLight::ColorBleeding;
    bool irradiance_cache = false;       ///< sample hemispheres at few points and interpolate
    float irradiance_error = 0.2f;       ///< that interpolation may make, relative (Ward and Heckbert 1992's a)
    RayInterpolation ray_interpolation;  ///< of objects without one of their own
    /// Memory for facets that stay, before any go through the geometry cache; negative: a quarter of the machine's.
    double resident_megabytes = -1;
    /// Memory of the geometry cache; 0 and less: tessellations are not kept.
    double geometry_cache_megabytes = 30;
    CacheMode geometry_cache_mode = CacheMode::Multi;
    /// How long facets may be, in ray widths, where the surface is not flat enough for longer ones.
    float tessellation_factor = 1;
    bool stochastic_levels = false;  ///< round the level of each ray at random, so that none shows in an animation
    /// Rays that bring a small share of a pixel's light are taken to be wider, so that its error counts as much as
    /// others': by the root of that share, four times at most (Christensen et al. 2003, section 7.3, ask how).
    bool importance_levels = false;
    /// Rays sent on by surfaces widen at least this fast, radians. For bodies of many small flat mirrors, whose rays
    /// are narrow and have no order (section 7.2, the disco ball); 0: as their differentials say.
    float least_mirrored_spread = 0;

    std::vector<Pass> passes = {Pass::combined};
};

/// How the target error is divided (film/error_blocks.h): the share that interpolated rays may make, in the terms of
/// their error bound; the rest is noise.
inline constexpr double kInterpolationShare = 0.5;
/// How far facets may be from surfaces, pixels: nearer for low targets, as outlines are off by as much.
double dicing_pixels(const Settings& settings);
/// The same of what is far from the picture (trace/tracer.h).
double coarsest_tolerance(const Settings& settings);
/// That of facets that go through the geometry cache.
double coarsest_cached_tolerance(const Settings& settings);
/// The widest table of a draft's world.
inline constexpr int kDraftWorldWidth = 128;

/// What a render's settings ask of the geometry cache.
GeometryCacheSettings geometry_cache_settings(const Settings& settings);

/// Throws InputError that names the first setting out of its range.
void validate(const Settings& settings);
/// The samples that a pixel takes before its noise counts.
int least_samples(const Settings& settings);

/// The picture in pixels: the crop, or the whole.
inline Window window(const Settings& s) {
    if (s.crop_width == 0 || s.crop_height == 0) return {0, 0, s.width, s.height};
    return {s.crop_x, s.crop_y, s.crop_width, s.crop_height};
}
/// What is rendered of it.
inline Window part(const Settings& s) {
    if (s.part_width == 0 || s.part_height == 0) return window(s);
    return {s.part_x, s.part_y, s.part_width, s.part_height};
}
/// Of each pixel.
inline SampleRange sample_range(const Settings& s) {
    return {s.first_sample, s.sample_count == 0 ? s.samples - s.first_sample : s.sample_count};
}

}  // namespace rayleaf
