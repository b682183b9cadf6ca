// What curves and hair a scene holds, for the statistics.
#pragma once

#include "geometry/shape.h"

#include <cstddef>
#include <cstdint>

namespace rayleaf {

/// Each shape counts once, however many instances it has. Bytes are those of the shapes, without the trees over them.
struct CurveStatistics {
    uint64_t swept_surfaces = 0, splines = 0, pieces = 0;  ///< bevelled curves
    size_t swept_bytes = 0;
    uint64_t strand_objects = 0, strands = 0, segments = 0;  ///< hair
    size_t strand_bytes = 0;

    void add(const Shape& shape);
};

}  // namespace rayleaf
