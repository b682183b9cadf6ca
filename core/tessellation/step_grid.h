// A grid of fixed numbers in half its memory: vertices as 16 bits from the grid's own corner.
//
// All grids in steps of a shape count in the same steps, 2^shift of those of fixed numbers, and vertices lie on whole
// steps of the shape's local space before a grid takes its corner off. So neighbours decode a common border to the same
// numbers, whatever their corners are.
#pragma once

#include "tessellation/grid.h"

#include <cstdint>

namespace rayleaf {

/// Numbers of steps below 2^23 are exact in floats, which a step of 2^-23 makes of coordinates up to 1.
inline constexpr int kLeastShift = 7;
/// What a shape's boxes may be long, in steps, so that grids in them can be held in steps.
inline constexpr int kMostSteps = 65535;

inline constexpr double step_length(int shift) {
    return kFixedStep * (1 << shift);
}

struct alignas(64) StepGrid {
    int32_t corner[3];  ///< steps; all else counts from here
    /// Of the blocks' vertices, not padded: by axis, low then high, as in Grid.
    uint16_t boxes[3][2][kBlocks];
    uint16_t vertices[kBlocks][3][kBlockSize];
    uint16_t beyond[10];  ///< of no meaning: kernels load whole vectors

    FacetCorners corners(uint32_t triangle, double step) const;
};

/// `grid` holds fixed numbers that are multiples of 2^shift, no farther apart than kMostSteps of these.
void pack(const Grid& grid, int shift, StepGrid& steps);

}  // namespace rayleaf
