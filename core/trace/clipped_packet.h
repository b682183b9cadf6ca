// The rays of a packet in the local space of a shape, clipped to its box: clipped_ray (trace/local_ray.h) in each lane,
// to the bit.
#pragma once

#include "base/vector.h"
#include "tessellation/ray_packet.h"

#include <cstdint>

namespace rayleaf {

/// Rays in world space, by lane. Lanes that are not asked hold anything.
struct alignas(64) WorldPacket {
    double origin[3][kPacketSize];
    double direction[3][kPacketSize];
    double t_min[kPacketSize], t_max[kPacketSize];
};

/// World -> local: the translation is subtracted, then the images of the axes are added up.
struct RayMap {
    Vec3d translation{0, 0, 0};
    Vec3d x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
};

/// Sets the lanes of `rays` that it returns: of those asked, the ones that meet the box within [t_min, t_max].
using ClipPacket = uint32_t (*)(const WorldPacket& world, uint32_t lanes, const RayMap& map, const Box3d& box,
                                RayPacket& rays);
/// The version for this machine's processor.
ClipPacket clip_kernel();

}  // namespace rayleaf
