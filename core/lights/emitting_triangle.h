// An emitting triangle: as it lies in the world, at rest, and as it is seen from a place.
#pragma once

#include "base/maybe.h"
#include "base/vector.h"
#include "geometry/facet.h"
#include "lights/spherical_triangle.h"

#include <algorithm>
#include <optional>

namespace rayleaf {

/// A triangle at rest, in the world.
struct StillTriangle {
    FacetCorners corners;
    Vec3d area;               ///< along its normal; as long as the area that a unit of parameters covers
    double start_offset = 0;  ///< SurfacePoint's, anywhere on it
    Vec3f facet_normal;
    bool is_even = false;  ///< shines alike everywhere and in all directions
    Color radiance;        ///< that does

    Vec3d at(const Vec2f& parameters) const {
        return corners[0] + (corners[1] - corners[0]) * double{parameters.x} +
               (corners[2] - corners[0]) * double{parameters.y};
    }
    /// Where a ray along `direction`, of any length, that ends here may stop: on the side that it comes from.
    Vec3d target(const Vec3d& position, const Vec3d& direction) const {
        const Vec3d normal(facet_normal);
        return position + normal * (direction.dot(normal) > 0.0 ? -start_offset : start_offset);
    }
};

/// Triangles that take less, steradians, are sampled by area: they look nearly the same from all their places.
constexpr double kLeastSolidAngle = 1e-3;

/// An element as it is seen from a place, if that is a triangle which takes enough of the view.
class SeenTriangle {
  public:
    SeenTriangle() = default;
    explicit SeenTriangle(const FacetCorners& from_there) : corners_(from_there) {
        const double nearest2 = std::min({corners_[0].length2(), corners_[1].length2(), corners_[2].length2()});
        if (area_vector(corners_).length() > kLeastSolidAngle * nearest2) sphere_.emplace(corners_);
    }
    /// Whether it is sampled by solid angle.
    explicit operator bool() const { return sphere_ && (*sphere_).solid_angle() > kLeastSolidAngle; }
    double density() const { return 1.0 / (*sphere_).solid_angle(); }
    /// The parameters of a point.
    Vec2f sample(const Vec2f& random) const {
        const std::optional<FacetHit> hit = exact_facet_hit(corners_, Vec3d(0.0), (*sphere_).sample(random), 1.0);
        if (!hit) return Vec2f(1.0f / 3.0f);
        const auto u = static_cast<float>(hit->u);
        return {u, std::min(static_cast<float>(hit->v), 1.0f - u)};
    }

  private:
    FacetCorners corners_{};
    Maybe<SphericalTriangle> sphere_;
};

}  // namespace rayleaf
