// A ray against the 512 facets of a grid: SIMD over blocks of 4 x 4 cells, in single precision.
//
// As in Woop, Benthin, Wald, "Watertight Ray/Triangle Intersection" (JCGT 2013): vertices are moved to the ray's origin
// and sheared so that the ray is the z axis; what side of an edge p q the ray passes is the sign of px qy - py qx.
// Rounding is monotonic, so without fused multiply-add fl(px qy) and fl(py qx) never compare the wrong way round: the
// computed sign is the exact one or zero. Zero counts as inside for the facets on both sides. So with the same sheared
// vertices no ray passes between facets that share an edge or a vertex, and the paper's fallback to double precision
// is not needed; a ray through an edge may find both facets.
#pragma once

#include "base/vector.h"
#include "tessellation/grid.h"

#include <cstdint>
#include <optional>

namespace rayleaf {

/// A float ray as the kernel wants it. `direction` is unit length; the origin has coordinates of the order of 1.
struct GridRay {
    GridRay() = default;
    GridRay(const Vec3f& ray_origin, const Vec3f& direction);

    float origin[3];                  ///< by axis
    float inverse[3];                 ///< 1 / direction; huge where that is zero
    int axis_x, axis_y, axis_z;       ///< axis_z is the direction's largest component
    float shear_x, shear_y, scale_z;  ///< dx/dz, dy/dz, 1/dz
};

/// A facet that the ray hits, as far as single precision can tell.
struct GridCandidate {
    float t = 0;  ///< along the unit direction
    uint32_t triangle = 0;

    /// Before all candidates.
    static GridCandidate none() { return {-1.0f, 0}; }
};

/// Of the facets the ray hits after `last`, in the order of t and then of the triangle's number, the first; empty if
/// there is none up to t_max. Facets before the origin do not count.
using NextCandidate = bool (*)(const Grid& grid, const GridRay& ray, float t_max, const GridCandidate& last,
                               GridCandidate& next);
/// The version for this machine's processor.
NextCandidate next_candidate_function();

}  // namespace rayleaf
