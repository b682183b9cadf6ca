// Where a ray met a shape.
#pragma once

#include "base/maybe.h"
#include "base/vector.h"
#include "rays/ray.h"

#include <array>
#include <cstdint>

namespace rayleaf {

/// The ray whose width decided how finely the subpatch hit was diced: the ray itself, or the one that found its start
/// (RaySight).
enum class SeenBy : uint8_t { Itself, RayBefore };

/// A hit in the local space of its shape (geometry/shape.h: centred, scaled to about [-1, 1]).
struct LocalHit {
    uint32_t primitive = 0;   ///< element of the shape: triangle, or Bezier patch before any splitting
    float u = 0, v = 0;       ///< triangle: weights of vertices 1 and 2. Patch: its parameters in [0,1]²
    Vec3d position{0, 0, 0};  ///< the point on the facet that was hit, exact to double precision
    Vec3f normal{0, 0, 1};    ///< of that facet by its winding; not unit, never zero
    /// The subpatch that was hit, and how finely it was diced for the ray (RayAnchor); none for triangles.
    uint32_t subpatch = RayAnchor::kNone, levels = 0;
    uint32_t facet = RayAnchor::kNone;  ///< RayAnchor's
    SeenBy seen_by = SeenBy::Itself;
    float subpatch_length = 0;  ///< the longest line of the subpatch
    float time = kMiddleTime;   ///< of the shutter, for shapes that deform
};

/// How an object with a ray cache answered a ray. The numbers are the codes of the mask pass (film/passes.def).
enum class RayAnswer : uint8_t { NotAsked, Traced, Interpolated, Followed, Missed };

/// What is known of the path through a glass body. CutOff: it has more hits than allowed.
enum class GlassWay : uint8_t { Unknown, Leaves, CutOff };

/// Derivatives of an interpolated answer by the picture's x and y.
struct HitChanges {
    struct Step {
        Vec3f normal{0, 0, 0};
        Vec2f uv{0, 0};                                         ///< Simple
        Vec3f exit_position{0, 0, 0}, exit_direction{0, 0, 0};  ///< Glass
    };
    bool are_known = false;  ///< else all are zero
    std::array<Step, 2> steps;
};

/// Data of an interpolated first hit beside the point; local space of the shape.
struct InterpolatedHit {
    Vec2f uv{0, 0};
    double position_error = 0;  ///< distance that the points, here and at the exit, may have from the surface
    float error = 0;            ///< the cache's own estimate, a share of the object's half extent
    /// Glass: where and how the ray leaves, after `interior_hits` hits from inside of which `total_reflections` let
    /// nothing through.
    GlassWay way = GlassWay::Unknown;
    Vec3d exit_position{0, 0, 0};
    Vec3d exit_direction{0, 0, 1};  ///< unit
    int interior_hits = 0, total_reflections = 0;
    HitChanges changes;  ///< of all of these
};

/// A hit in the scene.
struct Hit {
    double t = 0;           ///< along the world ray, world units
    uint32_t instance = 0;  ///< index of the instance
    LocalHit local;
    RayAnswer answer = RayAnswer::NotAsked;
    Maybe<InterpolatedHit> interpolated;  ///< where a ray cache has answered: the facet's normal is the surface's

    Hit() = default;
    Hit(double distance, uint32_t index, RayAnswer by) : t(distance), instance(index), answer(by) {}
    bool is_interpolated() const { return interpolated.has_value(); }
};

}  // namespace rayleaf
