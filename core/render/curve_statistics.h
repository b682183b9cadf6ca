// What curves and hair a scene holds, for the statistics.
#pragma once

#include "geometry/shape.h"

#include <cstdint>

namespace rayleaf {

/// Each shape counts once, however many instances it has. How many shapes there are, and how large: ShapeShares.
struct CurveStatistics {
    uint64_t splines = 0, pieces = 0;    ///< of bevelled curves
    uint64_t strands = 0, segments = 0;  ///< of hair

    void add(const Shape& shape);
};

}  // namespace rayleaf
