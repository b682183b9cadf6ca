// Derivatives of a ray's origin and direction by the pixel: two vectors each (Igehy 1999; Christensen et al. 2003,
// section 4).
#pragma once

#include "base/vector.h"
#include "rays/ray.h"

namespace rayleaf {

/// How much wider a ray is for dicing than its differential.
struct RayWidening {
    float factor = 1;
    float least_spread = 0;  ///< radians
};

struct RayDifferential {
    Vec3f dp_dx{0, 0, 0}, dp_dy{0, 0, 0};  ///< change of the origin per pixel step, world units
    Vec3f dd_dx{0, 0, 0}, dd_dy{0, 0, 0};  ///< change of the unit direction per pixel step, radians

    /// The differential `t` further along `direction`, on the plane with unit `normal` (Igehy, equation 10).
    RayDifferential transferred(const Vec3f& direction, double t, const Vec3f& normal) const;
    /// Length of the larger of the two position vectors: the ray's width, world units.
    float width() const { return std::sqrt(std::max(dp_dx.length2(), dp_dy.length2())); }
    /// The same of the beam's cross-section at right angles to the ray's unit direction: a ray that leaves a surface at
    /// grazing angle is narrow, however long its footprint.
    float width_across(const Vec3f& direction) const {
        const auto squared = [&](const Vec3f& dp) {
            const float along = dp.dot(direction);
            return std::max(dp.length2() - along * along, 0.0f);
        };
        return std::sqrt(std::max(squared(dp_dx), squared(dp_dy)));
    }
    /// The footprint of a round beam that meets a surface of that unit normal as if at right angles: two steps at right
    /// angles on it, as long as the beam is wide in the mean. The direction does not change from step to step. The
    /// first step is at right angles to the diagonal of the axes, as in Cycles: bumps finer than a pixel look alike
    /// then.
    RayDifferential round_footprint(const Vec3f& direction, const Vec3f& normal) const;
    /// Of a ray along the unit `direction`.
    RayBeam beam(const Vec3f& direction, const RayWidening& widening) const;
    /// Length of the larger of the two direction vectors: how fast the ray widens, radians.
    float angle() const { return std::sqrt(std::max(dd_dx.length2(), dd_dy.length2())); }
};

/// Gives a ray the width of its differential, for dicing and for ray caches (Scene::needs_widths).
inline void set_width(Ray& ray, const RayDifferential& differential, const RayWidening& widening = {}) {
    const Vec3f direction(ray.direction);
    ray.neighbour_distance = differential.width_across(direction);
    ray.neighbour_angle = differential.angle();
    ray.beam = differential.beam(direction, widening);
}

/// Differential of the mirrored ray at a surface whose unit normal changes by `dn_dx`, `dn_dy` over the footprint
/// (Igehy, equation 15). `direction` is the incoming one; the input must have been transferred to the surface.
RayDifferential reflected(const RayDifferential& incoming, const Vec3f& direction, const Vec3f& normal,
                          const Vec3f& dn_dx, const Vec3f& dn_dy);

/// Differential of the refracted ray (Igehy, equation 18). `normal` faces the incoming side; `eta` is the index of the
/// incoming side over that of the other. The caller has excluded total internal reflection.
RayDifferential refracted(const RayDifferential& incoming, const Vec3f& direction, const Vec3f& normal,
                          const Vec3f& dn_dx, const Vec3f& dn_dy, float eta);

/// Width of the share of the sphere of directions that one of `rays` rays stands for, radians, where they are sampled
/// with `density` per solid angle: the root of its solid angle 1 / (rays density), at most a radian, beyond which a
/// linear change of direction means nothing (Christensen et al. 2003, sections 4.4 to 4.6).
float share_width(float density, int rays);

/// Differential after a scatter over a wide lobe: directions open up to at least `angle` radians, so that the beam only
/// grows. Distribution ray tracing's rule for a fraction of the hemisphere (Christensen et al. 2003, section 4.2).
RayDifferential widened(const RayDifferential& incoming, const Vec3f& new_direction, float angle);

}  // namespace rayleaf
