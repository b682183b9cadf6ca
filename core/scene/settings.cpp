#include "scene/settings.h"

#include "base/error.h"
#include "base/machine_memory.h"
#include "trace/tracer.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace rayleaf {
namespace {

/// The bounds are compared as what the value is: 0.01 as a float is a little less than as a double.
template <typename Number>
void check(const char* argument, Number value, double least, double most) {
    if (!(value >= static_cast<Number>(least) && value <= static_cast<Number>(most)))
        throw InputError("settings", argument, number_text(value),
                         "a number from " + number_text(least) + " to " + number_text(most));
}

/// How far a draft's facets may lie from the surface, local units.
constexpr double kDraftTolerance = 0.01;

}  // namespace

void validate(const Settings& s) {
    constexpr double kLargestSide = 65536, kMany = 1 << 24, kManyRays = 4096;
    check("width", s.width, 1, kLargestSide);
    check("height", s.height, 1, kLargestSide);
    check("crop x", s.crop_x, 0, s.width);
    check("crop y", s.crop_y, 0, s.height);
    check("crop width", s.crop_width, 0, s.width - s.crop_x);
    check("crop height", s.crop_height, 0, s.height - s.crop_y);
    check("samples", s.samples, 1, kMany);
    const Window picture = window(s);
    check("part x", s.part_x, s.part_width == 0 ? 0 : picture.x, picture.x + picture.width);
    check("part y", s.part_y, s.part_height == 0 ? 0 : picture.y, picture.y + picture.height);
    check("part width", s.part_width, 0, picture.x + picture.width - s.part_x);
    check("part height", s.part_height, 0, picture.y + picture.height - s.part_y);
    check("first sample", s.first_sample, 0, s.samples - 1);
    check("sample count", s.sample_count, 0, s.samples - s.first_sample);
    check("noise threshold", s.noise_threshold, 0, 1e3);
    check("target error", s.target_error, 0, 1);
    check("least samples", s.least_samples, 0, kMany);
    check("time limit", s.time_limit, 0, 1e9);
    check("threads", s.threads, 0, 1024);
    check("tile size", s.tile_size, 1, 4096);
    check("stream paths", s.stream_paths, 0, 65536);
    check("bounces", s.max_bounces, 0, 1024);
    check("diffuse bounces", s.diffuse_bounces, 0, 1024);
    check("glossy bounces", s.glossy_bounces, 0, 1024);
    check("transmission bounces", s.transmission_bounces, 0, 1024);
    check("transparent bounces", s.transparent_bounces, 0, 1024);
    check("volume bounces", s.volume_bounces, 0, 1024);
    check("roulette start", s.roulette_start, 0, 1024);
    check("shadow bias", s.shadow_bias, 0, 1e30);
    check("filter glossy", s.filter_glossy, 0, 1e6);
    check("clamp direct", s.clamp_direct, 0, 1e30);
    check("film glass roughness", s.film_glass_roughness, -1, 1);
    check("clamp indirect", s.clamp_indirect, 0, 1e30);
    check("occlusion distance", s.occlusion_distance, 0, 1e30);
    check("glossy rays", s.glossy_rays, 1, kManyRays);
    check("light rays", s.light_rays, 1, kManyRays);
    check("hemisphere rays", s.hemisphere_rays, 1, kManyRays);
    check("irradiance error", s.irradiance_error, 0.01, 1);
    check("mist start", s.mist_start, -1e30, 1e30);
    check("mist depth", s.mist_depth, 0, 1e30);
    check("mist falloff", s.mist_falloff, 0.01, 100);
    check("filter width", s.filter_width, 0, 10);
    check("exposure", s.exposure, 0, 1e10);
    check("resident megabytes", s.resident_megabytes, -1e9, 1e9);
    check("geometry cache megabytes", s.geometry_cache_megabytes, -1e9, 1e9);
    check("tessellation factor", s.tessellation_factor, 0.01, 100);
    check("least mirrored spread", s.least_mirrored_spread, 0, 1);
    validate("settings", s.ray_interpolation);
}

int least_samples(const Settings& s) {
    if (s.least_samples > 0 || !(s.noise_threshold > 0.0)) return std::max(s.least_samples, 1);
    // The finer the threshold, the more samples are needed to see whether it is met.
    constexpr double kSamples = 16, kPower = -0.3, kMost = 1024;
    return static_cast<int>(std::clamp(std::ceil(kSamples * std::pow(s.noise_threshold, kPower)), 4.0, kMost));
}

double dicing_pixels(const Settings& s) {
    /// Of the target: an outline crosses few pixels, and facets reach the whole distance at few places.
    constexpr double kUsual = 0.1, kLeast = 0.02, kPerError = 20;
    constexpr double kDraft = 2;  // its pixels are shown as blocks
    if (s.draft) return kDraft;
    return s.target_error > 0.0 ? std::clamp(kPerError * s.target_error, kLeast, kUsual) : kUsual;
}

double coarsest_tolerance(const Settings& s) {
    return s.draft ? kDraftTolerance : kCoarsestTolerance;
}

double coarsest_cached_tolerance(const Settings& s) {
    return s.draft ? kDraftTolerance : kCoarsestCachedTolerance;
}

GeometryCacheSettings geometry_cache_settings(const Settings& s) {
    GeometryCacheSettings cache;
    cache.budget = budget_from_megabytes(s.geometry_cache_megabytes);
    constexpr uint64_t kShareOfMachine = 4;
    cache.resident_budget =
        s.resident_megabytes < 0.0 ? machine_memory() / kShareOfMachine : budget_from_megabytes(s.resident_megabytes);
    cache.mode = s.geometry_cache_mode;
    cache.rule.factor = s.tessellation_factor;
    cache.rule.rounding = s.stochastic_levels ? LevelRule::Rounding::Stochastic : LevelRule::Rounding::Up;
    return cache;
}

}  // namespace rayleaf
