// One ray of the tree that distribution ray tracing grows from a camera ray, and all that it carries.
#pragma once

#include "base/random.h"
#include "integrators/bounces.h"
#include "integrators/denoising_features.h"
#include "integrators/dimensions.h"
#include "integrators/medium_stack.h"
#include "integrators/ray_counts.h"
#include "integrators/vertex.h"

namespace rayleaf {

/// What sampling lights has to do with the emission that a ray meets.
enum class LightSampling : uint8_t {
    None,     ///< could not have found it
    Weighed,  ///< could; both count in part
    Alone     ///< finds all that it can find; the ray counts the rest
};

/// How a ray came about: what light sampling did beside it.
struct BranchDeparture {
    LitPoint from;  ///< where lights were sampled
    LightSampling sampling = LightSampling::None;
    float density = 0;     ///< times the number of rays: with which scattering chose the direction
    float light_rays = 1;  ///< number of sampled lights

    /// Of emission that a sampled light finds with density `light_density`, 0 if it cannot.
    float weight(float light_density) const {
        if (sampling == LightSampling::None || !(light_density > 0.0f)) return 1.0f;
        return sampling == LightSampling::Alone ? 0.0f : power_heuristic(density, light_rays * light_density);
    }
};

/// How many rays go on from a surface.
enum class Spread : uint8_t {
    Many,  ///< as set
    One    ///< beyond a hemisphere ray
};

struct Branch {
    Branch(const PathSettings& settings, const CameraRay& camera, const Sampler& random_numbers)
        : ray(camera.ray),
          differential(camera.differential),
          departure{{camera.ray.origin}},
          bounces(settings),
          sampler(random_numbers),
          splits_light(settings.light_passes) {}

    Ray ray;
    RayDifferential differential;
    BranchDeparture departure;
    Bounces bounces;
    Sampler sampler;
    Color throughput{1, 1, 1};  ///< what light along the ray counts in the camera sample
    float share = 1;            ///< of the camera sample, were all surfaces white: a ray of n has a nth of its parent's
    ByKind first_shares;        ///< of the first scattering
    MediumStack media;          ///< in which the ray starts
    Spread spread = Spread::Many;
    RayUse use = RayUse::Camera;
    bool splits_light;  ///< whether anyone asks for `first_shares`
    int vertex = 0;     ///< counted from the camera
    DenoisingFeatures features;
    uint32_t outside_of = RayAnchor::kNone;  ///< instance of glass that the ray has just left
    bool has_departed = false;               ///< was scattered, and has met nothing yet
    bool shows_features = true;              ///< for denoisers: by way of mirrors and clear glass alone

    /// How bright the ray is for one of its kind.
    float importance() const { return max_abs(throughput) / share; }
    float random(PathDimension purpose) const { return sampler.get1(dimension(vertex, purpose)); }

    /// The ray that `sample`, drawn from `closures`, makes of this one, one of `count`; with nothing said of its
    /// differential, random numbers and light sampling.
    Branch scattered(const Scene& scene, const Vertex& from, const Closures& closures, const LobeSample& sample,
                     int count) const;
    /// The ray behind a transparent surface.
    Branch straight_on(const Scene& scene, const Vertex& from) const;
    /// The ray that its portal sends on, in its media.
    Branch by_portal(const Scene& scene, const Vertex& from) const;

  private:
    /// What these have in common: a ray with the light times that weight, of which the start is yet to be set.
    Branch unscattered(const Vertex& from, const Color& weight) const;
};

/// False for a ray that is black, or that ends by chance, being dim; the others carry its light.
bool survives(Branch& branch, const PathSettings& settings);

}  // namespace rayleaf
