// Finds items by their boxes: boxes around groups of consecutive items, boxes around groups of those, and
// so on. Where neighbours in number are neighbours in space, as in meshes and patches, a question looks at few of them.
#pragma once

#include "base/cancel.h"
#include "base/vector.h"

#include <cstdint>
#include <functional>
#include <vector>

namespace rayleaf {

class GroupedBoxes {
  public:
    using BoxOf = std::function<Box3d(uint32_t thing)>;
    using Test = std::function<bool(uint32_t thing)>;

    /// Over so many items; empty boxes are never found. Throws Cancelled soon after `cancel` says so.
    GroupedBoxes(uint32_t count, const BoxOf& box_of, const CancelToken& cancel);

    /// Whether a test is true of any item whose group's box meets this one: of all items that meet it, and others.
    bool any(const Box3d& box, const Test& test) const;

  private:
    static constexpr uint32_t kGroup = 8;

    uint32_t count_;
    std::vector<std::vector<Box3d>> levels_;  ///< boxes of groups of items first, the box of all items last

    bool any_below(size_t level, uint32_t group, const Box3d& box, const Test& test) const;
};

}  // namespace rayleaf
