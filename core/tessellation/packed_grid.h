// Medium grids in one or two cache lines instead of five, without loss: the differences of their vertices from a
// surface of few numbers.
//
// The corners are in the record that is read anyway (tessellation/level.h). A difference counts single-precision
// numbers between a coordinate and its prediction, so borders keep their bits. Relative to the bilinear patch of the
// corners, 16 bits are enough for smooth surfaces, except for grids across a coordinate plane. If patches are small,
// the biquadratic patch through 3 x 3 of the vertices predicts the others to 5 bits.
#pragma once

#include "tessellation/grid.h"
#include "tessellation/level.h"

#include <cstdint>

namespace rayleaf {

/// Differences from the bilinear patch.
struct alignas(64) PackedGrid {
    static constexpr int kInner = kBlockSize - kCorners;
    int16_t steps[3][kInner];  ///< by axis, of all vertices but the corners, in the grid's order
};

/// Differences from the biquadratic patch.
struct alignas(64) SmoothGrid {
    static constexpr int kMiddles = 5, kOthers = kBlockSize - kCorners - kMiddles;
    int16_t middles[3][kMiddles];  ///< by axis, of the vertices of 3 x 3 but the corners, above the bilinear patch
    uint16_t others[kOthers];      ///< 5 bits an axis, 16 more than the difference
};

/// False if the grid cannot be packed this way: it bends too much, or its corners are not those of `detail`.
bool pack(const MediumGrid& grid, const SubpatchDetail& detail, PackedGrid& packed);
bool pack(const MediumGrid& grid, const SubpatchDetail& detail, SmoothGrid& packed);
/// The grid that was packed, bit by bit.
void unpack(const PackedGrid& packed, const SubpatchDetail& detail, MediumGrid& grid);
void unpack(const SmoothGrid& packed, const SubpatchDetail& detail, MediumGrid& grid);

}  // namespace rayleaf
