// The boxes around instances as they are turned: what rays must meet in a leaf of the tree above the instances. They
// are met in single precision, and padded for that.
#pragma once

#include "base/vector.h"
#include "tessellation/ray_packet.h"
#include "trace/box_tree.h"

#include <cstdint>

namespace rayleaf {

/// Three slabs in the space of the tree, padded as its boxes are: an image of the shape's box or snug box, so a flat
/// shape that is turned has a flat box.
struct OrientedBox {
    Vec3f axis[3];          ///< unit normals of the slabs
    float low[3], high[3];  ///< where the slabs are along them
    bool is_straight;       ///< the axes are x, y and z of the tree
};

/// The boxes of a leaf, in the lanes of vectors. Lanes from `count` on hold anything finite.
struct alignas(64) OrientedBoxes {
    static constexpr uint32_t kMost = BoxTree::kMostInLeaf;

    float axis[3][3][kMost] = {};  ///< by slab and coordinate
    float low[3][kMost] = {}, high[3][kMost] = {};
    uint32_t count = 0;
    uint32_t straight = 0;  ///< boxes along x, y and z, a bit each: rays meet those in less time

    void set(uint32_t lane, const OrientedBox& box) {
        straight = (straight & ~(1u << lane)) | (box.is_straight ? 1u << lane : 0u);
        for (int slab = 0; slab < 3; ++slab) {
            for (int i = 0; i < 3; ++i) axis[slab][i][lane] = box.axis[slab][i];
            low[slab][lane] = box.low[slab];
            high[slab][lane] = box.high[slab];
        }
    }
};

/// What a packet meets of a leaf, by box.
struct MetBoxes {
    uint32_t lanes[OrientedBoxes::kMost];
    alignas(64) float nears[OrientedBoxes::kMost][kPacketSize];  ///< where a ray enters, from its origin on
    alignas(64) float fars[OrientedBoxes::kMost][kPacketSize];   ///< where it leaves, or ends
};

struct OrientedBoxKernels {
    /// The boxes that a ray meets up to `farthest`, a bit each. `nears`: where it enters them, from its origin on.
    uint32_t (*alone)(const OrientedBoxes& boxes, const Vec3f& origin, const Vec3f& direction, float farthest,
                      float (&nears)[OrientedBoxes::kMost]);
    /// The same for all rays of a packet, each up to its `farthest`.
    void (*together)(const OrientedBoxes& boxes, const RayPacket& rays, const float* farthest, MetBoxes& met);
};
/// The versions for this machine's processor.
OrientedBoxKernels oriented_box_kernels();

/// Calls `visit` with the number of each bit, that of the least of `keys` first, until it returns false.
template <typename Visit>
void for_each_by_key(uint32_t bits, const float* keys, const Visit& visit) {
    uint32_t order[OrientedBoxes::kMost];
    int count = 0;
    for (; bits != 0; bits &= bits - 1) {
        const auto number = static_cast<uint32_t>(__builtin_ctz(bits));
        int at = count++;
        for (; at > 0 && keys[order[at - 1]] > keys[number]; --at) order[at] = order[at - 1];
        order[at] = number;
    }
    for (int i = 0; i < count; ++i)
        if (!visit(order[i])) return;
}

}  // namespace rayleaf
