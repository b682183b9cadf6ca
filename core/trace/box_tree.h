// A tree over the boxes of what a shape or a scene consists of, for rays alone and in packets.
//
// Embree builds it; its own traversal would carry all lanes of a packet down to the leaves, where one or two of them
// are left, and calls back through its ray formats.
#pragma once

#include "base/cancel.h"
#include "base/large_memory.h"
#include "base/vector.h"

#include <cstdint>
#include <functional>

namespace rayleaf {

struct alignas(64) BoxNode {
    static constexpr int kMostChildren = 8;
    static constexpr uint32_t kLeaf = 1u << 31;
    static constexpr int kDeepest = 32;

    float bounds[3][2][kMostChildren];  ///< by axis: low, high
    uint32_t child[kMostChildren];      ///< number of a node, or kLeaf | number of an item
    uint32_t count;                     ///< of children, at least one
};

class BoxTree {
  public:
    /// Empty: nothing is met.
    BoxTree() = default;
    /// Of `count` items; those with empty boxes are left out. Throws Cancelled if the token says so, std::runtime_error
    /// with Embree's word if the build fails.
    BoxTree(uint32_t count, const std::function<Box3f(uint32_t)>& box_of, const CancelToken& cancel);

    bool empty() const { return nodes_.size() == 0; }
    /// The first is the root.
    const BoxNode* nodes() const { return nodes_.data(); }
    uint64_t bytes() const { return nodes_.bytes(); }

  private:
    LargeArray<BoxNode> nodes_;
};

}  // namespace rayleaf
