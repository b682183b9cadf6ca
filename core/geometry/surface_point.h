// A point on a surface of the scene, in world space: the input of shading and lights.
#pragma once

#include "base/vector.h"
#include "geometry/shape.h"

#include <cmath>
#include <cstdint>

namespace rayleaf {

struct SurfacePoint {
    Vec3d position{0, 0, 0};        ///< exact surface, world units
    Vec3d facet_position{0, 0, 0};  ///< point of the facet that the ray hit: secondary rays start here (core/README.md)
    double start_offset = 0;  ///< how far along the facet normal a secondary ray must start to leave it, world units
    double facet_error = 0;   ///< distance of the facet's corners from the surface by rounding, world units
    Vec3f facet_normal{0, 0, 1};           ///< unit, of the facet, on the side of the winding (the outside)
    Vec3f normal{0, 0, 1};                 ///< unit shading normal, same side as the winding
    Vec3f dp_du{0, 0, 0}, dp_dv{0, 0, 0};  ///< world units per unit of uv
    Vec3f dn_du{0, 0, 0}, dn_dv{0, 0, 0};  ///< change of the unit normal per unit of uv
    Vec2f uv{0, 0};
    Vec2f uv_by_u{1, 0}, uv_by_v{0, 1};  ///< change of uv along what the derivatives are by: itself, or picture steps
    double t = 0;                        ///< distance along the ray, world units
    float time = kMiddleTime;            ///< of the shutter, at which all this is so

    const Shape* shape = nullptr;
    LocalHit local;
    uint32_t instance = 0;
    Maybe<RaySight> sight;      ///< of the ray whose width decided how finely the surface was diced here
    bool inside = false;        ///< in a medium that the shape holds, not on its surface: only `position` is known
    bool interpolated = false;  ///< not on a facet, and only approximate; derivatives are by the picture's x and y

    /// The anchor of a ray that starts or ends here.
    RayAnchor anchor() const {
        if (interpolated) return {instance, RayAnchor::kNoFacet, 0};
        if (local.subpatch == RayAnchor::kNone) return {};
        return {instance, local.subpatch, local.levels, local.facet};
    }
    /// The origin of a ray that leaves towards `direction` (unit): the facet point, moved to the ray's side. In double:
    /// a ray along the facet that starts on the wrong side of it would go through it unseen.
    Vec3d ray_origin(const Vec3d& direction) const {
        const double side = direction.dot(Vec3d(facet_normal)) < 0.0 ? -start_offset : start_offset;
        return facet_position + Vec3d(facet_normal) * side;
    }
    /// Sets up a ray that leaves the surface here towards `direction` (unit): its start, direction and time.
    void release(Ray& ray, const Vec3d& direction) const {
        /// The sine up to which rounding of the facet's normal may tell the wrong side: the facet is looked at, too.
        constexpr double kAlongFacet = 1e-6;
        ray.origin = ray_origin(direction);
        ray.direction = direction;
        static_cast<RayAnchor&>(ray.start) = anchor();
        if (std::abs(direction.dot(Vec3d(facet_normal))) < kAlongFacet) ray.start.facet = RayAnchor::kNone;
        ray.start.sight = sight;
        ray.leaves = instance;
        ray.time = time;
    }
    /// The rest of a ray that goes straight on. An interpolated point may be far from the surface: then the ray starts
    /// as far behind it, but on its own line, so that the background does not shift.
    Ray behind(Ray ray) const {
        const Vec3d before = ray.origin, direction = ray.direction;
        release(ray, direction);
        if (interpolated) {
            constexpr double kLeastSlope = 0.01;  // below what is interpolated at all, but where maps flatten
            const double slope = std::max(std::abs(direction.dot(Vec3d(facet_normal))), kLeastSlope);
            ray.origin = facet_position + direction * (start_offset / slope);
        }
        ray.t_max -= (ray.origin - before).dot(ray.direction);
        ray.t_min = 0;
        return ray;
    }
};

}  // namespace rayleaf
