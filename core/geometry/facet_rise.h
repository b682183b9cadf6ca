// Where a smooth surface lies above the flat facet that stands for it.
//
// Each edge is replaced by a parabola; the surface between is the quadratic polynomial with these three borders. Shadow
// rays that start there do not meet the mesh's own facets where the smooth surface would not shade itself: the shadow
// terminator problem. See Hanika, "Hacking the Shadow Terminator", Ray Tracing Gems II (2021), chapter 4, which
// projects to the corners' planes instead. The parabola is twice as high as one at right angles to the normals at its
// ends, as in Cycles: in coarse meshes these are seldom the normals of a surface through all corners.
#pragma once

#include "geometry/facet.h"

namespace rayleaf {

/// Height above the facet along the interpolated normal, at weights `u` and `v` of corners 1 and 2. Negative where
/// the normals converge. `normals` are of unit length.
inline double facet_rise(const FacetCorners& corners, const std::array<Vec3f, 3>& normals, double u, double v) {
    const auto along_edge = [&](size_t i, size_t k) {
        return (corners[k] - corners[i]).dot(Vec3d(normals[k] - normals[i]));
    };
    const double w = 1.0 - u - v;
    return w * u * along_edge(0, 1) + u * v * along_edge(1, 2) + w * v * along_edge(0, 2);
}

}  // namespace rayleaf
