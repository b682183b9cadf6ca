#include "trace/moving_tree.h"

#include "rays/motion.h"
#include "trace/shape_scene.h"

#include <array>

namespace rayleaf {

MovingTree::MovingTree(BoxTree tree, size_t steps, const std::function<Box3f(uint32_t, size_t)>& box_of)
    : traversal_(box_traversal()), tree_(std::move(tree)), steps_(steps) {
    if (steps > 1) bounds_ = tree_.moving_bounds(steps, box_of);
}

void MovingTree::packet(uint32_t root, const RayPacket& rays, const float* times, uint32_t lanes, int few,
                        float* farthest, const BoxVisitor& visitor) const {
    if (steps_ == 1) {
        traversal_.packet(tree_.nodes(), root, rays, lanes, few, farthest, visitor);
        return;
    }
    at_times(times, lanes, [&](const MovingBoxes& boxes, uint32_t together) {
        traversal_.moving_packet(tree_.nodes(), root, boxes, rays, together, few, farthest, visitor);
    });
}

void MovingTree::in_turn(const RayPacket& rays, const float* times, uint32_t lanes, float* farthest,
                         const BoxVisitor& visitor) const {
    if (steps_ == 1) {
        traversal_.in_turn(tree_.nodes(), rays, lanes, farthest, visitor);
        return;
    }
    at_times(times, lanes, [&](const MovingBoxes& boxes, uint32_t together) {
        traversal_.moving_in_turn(tree_.nodes(), boxes, rays, together, farthest, visitor);
    });
}

/// Hands on the boxes at the times of lanes, those together that lie between the same two steps.
template <typename Follow>
void MovingTree::at_times(const float* times, uint32_t lanes, const Follow& follow) const {
    alignas(64) float share[kPacketSize] = {};
    std::array<size_t, kPacketSize> first{};
    for_each_lane(lanes, [&](size_t lane) {
        const StepShare step = step_share(times[lane], steps_);
        first[lane] = step.first;
        share[lane] = static_cast<float>(step.share);
    });
    while (lanes != 0) {
        const size_t now = first[static_cast<size_t>(__builtin_ctz(lanes))];
        uint32_t together = 0;
        for_each_lane(lanes, [&](size_t lane) { together |= first[lane] == now ? 1u << lane : 0u; });
        follow(MovingBoxes{bounds_.data() + now, steps_, share}, together);
        lanes &= ~together;
    }
}

void MovingTree::alone(uint32_t root, const Vec3f& origin, const Vec3f& direction, float time, float* farthest,
                       const BoxVisitor& visitor) const {
    if (steps_ == 1) {
        traversal_.alone(tree_.nodes(), root, origin, direction, farthest, visitor);
        return;
    }
    const StepShare step = step_share(time, steps_);
    const auto share = static_cast<float>(step.share);
    traversal_.moving_alone(tree_.nodes(), root, {bounds_.data() + step.first, steps_, &share}, origin, direction,
                            farthest, visitor);
}

}  // namespace rayleaf
