// A grid of fixed-point numbers in half the memory: vertices are 16-bit offsets from the grid's own corner.
//
// All such grids of a shape use the same steps, 2^shift of those of fixed-point numbers, and vertices are integer steps
// of the shape's local space before a grid subtracts its corner. So neighbours decode a common border to the same
// numbers, whatever their corners are.
#pragma once

#include "tessellation/grid.h"

#include <cstdint>

namespace rayleaf {

/// With a step of 2^-23, coordinates up to 1 are less than 2^23 steps, which are exact in floats.
inline constexpr int kLeastShift = 7;
/// The longest box, in steps, of a grid that can be stored in steps.
inline constexpr int kMostSteps = 65535;

inline constexpr double step_length(int shift) {
    return kFixedStep * (1 << shift);
}

struct alignas(64) StepGrid {
    int32_t corner[3];  ///< in steps; all else is relative to it
    /// Boxes of the blocks' vertices, not padded: by axis, low then high, as in Grid.
    uint16_t boxes[3][2][kBlocks];
    uint16_t vertices[kBlocks][3][kBlockSize];
    uint16_t beyond[10];  ///< padding: kernels load whole vectors

    FacetCorners corners(uint32_t triangle, double step) const;
};

/// `grid` must hold fixed-point numbers that are multiples of 2^shift, within kMostSteps of these.
void pack(const Grid& grid, int shift, StepGrid& steps);

}  // namespace rayleaf
