// Medium grids in one or two lines of cache instead of five, without loss: what their vertices differ from a surface
// that few numbers tell.
//
// The corners lie in the record that is read anyway (tessellation/level.h). A difference is one of bits: by how many
// floats of single precision a coordinate lies above the predicted one. So borders keep their bits. Against the
// bilinear patch of the corners 16 bits are enough for smooth surfaces, but for grids that lie across a plane of the
// axes. Where patches are small, the biquadratic patch through 3 x 3 of the vertices tells the others to 5 bits.
#pragma once

#include "tessellation/grid.h"
#include "tessellation/level.h"

#include <cstdint>

namespace rayleaf {

/// By the bilinear patch.
struct alignas(64) PackedGrid {
    static constexpr int kInner = kBlockSize - kCorners;
    int16_t steps[3][kInner];  ///< by axis, of all vertices but the corners, in the grid's order
};

/// By the biquadratic patch.
struct alignas(64) SmoothGrid {
    static constexpr int kMiddles = 5, kOthers = kBlockSize - kCorners - kMiddles;
    int16_t middles[3][kMiddles];  ///< by axis, of the vertices of 3 x 3 but the corners, above the bilinear patch
    uint16_t others[kOthers];      ///< 5 bits an axis, 16 more than the difference
};

/// False if the grid cannot be packed so: it bends too much, or its corners are not those of `detail`.
bool pack(const MediumGrid& grid, const SubpatchDetail& detail, PackedGrid& packed);
bool pack(const MediumGrid& grid, const SubpatchDetail& detail, SmoothGrid& packed);
/// The grid that was packed, bit by bit.
void unpack(const PackedGrid& packed, const SubpatchDetail& detail, MediumGrid& grid);
void unpack(const SmoothGrid& packed, const SubpatchDetail& detail, MediumGrid& grid);

}  // namespace rayleaf
