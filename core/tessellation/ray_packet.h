// Up to sixteen rays in the local space of a shape, by lane: structure of arrays for the kernels of packets.
#pragma once

#include "base/vector.h"
#include "rays/packet.h"

#include <array>
#include <cstdint>

namespace rayleaf {

/// Triangles of a block of facets.
inline constexpr uint32_t kBlockTriangles = 32;
/// The number of a facet among all of a shape.
constexpr uint32_t facet_number(uint32_t block, uint32_t triangle) {
    return block * kBlockTriangles + triangle;
}
/// More cannot be numbered.
inline constexpr uint64_t kMostBlocks = (uint64_t{1} << 32) / kBlockTriangles - 1;

/// The numbers of LocalRay (trace/local_ray.h), and what the kernels compute from them. Inactive lanes hold
/// anything.
struct alignas(64) RayPacket {
    double origin[3][kPacketSize];     ///< by axis
    double direction[3][kPacketSize];  ///< local units per unit of t
    double t_min[kPacketSize], t_max[kPacketSize];
    double start[kPacketSize];  ///< t of the float ray's origin
    double speed[kPacketSize];  ///< length of `direction`

    float near_origin[3][kPacketSize];     ///< the float ray's; coordinates of the order of 1
    float unit_direction[3][kPacketSize];  ///< the same
    float farthest[kPacketSize];           ///< along it: nothing beyond counts
    /// Along it: whatever lies wholly between counts, for sure.
    float sure_from[kPacketSize], sure_to[kPacketSize];
    uint32_t start_facet[kPacketSize];  ///< RayAnchor::facet where it starts on the shape: not asked

    // Set by PacketKernels::shear:
    float shear_x[kPacketSize], shear_y[kPacketSize], scale_z[kPacketSize];  ///< as GridRay's
    std::array<uint32_t, 3> by_axis{};  ///< lanes whose direction is largest along the axis, a bit each

    Vec3d origin_of(size_t lane) const { return {origin[0][lane], origin[1][lane], origin[2][lane]}; }
    Vec3d direction_of(size_t lane) const { return {direction[0][lane], direction[1][lane], direction[2][lane]}; }
};

}  // namespace rayleaf
