// A ray in world space, or in a shape's local space where the name says so.
#pragma once

#include "base/vector.h"

#include <cstdint>
#include <limits>

namespace rayleaf {

/// The subpatch on which a ray starts or ends, and how finely it was diced when that point was found. The ray sees it
/// and its borders in the same way, whatever its own width asks for: else the point could lie behind coarser facets.
struct RayAnchor {
    static constexpr uint32_t kNone = ~0u;
    /// As a subpatch: the point is close to the surface itself and on no facet. All of the instance is seen fine.
    static constexpr uint32_t kNoFacet = ~0u - 1;
    uint32_t instance = kNone;
    uint32_t subpatch = 0;  ///< of the instance's shape, as the tracer numbers them
    uint32_t levels = 0;    ///< tessellation/level.h: SubpatchLevels::packed
};

struct Ray {
    Vec3d origin{0, 0, 0};                                   ///< world units
    Vec3d direction{0, 0, 1};                                ///< unit length, points away from the origin
    double t_min = 0.0;                                      ///< hits nearer than this are ignored, world units
    double t_max = std::numeric_limits<double>::infinity();  ///< and those beyond this

    /// What the ray stands for is `width + spread t` wide (Christensen et al. 2003, section 4): surfaces are diced as
    /// finely as that needs. Both zero: as finely as the view asks for.
    float width = 0.0f;   ///< at the origin, world units
    float spread = 0.0f;  ///< radians
    RayAnchor start, end;

    /// For ray caches: the instance that the ray leaves, if any, and how far the rays of this picture beside it are.
    /// Both zero: as close as can be.
    uint32_t leaves = RayAnchor::kNone;
    float neighbour_distance = 0.0f;  ///< at the origin, world units
    float neighbour_angle = 0.0f;     ///< radians

    Vec3d at(double t) const { return origin + direction * t; }
};

}  // namespace rayleaf
