// Sizes and bends of a diced subpatch, from which its levels and its box are chosen.
#pragma once

#include "tessellation/grid.h"

namespace rayleaf {

/// Borders of a subpatch: v = 0, u = 1, v = 1, u = 0.
inline constexpr int kBorders = 4;

/// Second differences between vertices: the largest squared lengths over the grid.
struct GridMeasure {
    float low[3], high[3];  ///< of all vertices, by axis
    float uu, uv, vv;       ///< p(i-1) + p(i+1) - 2 p(i) along u and along v, and the twist of cells
    /// Along each border; the same bits in either direction.
    float border[kBorders];
};

/// NaN coordinates are left out of differences.
GridMeasure measure_grid(const GridRows& rows);

}  // namespace rayleaf
