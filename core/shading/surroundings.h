// What a shader program may ask about the space around the point it shades: the nodes Ambient Occlusion, Bevel and
// Raycast.
#pragma once

#include "base/random.h"
#include "base/vector.h"
#include "geometry/surface_point.h"

#include <cstdint>
#include <optional>

namespace rayleaf {

/// The random numbers of one query: sub-rays of one sample of a pixel, distinguished by `tag`.
struct ProbeNumbers {
    Sampler sampler{0, 0, 0};
    uint32_t tag = 0;

    Vec2f get(int ray, int rays) const {
        return sampler.branch(static_cast<uint32_t>(ray), static_cast<uint32_t>(rays), tag).get2(0);
    }
};

/// Implemented where rays can be traced (scene/traced_surroundings.h). Thread-safe, pure.
class Surroundings {
  public:
    virtual ~Surroundings() = default;

    struct Openness {
        Vec3f axis;          ///< of the hemisphere, unit
        float distance = 0;  ///< how far anything counts, world units
        int rays = 1;
        bool only_local = false;  ///< nothing but the instance itself counts
    };
    /// The share of the hemisphere, weighed by the cosine, in which nothing is in the way.
    virtual float openness(const SurfacePoint& point, const Openness& asked, const ProbeNumbers& numbers) const = 0;
    struct Cast {
        Vec3f position;      ///< world units; that of the point itself leaves its surface
        Vec3f direction;     ///< unit
        float distance = 0;  ///< world units
        bool only_local = false;
    };
    struct Met {
        float distance = 0;     ///< world units
        bool own = false;       ///< belongs to the instance itself
        Vec3f normal{0, 0, 1};  ///< unit, facing the ray
    };
    /// The nearest thing on a ray of any kind.
    virtual std::optional<Met> cast(const SurfacePoint& point, const Cast& asked) const = 0;
    /// The mean of the normals around, on the side of the winding; the point's own where there is nothing to average.
    virtual Vec3f rounded_normal(const SurfacePoint& point, float radius, int rays,
                                 const ProbeNumbers& numbers) const = 0;
};

}  // namespace rayleaf
