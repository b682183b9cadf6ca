// One parametric direction of a spline after conversion to Bezier form: which spans it has and how they join.
#pragma once

#include "base/vector.h"

#include <cstdint>
#include <vector>

namespace rayleaf {

/// Continuity of spans that do not join at all (an open end, a tear).
inline constexpr int kDisjoint = -1;

struct SplineSpan {
    double begin = 0, end = 1;  ///< parameter range over the whole spline, which is [0,1]; proportional to the knots
    uint32_t first_point = 0;   ///< the span's control points are first_point .. first_point + degree of the axis
    /// k where the spline is C^k (at least) across the border to the next span, the first one after the last of a
    /// closed axis; kDisjoint where they do not join. By the knots' multiplicity: coincident control points may break
    /// or gain smoothness of the shape.
    int continuity_after = kDisjoint;
};

struct SplineAxis {
    int degree = 0;
    bool closed = false;       ///< the last point repeats the first bit by bit
    uint32_t point_count = 0;  ///< along this axis; joined spans share their border point
    std::vector<SplineSpan> spans;

    /// The span that holds a parameter in [0,1], the later one at a border; the nearest one outside.
    size_t span_at(double parameter) const;
    /// A parameter of the whole spline as the parameter in [0,1] of a span that holds it.
    double local_parameter(size_t span, double parameter) const;
};

}  // namespace rayleaf
