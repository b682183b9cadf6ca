#include "trace/box_traversal.h"

#include "base/simd_choice.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <new>
#include <utility>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "trace/box_traversal.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace rayleaf {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#include "base/lanes.inl"
#include "trace/box_ray.inl"

/// A packet: the rays in the lanes, the children of a node one after the other.
template <typename NodeBoxes>
class ManyRays {
  public:
    HWY_INLINE ManyRays(const RayPacket& rays, int few, const NodeBoxes& boxes, const BoxVisitor& visitor)
        : rays_(rays), few_(few), boxes_(boxes), visitor_(visitor) {
        const RayVector huge = hn::Set(Rays(), kHuge), least = hn::Set(Rays(), 1.0f / kHuge);
        for (int axis = 0; axis < 3; ++axis) {
            for (int first = 0; first < kPacketSize; first += kRayWidth) {
                const RayVector component = hn::Load(Rays(), rays.unit_direction[axis] + first);
                const auto usual = hn::Gt(hn::Abs(component), least);
                const RayVector inverse =
                    hn::IfThenElse(usual, hn::Div(hn::Set(Rays(), 1.0f), component), hn::CopySign(huge, component));
                const RayVector origin = hn::Load(Rays(), rays.near_origin[axis] + first);
                hn::Store(inverse, Rays(), inverse_[axis] + first);
                hn::Store(hn::Mul(origin, inverse), Rays(), offset_[axis] + first);
            }
        }
    }
    HWY_INLINE void visit(const BoxNode* nodes, uint32_t root, uint32_t lanes, float* farthest) {
        count_ = 0;
        WaitingPacket& first = waiting_[count_++];
        first.child = root;
        first.lanes = lanes;
        for (float& near : first.near) near = 0.0f;
        while (count_ > 0) {
            const WaitingPacket& next = waiting_[--count_];
            const uint32_t child = next.child, left = next.lanes & reached(next.near, farthest);
            if (left == 0) continue;
            if ((child & BoxNode::kLeaf) != 0)
                visitor_.visit(visitor_.owner, child & ~BoxNode::kLeaf, left, farthest);
            else if (std::popcount(left) > few_)
                add_children(nodes, child, left, farthest);
            else
                visit_one_by_one(nodes, child, left, farthest);
        }
    }

  private:
    struct alignas(64) WaitingPacket {
        float near[kPacketSize];
        uint32_t child, lanes;
    };
    const RayPacket& rays_;
    int few_, count_ = 0;
    NodeBoxes boxes_;
    const BoxVisitor& visitor_;
    alignas(64) float inverse_[3][kPacketSize];
    alignas(64) float offset_[3][kPacketSize];
    WaitingPacket waiting_[kMostWaiting];

    static HWY_INLINE uint32_t reached(const float* near, const float* farthest) {
        uint32_t bits = 0;
        for (int first = 0; first < kPacketSize; first += kRayWidth)
            bits |= mask_bits(Rays(), hn::Le(hn::Load(Rays(), near + first), hn::LoadU(Rays(), farthest + first)))
                    << first;
        return bits;
    }
    HWY_INLINE void visit_one_by_one(const BoxNode* nodes, uint32_t child, uint32_t lanes, float* farthest) const {
        for (; lanes != 0; lanes &= lanes - 1) {
            const auto lane = static_cast<uint32_t>(__builtin_ctz(lanes));
            const float origin[3] = {rays_.near_origin[0][lane], rays_.near_origin[1][lane],
                                     rays_.near_origin[2][lane]};
            const float direction[3] = {rays_.unit_direction[0][lane], rays_.unit_direction[1][lane],
                                        rays_.unit_direction[2][lane]};
            OneRay<NodeBoxes>(origin, direction, boxes_, lane).visit(nodes, child, lane, farthest, visitor_);
        }
    }
    /// The one that is nearest to the first ray comes last, to be visited first. A box around the ray's origin is as
    /// far as where the ray leaves it: what such boxes hold, like domes, is mostly at their borders.
    HWY_INLINE void add_children(const BoxNode* nodes, uint32_t number, uint32_t lanes, const float* farthest) {
        const BoxNode& node = nodes[number];
        alignas(64) float nears[BoxNode::kMostChildren][kPacketSize];
        uint32_t met[BoxNode::kMostChildren];
        float keys[BoxNode::kMostChildren];
        uint32_t order[BoxNode::kMostChildren];
        int found = 0;
        for (uint32_t child = 0; child < node.count; ++child) {
            alignas(64) float fars[kPacketSize];
            met[child] = meet(nodes, number, child, farthest, nears[child], fars) & lanes;
            if (met[child] == 0) continue;
            const auto first = static_cast<size_t>(__builtin_ctz(met[child]));
            keys[child] = nears[child][first] > 0.0f ? nears[child][first] : fars[first];
            int at = found++;
            for (; at > 0 && keys[order[at - 1]] < keys[child]; --at) order[at] = order[at - 1];
            order[at] = child;
        }
        for (int i = 0; i < found; ++i) {
            WaitingPacket& entry = waiting_[count_++];
            for (int first = 0; first < kPacketSize; first += kRayWidth)
                hn::Store(hn::Load(Rays(), nears[order[i]] + first), Rays(), entry.near + first);
            entry.child = node.child[order[i]];
            entry.lanes = met[order[i]];
            fetch(nodes, entry.child, visitor_);
        }
    }
    /// The lanes that meet a child.
    HWY_INLINE uint32_t meet(const BoxNode* nodes, uint32_t number, uint32_t child, const float* farthest, float* nears,
                             float* fars) const {
        uint32_t bits = 0;
        for (int first = 0; first < kPacketSize; first += kRayWidth) {
            RayVector near = hn::Zero(Rays()), far = hn::LoadU(Rays(), farthest + first);
            for (int axis = 0; axis < 3; ++axis) {
                const RayVector inverse = hn::Load(Rays(), inverse_[axis] + first);
                const RayVector offset = hn::Load(Rays(), offset_[axis] + first);
                const RayVector a = hn::MulSub(boxes_.child(nodes, number, axis, 0, child, first), inverse, offset);
                const RayVector b = hn::MulSub(boxes_.child(nodes, number, axis, 1, child, first), inverse, offset);
                near = hn::Max(near, hn::Min(a, b));
                far = hn::Min(far, hn::Max(a, b));
            }
            bits |= mask_bits(Rays(), hn::Le(near, far)) << first;
            hn::Store(near, Rays(), nears + first);
            hn::Store(far, Rays(), fars + first);
        }
        return bits;
    }
};

