// Sixteen rays at once against one block of facets: the rays in the lanes, the block's vertices one after the other.
//
// The test is that of a single ray (grid_intersection.h), in single precision and widened by what rounding may do, so
// that it finds all facets that a true ray may hit; double precision decides (FacetRay). For rays that visit the same
// blocks it costs a fraction of what they cost one by one.
#pragma once

#include "base/vector.h"
#include "rays/packet.h"

#include <array>
#include <cstdint>

namespace rayleaf {

/// Rays in the local space of a shape, by lane.
struct alignas(64) RayPacket {
    float origin[3][kPacketSize];                                            ///< coordinates of the order of 1
    float shear_x[kPacketSize], shear_y[kPacketSize], scale_z[kPacketSize];  ///< as GridRay's
    std::array<uint32_t, 3> by_axis{};  ///< lanes whose direction is largest along the axis, a bit each

    /// `direction` is unit.
    void set(int lane, const Vec3f& from, const Vec3f& direction);
};

/// For each lane, which of a block's 32 triangles the ray may hit: bit 2 * (j * 4 + i) of cell (i, j), or the one
/// after it.
using PacketHits = std::array<uint32_t, kPacketSize>;

/// Tests the lanes of `mask` up to `farthest`, the distance along the unit direction by lane. `vertices` is [3][25].
using FindInBlock = void (*)(const float* vertices, const RayPacket& rays, uint32_t mask, const float* farthest,
                             PacketHits& hits);
/// The version for this machine's processor.
FindInBlock packet_kernel();

}  // namespace rayleaf
