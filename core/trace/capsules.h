// The pieces of strands in a leaf of their tree as single precision looks at them, in the lanes of vectors: whatever a
// ray may meet is found, and double precision decides.
#pragma once

#include "base/vector.h"
#include "trace/box_tree.h"

#include <cstdint>

namespace rayleaf {

/// All within `radius` of the line from `begin` to begin + way; by axis, local space. Lanes from `count` on hold
/// anything finite.
struct alignas(64) Capsules {
    static constexpr uint32_t kMost = BoxTree::kMostInLeaf;

    float begin[3][kMost] = {}, way[3][kMost] = {}, radius[kMost] = {};
    uint32_t count = 0;
};

/// A ray with two directions across it: unit and orthogonal.
struct CapsuleRay {
    Vec3f origin{0, 0, 0}, across_x{1, 0, 0}, across_y{0, 1, 0}, along{0, 0, 1};
};

/// The stretch of a ray that counts, along it.
struct CapsuleRange {
    float begin, end;
};

/// The capsules that the ray may meet in the range, a bit each. `nears`: where it meets them at the earliest.
using MeetCapsules = uint32_t (*)(const Capsules& capsules, const CapsuleRay& ray, const CapsuleRange& range,
                                  float (&nears)[Capsules::kMost]);
/// The version for this machine's processor.
MeetCapsules capsule_kernel();

}  // namespace rayleaf
