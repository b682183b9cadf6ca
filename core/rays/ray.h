// A ray in world space, or in a shape's local space where the name says so.
#pragma once

#include "base/maybe.h"
#include "base/vector.h"
#include "rays/motion.h"

#include <cstdint>
#include <limits>

namespace rayleaf {

/// The subpatch on which a ray starts or ends, and how finely it was diced when that point was found. The ray sees the
/// subpatch and its borders at the same levels, whatever its own width: else the point could be behind coarser facets.
struct RayAnchor {
    static constexpr uint32_t kNone = ~0u;
    /// As a subpatch: the point is near the exact surface and on no facet. The whole instance is seen fine.
    static constexpr uint32_t kNoFacet = ~0u - 1;
    uint32_t instance = kNone;
    uint32_t subpatch = 0;  ///< of the instance's shape, as the tracer numbers them
    uint32_t levels = 0;    ///< tessellation/level.h: SubpatchLevels::packed
    /// The facet, of shapes whose facets stay in memory (tessellation/ray_packet.h). A ray that starts on it, flat as
    /// it is, cannot meet it again, so it is not asked. Of hair, the segment (trace/strand_scene.h).
    uint32_t facet = kNone;
};

/// The width of the beam that a ray represents, as a function of the distance t along it (Christensen et al. 2003,
/// section 4): the distances to the two rays of its differential, across the ray. Their squares are polynomials, so a
/// beam that narrows towards a focus is narrow there and wide again behind it.
struct RayBeam {
    /// Squared distance: a + b t + c t².
    struct Side {
        float a = 0, b = 0, c = 0;
    };
    Side sides[2];

    /// `width` at the origin, growing by `spread` radians along the ray; negative: shrinking.
    static RayBeam cone(float width, float spread) {
        const Side side{width * width, 2 * width * spread, spread * spread};
        return {{side, side}};
    }
    /// False for a ray without a beam.
    bool has_width() const { return sides[0].a > 0.0f || sides[0].c > 0.0f || sides[1].a > 0.0f || sides[1].c > 0.0f; }
};

/// The ray that found the point where another one starts. Within `reach` of that point the other ray sees surfaces as
/// finely as this one did: otherwise the back of a thin wall could be diced more finely than its front, and its facets
/// could lie before those of the front.
struct RaySight {
    Vec3d origin, direction;  ///< world space
    RayBeam beam;
    float reach = 0;  ///< world units

    RaySight(const Vec3d& from, const Vec3d& along, const RayBeam& wide) : origin(from), direction(along), beam(wide) {}
    // Not inline: few rays have one to copy.
    RaySight(const RaySight& other);
    RaySight& operator=(const RaySight& other);
};

struct RayStart : RayAnchor {
    Maybe<RaySight> sight;
};

struct Ray {
    Vec3d origin{0, 0, 0};                                   ///< world units
    Vec3d direction{0, 0, 1};                                ///< unit length, points away from the origin
    double t_min = 0.0;                                      ///< hits nearer than this are ignored, world units
    double t_max = std::numeric_limits<double>::infinity();  ///< and those beyond this

    float time = kMiddleTime;  ///< of the shutter (rays/motion.h)
    /// For ray caches: the instance that the ray leaves, if any, and how far the rays of this picture beside it are.
    /// Both zero: as close as can be.
    uint32_t leaves = RayAnchor::kNone;
    float neighbour_distance = 0.0f;  ///< at the origin, world units
    float neighbour_angle = 0.0f;     ///< radians

    /// Decides how finely surfaces are diced; without a width, the view does. World units.
    RayBeam beam;
    RayAnchor end;
    RayStart start;  ///< last: few rays have a sight

    Vec3d at(double t) const { return origin + direction * t; }
};

}  // namespace rayleaf
