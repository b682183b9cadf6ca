// The point of a patch nearest to a given point: Newton's method from several starts.
//
// For checks and tools, not for rendering: it finds the global minimum if a sampling of kClosestPointGrid² points
// separates it from other local minima.
#pragma once

#include "base/vector.h"
#include "splines/bezier_patch.h"

namespace rayleaf {

inline constexpr int kClosestPointGrid = 9, kClosestPointStarts = 6;

struct ClosestPoint {
    double u = 0, v = 0;
    Vec3d position;
    double distance = 0;  ///< units of the control points
};

ClosestPoint closest_point(const PatchView& patch, const Vec3d& target);

}  // namespace rayleaf
