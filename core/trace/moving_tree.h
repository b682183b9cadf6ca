// A tree of boxes in which each ray meets the items where they are at its time. Boxes of what deforms go along lines
// between even times of the shutter, as what they hold does: so they stay as tight as those of what rests.
#pragma once

#include "trace/box_traversal.h"
#include "trace/box_tree.h"

namespace rayleaf {

class MovingTree {
  public:
    /// Empty: nothing is met.
    MovingTree() = default;
    /// `tree` is around the items at all times. With one step nothing moves, and `box_of` is not asked; else it is an
    /// item's or a leaf's box at a step.
    MovingTree(BoxTree tree, size_t steps, const std::function<Box3f(uint32_t, size_t)>& box_of);

    bool empty() const { return tree_.empty(); }
    /// Of the items at all times.
    const BoxTree& still() const { return tree_; }
    uint64_t bytes() const { return tree_.bytes() + bounds_.bytes(); }
    /// As of BoxTraversal; `times` are of the shutter, by lane.
    void packet(uint32_t root, const RayPacket& rays, const float* times, uint32_t lanes, int few, float* farthest,
                const BoxVisitor& visitor) const;
    void in_turn(const RayPacket& rays, const float* times, uint32_t lanes, float* farthest,
                 const BoxVisitor& visitor) const;
    void alone(uint32_t root, const Vec3f& origin, const Vec3f& direction, float time, float* farthest,
               const BoxVisitor& visitor) const;

  private:
    BoxTraversal traversal_{};
    BoxTree tree_;
    size_t steps_ = 1;
    LargeArray<BoxBounds> bounds_;  ///< of more than one step

    template <typename Follow>
    void at_times(const float* times, uint32_t lanes, const Follow& follow) const;
};

}  // namespace rayleaf
