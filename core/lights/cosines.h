// Cosines by which a light is chosen: of the angle at the light, or at the point that it shines on, at best.
#pragma once

#include "base/vector.h"

#include <algorithm>
#include <cmath>

namespace rayleaf {

/// Cosines that are less count as this, so that no light that may arrive is never chosen: normals of curved surfaces
/// and of bumps are estimates.
constexpr double kLeastCosine = 0.05;

/// The cosine of an angle that is made smaller by another, down to none; both by their cosines.
inline double narrowed(double cosine, double by) {
    if (cosine >= by) return 1.0;
    const double sines = (1.0 - cosine * cosine) * (1.0 - by * by);
    return cosine * by + std::sqrt(std::max(0.0, sines));
}

/// At a point with unit `normal`, of light from a cone about unit `direction` whose half angle has the cosine `seen`; 1
/// where the normal is zero, which stands for all directions.
inline double cosine_at_surface(const Vec3f& normal, const Vec3d& direction, double seen) {
    if (normal == Vec3f(0.0f)) return 1.0;
    return std::max(kLeastCosine, narrowed(direction.dot(Vec3d(normal)), seen));
}

}  // namespace rayleaf