/// All rays of a packet alone, a step each in turn.
template <typename NodeBoxes>
HWY_INLINE void follow_in_turn(const BoxNode* nodes, const RayPacket& rays, uint32_t lanes, const NodeBoxes& boxes,
                               float* farthest, const BoxVisitor& visitor) {
    struct InTurn {
        OneRay<NodeBoxes> ray;
        OnTheWay way;
    };
    alignas(InTurn) std::byte room[kPacketSize * sizeof(InTurn)];
    InTurn* left[kPacketSize];
    int count = 0;
    for (; lanes != 0; lanes &= lanes - 1) {
        const auto lane = static_cast<uint32_t>(__builtin_ctz(lanes));
        const float origin[3] = {rays.near_origin[0][lane], rays.near_origin[1][lane], rays.near_origin[2][lane]};
        const float direction[3] = {rays.unit_direction[0][lane], rays.unit_direction[1][lane],
                                    rays.unit_direction[2][lane]};
        left[count] = new (room + sizeof(InTurn) * static_cast<size_t>(count))
            InTurn{OneRay<NodeBoxes>(origin, direction, boxes, lane), OnTheWay(lane, 0)};
        ++count;
    }
    while (count > 0) {
        for (int i = 0; i < count;) {
            if (left[i]->ray.step(nodes, left[i]->way, farthest, visitor))
                ++i;
            else
                left[i] = left[--count];
        }
    }
}

void traverse_packet(const BoxNode* nodes, uint32_t root, const RayPacket& rays, uint32_t lanes, int few,
                     float* farthest, const BoxVisitor& visitor) {
    ManyRays<StillBoxes>(rays, few, {}, visitor).visit(nodes, root, lanes, farthest);
}

void traverse_moving_packet(const BoxNode* nodes, uint32_t root, const MovingBoxes& boxes, const RayPacket& rays,
                            uint32_t lanes, int few, float* farthest, const BoxVisitor& visitor) {
    ManyRays<BoxesInMotion>(rays, few, {boxes}, visitor).visit(nodes, root, lanes, farthest);
}

void traverse_in_turn(const BoxNode* nodes, const RayPacket& rays, uint32_t lanes, float* farthest,
                      const BoxVisitor& visitor) {
    follow_in_turn(nodes, rays, lanes, StillBoxes(), farthest, visitor);
}

void traverse_moving_in_turn(const BoxNode* nodes, const MovingBoxes& boxes, const RayPacket& rays, uint32_t lanes,
                             float* farthest, const BoxVisitor& visitor) {
    follow_in_turn(nodes, rays, lanes, BoxesInMotion{boxes}, farthest, visitor);
}

void traverse_alone(const BoxNode* nodes, uint32_t root, const Vec3f& origin, const Vec3f& direction, float* farthest,
                    const BoxVisitor& visitor) {
    const float from[3] = {origin.x, origin.y, origin.z}, along[3] = {direction.x, direction.y, direction.z};
    OneRay<StillBoxes>(from, along, {}, 0).visit(nodes, root, 0, farthest, visitor);
}

void traverse_moving_alone(const BoxNode* nodes, uint32_t root, const MovingBoxes& boxes, const Vec3f& origin,
                           const Vec3f& direction, float* farthest, const BoxVisitor& visitor) {
    const float from[3] = {origin.x, origin.y, origin.z}, along[3] = {direction.x, direction.y, direction.z};
    OneRay<BoxesInMotion>(from, along, {boxes}, 0).visit(nodes, root, 0, farthest, visitor);
}

}  // namespace HWY_NAMESPACE
}  // namespace rayleaf
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rayleaf {

HWY_EXPORT(traverse_packet);
HWY_EXPORT(traverse_alone);
HWY_EXPORT(traverse_moving_packet);
HWY_EXPORT(traverse_in_turn);
HWY_EXPORT(traverse_moving_in_turn);
HWY_EXPORT(traverse_moving_alone);

BoxTraversal box_traversal() {
    choose_kernels();
    BoxTraversal traversal;
    traversal.packet = &HWY_DYNAMIC_DISPATCH(traverse_packet);
    traversal.in_turn = &HWY_DYNAMIC_DISPATCH(traverse_in_turn);
    traversal.alone = &HWY_DYNAMIC_DISPATCH(traverse_alone);
    traversal.moving_packet = &HWY_DYNAMIC_DISPATCH(traverse_moving_packet);
    traversal.moving_in_turn = &HWY_DYNAMIC_DISPATCH(traverse_moving_in_turn);
    traversal.moving_alone = &HWY_DYNAMIC_DISPATCH(traverse_moving_alone);
    return traversal;
}

}  // namespace rayleaf
#endif
