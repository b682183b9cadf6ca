// Distribution ray tracing (Cook, Porter, Carpenter 1984; as in Christensen et al. 2003): from a surface that the
// camera sees, directly or in mirrors, glass and gloss, many rays go on.
//
// * Every mirror and every refraction is followed; nothing is chosen by chance unless it is too dim to matter.
// * Rough microfacets send `glossy_rays`, and `light_rays` sampled lights are asked. Both find emission; they are
//   weighed by the power heuristic with their numbers (Veach 1997, equation 9.13).
// * Diffuse lobes send `hemisphere_rays`, which bring what light sampling cannot find: the world where it is not
//   sampled, and light by way of one more surface. Beyond these, one ray goes on from each surface, as in path tracing.
// * A ray that is one of n counts a nth part: surfaces it meets send a nth of the rays, at least one of each kind.
//
// With the same limits it estimates what path tracing does with at most one diffuse bounce.
#pragma once

#include "integrators/irradiance_cache.h"
#include "integrators/path.h"
#include "integrators/ray_counts.h"

namespace rayleaf {

struct DistributionSettings {
    DistributionSettings(const Settings& settings);  // NOLINT(google-explicit-constructor): as PathSettings

    PathSettings path;  ///< at most one diffuse bounce, none without colour bleeding
    int glossy_rays, light_rays, hemisphere_rays;
    IndirectLight indirect;
};

struct Branch;  // integrators/branch.h

/// What all rays of a frame share.
struct DistributionFrame {
    const Scene& scene;
    const DistributionSettings& settings;
    const IrradianceCache* cache = nullptr;  ///< null: every hemisphere is sampled
};

/// What one camera ray and all that follow contribute to each pass that is on. Pure, but for adding to `counts`.
PixelSample trace_distributed(const DistributionFrame& frame, const CameraRay& camera_ray, const Sampler& sampler,
                              RayCounts& counts, SampleExtras* extras = nullptr);

/// The light that a ray of a hemisphere, scattered once by a white diffuse surface, adds to it. The settings must ask
/// for light passes.
HemisphereRay trace_hemisphere_ray(const DistributionFrame& frame, const Branch& ray, RayCounts& counts);

/// False where hemisphere rays can find nothing that light sampling does not.
bool hemisphere_brings_light(const DistributionFrame& frame);

}  // namespace rayleaf
