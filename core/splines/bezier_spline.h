// Blender's Bezier curves. Whatever their handle types (free, vector, aligned, automatic), the data holds the resolved
// coordinates of the handles, so the segments are cubic Bezier curves without further work.
#pragma once

#include "splines/nurbs.h"

#include <optional>
#include <vector>

namespace rayleaf {

struct BezierKnot {
    Vec3d handle_left, point, handle_right;  ///< object space
};

struct BezierSpline {
    std::vector<BezierKnot> knots;
    bool cyclic = false;  ///< one more segment, from the last knot to the first
};

/// Empty if the spline can be converted. Fewer than two knots draw nothing.
std::optional<SplineProblem> find_problem(const BezierSpline& spline);
/// The spline must be valid. Segments have equal parameter ranges and are C^0 by construction.
BezierChain to_bezier(const BezierSpline& spline);

}  // namespace rayleaf
