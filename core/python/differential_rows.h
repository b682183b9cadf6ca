// Ray differentials as Python sees them.
#pragma once

#include "python/arrays.h"
#include "rays/ray_differential.h"

namespace rayleaf {

/// dp_dx, dp_dy, dd_dx, dd_dy.
using Rows = std::array<Vector, 4>;

inline RayDifferential differential(const Rows& rows) {
    return {vec(rows[0]), vec(rows[1]), vec(rows[2]), vec(rows[3])};
}
inline Rows rows(const RayDifferential& d) {
    return {tuple(d.dp_dx), tuple(d.dp_dy), tuple(d.dd_dx), tuple(d.dd_dy)};
}

}  // namespace rayleaf
