// A medium grid in two lines of cache instead of five: what its vertices differ from the bilinear patch of its corners.
//
// The corners lie in the record that is read anyway (tessellation/level.h). A difference is one of bits: by how many
// floats of single precision a coordinate lies above the bilinear one. So nothing is lost, and borders keep their bits.
// Grids of smooth surfaces need no more than 16 bits for it, but for those that lie across a plane of the axes.
#pragma once

#include "tessellation/grid.h"
#include "tessellation/level.h"

#include <cstdint>

namespace rayleaf {

struct alignas(64) PackedGrid {
    static constexpr int kInner = kBlockSize - kCorners;
    int16_t steps[3][kInner];  ///< by axis, of all vertices but the corners, in the grid's order
};

/// False if the grid cannot be packed: it bends too much, or its corners are not those of `detail`.
bool pack(const MediumGrid& grid, const SubpatchDetail& detail, PackedGrid& packed);
/// The grid that was packed, bit by bit.
void unpack(const PackedGrid& packed, const SubpatchDetail& detail, MediumGrid& grid);

}  // namespace rayleaf
