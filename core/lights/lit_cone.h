// Where the light of a lamp may arrive: in a cone, at most a half space.
#pragma once

#include "rays/ray.h"

#include <optional>

namespace rayleaf {

/// The part of a ray between two distances, world units.
struct LitPart {
    double begin = 0, end = 0;
};

class LitCone {
  public:
    /// Everywhere.
    LitCone() = default;
    /// About unit `axis` from `apex` on; `cosine` of the half angle, in [0, 1].
    LitCone(const Vec3d& apex, const Vec3d& axis, double cosine)
        : apex_(apex), axis_(axis), cosine_squared_(cosine * cosine), is_bounded_(true) {}
    /// All cones of one kind whose apexes are in a sphere. Narrow ones are taken for everywhere.
    static LitCone of_sphere(const Vec3d& center, double radius, const Vec3d& axis, double cosine);

    bool is_bounded() const { return is_bounded_; }
    bool holds(const Vec3d& position) const;
    /// Of the first `end` of a ray; empty where none of it is in the cone.
    std::optional<LitPart> part_of(const Ray& ray, double end) const;

  private:
    Vec3d apex_{0, 0, 0}, axis_{0, 0, 1};
    double cosine_squared_ = 0;
    bool is_bounded_ = false;
};

}  // namespace rayleaf
