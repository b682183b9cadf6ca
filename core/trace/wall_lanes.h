// The walls of bevelled curves at several hits at once, in the lanes of vectors of doubles.
//
// Each lane does what SweepPath::evaluate and SweptSurface::wall_surface do for one hit, in the same order, so that the
// bits are the same.
#pragma once

#include "geometry/swept_surface.h"
#include "trace/surface_lanes.h"

namespace rayleaf {

/// Of each hit what CurvedPlace, WallPlace and the path hold.
// NOLINTNEXTLINE(clang-analyzer-optin.performance.Padding)
struct WallLanes {
    static constexpr size_t kMost = SurfaceLanes::kMost;

    const SweepControl* controls[kMost];
    alignas(64) double t[kMost], length[kMost], size[kMost], scale[kMost];  ///< size: of the segment
    alignas(64) double tangent[3][kMost], normal[3][kMost], turn[kMost], turn_change[kMost];
    alignas(64) double factor[kMost], factor_change[kMost], added[kMost], added_change[kMost];
    alignas(64) double place[2][kMost], direction[2][kMost];  ///< of the profile: position and first derivative
    alignas(64) double length_u[kMost], length_v[kMost];
};

/// Whether there is a version for pieces of this one's kind: curved, in space, of a plain cubic.
bool has_wall_lanes(const SweepPath& path, const SweepPiece& piece);
/// Finds the local surface where it is smooth, as far as the detail Normal needs it.
void compute_walls(const WallLanes& walls, SurfaceLanes& lanes);

}  // namespace rayleaf
