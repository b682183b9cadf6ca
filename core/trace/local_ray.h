// A ray in the local space of a shape: in double precision, and as the float ray that Embree gets.
//
// The float ray starts where the ray enters the shape's box, so its numbers are of the order of 1 wherever the object
// lies. It starts a little earlier than the true ray (`kBackstep`), for rounding must not lose a hit close to the
// start: what Embree or a grid kernel finds is a candidate, and the exact t in double decides whether it counts.
#pragma once

#include "base/maybe.h"
#include "base/vector.h"
#include "rays/ray.h"
#include "tessellation/geometry_cache.h"
#include "trace/embree.h"

#include <optional>

namespace rayleaf {

/// How far the float ray starts before the true one, local units. The error of t in single precision is about 2^-22
/// over the cosine of incidence, so only surfaces that the ray meets at less than 1/1000 rad could be missed, and only
/// within this distance of its start.
inline constexpr double kBackstep = 0x1p-12;

/// What boxes are enlarged by for a float ray, local units. Coordinates are at most 1 and a ray runs at most 2 sqrt(3)
/// inside the box: its points are off by the rounding of the origin, the direction times the distance, the product and
/// the sum, each at most 2^-24 * 3.5, together 8.4e-7. As much again is for the rounding of the box test itself, which
/// Embree does not state for user geometry.
inline constexpr double kBoxPadding = 0x1p-19;

/// A float ray's origin so far away leaves nothing of the way to the box. Embree ends the process for rays
/// beyond 1.8e18.
inline constexpr float kFarOff = 1e18f;

/// Squares of directions outside of these may be rounded to nothing or to infinity.
inline constexpr double kSmallSquare = 1e-280, kLargeSquare = 1e280;
/// Of a direction of any size.
double length_of(const Vec3d& direction);

/// RaySight in local space; its beam is to be read as LocalRay's.
struct LocalSight {
    Vec3d origin{0, 0, 0}, direction{0, 0, 1};
    RayBeam beam;
    float reach = 0;  ///< from the ray's origin
};

/// Distance along a float ray within which everything with at most this t lies; infinity stays.
inline float float_distance_of(double t, double start, double speed) {
    return static_cast<float>((t - start) * speed * (1.0 + 0x1p-20) + kBackstep);
}

struct LocalRay {
    Vec3d origin{0, 0, 0};
    Vec3d direction{0, 0, 1};     ///< local units per world unit, not unit length: t is the world ray's
    double t_min = 0, t_max = 0;  ///< world units

    RayBeam beam;          ///< Ray's, local; a unit of t in it is the shortest that the instance makes of a local unit
    float stretch = 1;     ///< the longest over that
    RayAnchor anchors[2];  ///< Ray's start and end where they lie on this instance; else none
    Maybe<LocalSight> before;                       ///< of the ray that found the start, where it matters
    const GeometryCache::Reader* reader = nullptr;  ///< of this thread; null: the shape gets one

    uint32_t root = 0;                        ///< of the shape's part that it may meet (ShapePart), or of all
    float time = kMiddleTime;                 ///< of the shutter, within it
    uint32_t start_facet = RayAnchor::kNone;  ///< Ray's, where it starts on this instance
    double start = 0;                         ///< t of the float ray's origin
    double speed = 1;                         ///< local units per world unit: length of `direction`
    Vec3f float_origin{0, 0, 0};              ///< local
    Vec3f float_direction{0, 0, 1};           ///< unit

    float float_distance(double t) const { return float_distance_of(t, start, speed); }
    RTCRay embree_ray() const;
    RTCRayHit embree_ray_hit() const;
};

/// The interval of t in which a ray is inside a box, empty if there is none. `origin` and `direction` are finite.
struct RayInterval {
    double begin, end;
};
std::optional<RayInterval> inside_box(const Box3d& box, const Vec3d& origin, const Vec3d& direction);

/// The ray clipped to a shape's box and ready for Embree; empty where it misses the box within [t_min, t_max].
Maybe<LocalRay> clipped_ray(const Box3d& box, const Vec3d& origin, const Vec3d& direction, double t_min, double t_max);

/// Whether tracing may be given a ray: finite, with a direction.
inline bool is_traceable(const Ray& ray) {
    return is_finite(ray.origin) && is_finite(ray.direction) && max_abs(ray.direction) > 0.0 && ray.t_min <= ray.t_max;
}

}  // namespace rayleaf
