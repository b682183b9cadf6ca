// Path tracing: light and scattering sampled together by the power heuristic (Veach 1997, section 9.2.4).
//
// A vertex does, in this order: lamps passed on the way and emission of the surface (weighed against light sampling),
// one sampled light, then either straight on through a transparent surface or on by a scattered ray.
//
// Bounce limits are Blender's: a path that has used up a limit still sees what its last ray meets emit, so that 0
// bounces leave direct light.
//
// The light passes hold radiance with the lobes' colour in it; the film divides the mean of a pixel by the mean of the
// colour pass, as Cycles does. So Combined is, per sample, the sum of all light passes, Emit and Env (without Env where
// the film is transparent).
#pragma once

#include "base/random.h"
#include "film/pixel.h"
#include "integrators/ray_counts.h"
#include "rays/ray_differential.h"
#include "scene/scene.h"
#include "scene/settings.h"

namespace rayleaf {

/// What of the settings a path needs, in the form in which it needs it. Made once a render.
struct PathSettings {
    PathSettings(const Settings& settings);  // NOLINT(google-explicit-constructor): settings are path settings

    int max_bounces, diffuse_bounces, glossy_bounces, transmission_bounces, transparent_bounces, volume_bounces,
        roulette_start;
    int most_interior_hits;              ///< of a path through glass
    float clamp_direct, clamp_indirect;  ///< infinity: no limit
    double occlusion_distance;           ///< infinity: no limit
    float filter_glossy;                 ///< Settings'; 0: nothing is made wider
    bool reflective_caustics, refractive_caustics, drops_caustics;
    float exposure;
    bool film_transparent;
    float film_glass_roughness;  ///< Settings'
    uint64_t passes;             ///< a bit per pass of the table that is on
    uint64_t held_passes;        ///< that samples hold: those, and by which they are told
    size_t slots;                ///< as many as the passes need
    bool mattes;                 ///< any of them
    bool light_passes;           ///< any pass that splits light by the kind of lobe
    bool color_passes;
    bool ray_passes;                ///< any pass that shows how rays were answered
    bool surface_passes;            ///< any pass that describes the first surface
    bool feature_passes;            ///< any pass that denoisers are guided by
    bool catches_shadows;           ///< shadow catchers are none of the objects that the camera sees
    bool shows_footage;             ///< the picture shows their shadow, and what lies behind
    double mist_start, mist_depth;  ///< world units
    float mist_falloff;             ///< exponent

    bool importance_levels;       ///< Settings'
    float least_mirrored_spread;  ///< Settings', radians

    /// For dicing what a ray meets that carries this share of a pixel's light; `scattered`: by a surface before.
    RayWidening widening(float importance, bool scattered) const;
    bool wants(Pass pass) const { return (passes >> static_cast<uint32_t>(pass)) & 1u; }
    /// Whether samples hold more than the passes of the table.
    bool has_extras() const { return slots > 0 || mattes; }
};

/// Traces one path from the camera ray and returns what it contributes to each pass that is on. `counts` gets its
/// rays; `extras` is there where the settings ask for some, and is written anew. Pure: equal arguments, equal bits.
/// Dimensions of `sampler`: integrators/dimensions.h.
PixelSample trace_path(const Scene& scene, const PathSettings& settings, const CameraRay& camera_ray,
                       const Sampler& sampler, RayCounts& counts, SampleExtras* extras = nullptr);

}  // namespace rayleaf
