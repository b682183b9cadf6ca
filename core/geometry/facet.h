// A flat triangle that a ray was found to hit: where exactly, in double precision.
#pragma once

#include "base/vector.h"

#include <array>
#include <optional>

namespace rayleaf {

using FacetCorners = std::array<Vec3d, 3>;

struct FacetHit {
    double t = 0;             ///< along `direction`, in its lengths
    double u = 0, v = 0;      ///< weights of corners 1 and 2; both, and 1 - u - v, are not negative
    Vec3d position{0, 0, 0};  ///< on the facet to double precision
};

/// Twice the facet's area along its normal by the winding.
inline Vec3d area_vector(const FacetCorners& corners) {
    return (corners[1] - corners[0]).cross(corners[2] - corners[0]);
}

/// The hit of a ray that a test in single precision has found inside the facet. That test decides about inside, since
/// it agrees with the neighbours' along shared edges; here the point is only made exact, so weights that leave the
/// facet are drawn back to its border. Empty where the ray lies in the facet's plane.
std::optional<FacetHit> exact_facet_hit(const FacetCorners& corners, const Vec3d& origin, const Vec3d& direction);

}  // namespace rayleaf
