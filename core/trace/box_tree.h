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
#include <span>
#include <utility>
#include <vector>

namespace rayleaf {

struct alignas(64) BoxNode {
    static constexpr int kMostChildren = 8;
    static constexpr uint32_t kLeaf = 1u << 31;
    static constexpr int kDeepest = 32;

    float bounds[3][2][kMostChildren];  ///< by axis: low, high
    uint32_t child[kMostChildren];      ///< number of a node, or kLeaf | number of an item
    uint32_t count;                     ///< of children, at least one
};

/// The boxes of a node's children at one time, where these move.
struct alignas(64) BoxBounds {
    float bounds[3][2][BoxNode::kMostChildren];
};

/// The items of each leaf, one leaf after the other.
struct BoxLeaves {
    std::vector<uint32_t> items;
    std::vector<uint32_t> first;  ///< of each leaf, and at the end the number of items

    uint32_t count() const { return static_cast<uint32_t>(first.size()) - 1; }
};

class BoxTree {
  public:
    static constexpr uint32_t kMostInLeaf = 8;

    /// Empty: nothing is met.
    BoxTree() = default;
    /// Of `count` items; those with empty boxes are left out. Throws Cancelled if the token says so, std::runtime_error
    /// with Embree's word if the build fails.
    BoxTree(uint32_t count, const std::function<Box3f(uint32_t)>& box_of, const CancelToken& cancel);
    /// The same with up to `most_in_leaf` items in a leaf, at most kMostInLeaf: rays meet leaves, by their number.
    BoxTree(uint32_t count, const std::function<Box3f(uint32_t)>& box_of, const CancelToken& cancel,
            uint32_t most_in_leaf, BoxLeaves& leaves);

    /// Renews the boxes of some leaves, which are not empty.
    void refit(std::span<const uint32_t> leaves, const std::function<Box3f(uint32_t)>& box_of);
    bool empty() const { return nodes_.size() == 0; }
    /// The first is the root.
    const BoxNode* nodes() const { return nodes_.data(); }
    uint64_t bytes() const { return nodes_.bytes(); }
    /// The boxes of all nodes at even times, where the boxes of leaves move along lines: node by node, each at all
    /// times. `box_of`: that of what a leaf names, at one of the times.
    LargeArray<BoxBounds> moving_bounds(size_t steps, const std::function<Box3f(uint32_t, size_t)>& box_of) const;

  private:
    LargeArray<BoxNode> nodes_;
    std::vector<uint32_t> node_of_leaf_, parent_;  ///< filled by the first refit

    void find_parents();
    explicit BoxTree(LargeArray<BoxNode> nodes) : nodes_(std::move(nodes)) {}
};

}  // namespace rayleaf
