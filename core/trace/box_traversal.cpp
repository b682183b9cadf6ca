#include "trace/box_traversal.h"

#include "base/simd_choice.h"

#include <algorithm>
#include <bit>
#include <cmath>
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

/// Far beyond any box, yet times a box's size still finite.
constexpr float kHuge = 1e18f;
/// A node leaves room for its children: of each level, all but the one that is visited wait.
constexpr int kMostWaiting = (BoxNode::kMostChildren - 1) * (BoxNode::kDeepest + 2) + 1;

/// What waits to be visited, as one number that can be sorted: where it begins, which is not negative, and what it is.
HWY_INLINE uint64_t waiting_at(float near, uint32_t child) {
    return uint64_t{std::bit_cast<uint32_t>(near)} << 32 | child;
}
HWY_INLINE float near_of(uint64_t waiting) {
    return std::bit_cast<float>(static_cast<uint32_t>(waiting >> 32));
}

/// Fetches what lies behind a child that has to wait.
HWY_INLINE void fetch(const BoxNode* nodes, uint32_t child, const BoxVisitor& visitor) {
    const bool is_leaf = (child & BoxNode::kLeaf) != 0;
    const auto* first = static_cast<const char*>(is_leaf ? visitor.items : nodes);
    const uint32_t bytes = is_leaf ? visitor.item_bytes : sizeof(BoxNode);
    first += size_t{child & ~BoxNode::kLeaf} * bytes;
    constexpr uint32_t kLine = 64;
    for (uint32_t offset = 0; offset < bytes; offset += kLine) hwy::Prefetch(first + offset);
}

using Boxes = hn::CappedTag<float, BoxNode::kMostChildren>;
using BoxVector = hn::Vec<Boxes>;
constexpr int kBoxWidth = static_cast<int>(hn::MaxLanes(Boxes()));
using Rays = hn::CappedTag<float, kPacketSize>;
using RayVector = hn::Vec<Rays>;
constexpr int kRayWidth = static_cast<int>(hn::MaxLanes(Rays()));

/// Boxes as the tree's nodes have them.
struct StillBoxes {
    HWY_INLINE BoxVector children(const BoxNode* nodes, uint32_t number, int axis, int side, int first,
                                  BoxVector /*share*/) const {
        return hn::Load(Boxes(), nodes[number].bounds[axis][side] + first);
    }
    HWY_INLINE RayVector child(const BoxNode* nodes, uint32_t number, int axis, int side, uint32_t child,
                               int /*first*/) const {
        return hn::Set(Rays(), nodes[number].bounds[axis][side][child]);
    }
    HWY_INLINE float share(uint32_t /*lane*/) const { return 0.0f; }
};

/// Boxes between those of two times.
struct BoxesInMotion {
    MovingBoxes of;

    HWY_INLINE BoxVector children(const BoxNode* /*nodes*/, uint32_t number, int axis, int side, int first,
                                  BoxVector share) const {
        const BoxBounds* at = of.from + number * of.steps;
        const BoxVector from = hn::Load(Boxes(), at[0].bounds[axis][side] + first);
        return hn::MulAdd(hn::Sub(hn::Load(Boxes(), at[1].bounds[axis][side] + first), from), share, from);
    }
    HWY_INLINE RayVector child(const BoxNode* /*nodes*/, uint32_t number, int axis, int side, uint32_t child,
                               int first) const {
        const BoxBounds* at = of.from + number * of.steps;
        const float from = at[0].bounds[axis][side][child];
        return hn::MulAdd(hn::Set(Rays(), at[1].bounds[axis][side][child] - from), hn::LoadU(Rays(), of.share + first),
                          hn::Set(Rays(), from));
    }
    HWY_INLINE float share(uint32_t lane) const { return of.share[lane]; }
};

/// Whether a ray meets the slabs.
HWY_INLINE bool meets(const OrientedBox& box, const float (&origin)[3], const float (&direction)[3], float farthest) {
    float near = 0.0f, far = farthest;
    for (int i = 0; i < 3; ++i) {
        const float(&axis)[3] = box.axis[i];
        const float place = axis[0] * origin[0] + axis[1] * origin[1] + axis[2] * origin[2];
        const float speed = axis[0] * direction[0] + axis[1] * direction[1] + axis[2] * direction[2];
        const float inverse = std::abs(speed) > 1.0f / kHuge ? 1.0f / speed : std::copysign(kHuge, speed);
        const float a = (box.low[i] - place) * inverse, b = (box.high[i] - place) * inverse;
        near = std::max(near, std::min(a, b));
        far = std::min(far, std::max(a, b));
    }
    return near <= far;
}

/// The lanes of the first and following rays that meet the slabs.
HWY_INLINE uint32_t lanes_that_meet(const OrientedBox& box, const RayPacket& rays, const float* farthest, int first) {
    RayVector near = hn::Zero(Rays()), far = hn::LoadU(Rays(), farthest + first);
    const RayVector huge = hn::Set(Rays(), kHuge), least = hn::Set(Rays(), 1.0f / kHuge);
    const auto along = [&](const float(&axis)[3], const auto& vectors) {
        RayVector sum = hn::Mul(hn::Set(Rays(), axis[0]), hn::Load(Rays(), vectors[0] + first));
        sum = hn::MulAdd(hn::Set(Rays(), axis[1]), hn::Load(Rays(), vectors[1] + first), sum);
        return hn::MulAdd(hn::Set(Rays(), axis[2]), hn::Load(Rays(), vectors[2] + first), sum);
    };
    for (int i = 0; i < 3; ++i) {
        const RayVector place = along(box.axis[i], rays.near_origin), speed = along(box.axis[i], rays.unit_direction);
        const RayVector inverse = hn::IfThenElse(hn::Gt(hn::Abs(speed), least), hn::Div(hn::Set(Rays(), 1.0f), speed),
                                                 hn::CopySign(huge, speed));
        const RayVector a = hn::Mul(hn::Sub(hn::Set(Rays(), box.low[i]), place), inverse);
        const RayVector b = hn::Mul(hn::Sub(hn::Set(Rays(), box.high[i]), place), inverse);
        near = hn::Max(near, hn::Min(a, b));
        far = hn::Min(far, hn::Max(a, b));
    }
    return mask_bits(Rays(), hn::Le(near, far)) << first;
}

/// One ray: the children of a node in the lanes.
template <typename NodeBoxes>
class OneRay {
  public:
    HWY_INLINE OneRay(const float (&origin)[3], const float (&direction)[3], const NodeBoxes& boxes, uint32_t lane)
        : boxes_(boxes), share_(hn::Set(Boxes(), boxes.share(lane))) {
        for (int axis = 0; axis < 3; ++axis) {
            const float component = direction[axis];
            const float inverse =
                std::abs(component) > 1.0f / kHuge ? 1.0f / component : std::copysign(kHuge, component);
            near_side_[axis] = inverse < 0.0f ? 1 : 0;
            inverse_[axis] = hn::Set(Boxes(), inverse);
            offset_[axis] = hn::Set(Boxes(), origin[axis] * inverse);
        }
    }
    HWY_INLINE void visit(const BoxNode* nodes, uint32_t root, const float (&origin)[3], const float (&direction)[3],
                          uint32_t lane, float* farthest, const BoxVisitor& visitor) const {
        uint64_t waiting[kMostWaiting];
        int count = 0;
        waiting[count++] = waiting_at(0.0f, root);
        while (count > 0) {
            const uint64_t next = waiting[--count];
            if (!(near_of(next) <= farthest[lane])) continue;
            auto child = static_cast<uint32_t>(next);
            while ((child & BoxNode::kLeaf) == 0 && go_down(nodes, farthest[lane], child, waiting, count, visitor)) {
            }
            if ((child & BoxNode::kLeaf) == 0) continue;
            const uint32_t item = child & ~BoxNode::kLeaf;
            if (!visitor.oriented || meets(visitor.oriented[item], origin, direction, farthest[lane]))
                visitor.visit(visitor.owner, item, 1u << lane, farthest);
        }
    }

  private:
    NodeBoxes boxes_;
    BoxVector share_;
    int near_side_[3];
    BoxVector inverse_[3], offset_[3];

    /// Makes `next` the nearest child that is met; the others wait, the nearest of them last. False if none is.
    HWY_INLINE bool go_down(const BoxNode* nodes, float farthest, uint32_t& next, uint64_t* waiting, int& count,
                            const BoxVisitor& visitor) const {
        const BoxNode& node = nodes[next];
        HWY_ALIGN float nears[BoxNode::kMostChildren];
        uint32_t bits = meet(nodes, next, farthest, nears);
        if (bits == 0) return false;
        const auto take = [&] {
            const auto child = static_cast<size_t>(__builtin_ctz(bits));
            bits &= bits - 1;
            return waiting_at(nears[child], node.child[child]);
        };
        uint64_t nearest = take();
        for (const int bottom = count; bits != 0;) {  // NOLINT(bugprone-infinite-loop): `take` changes the bits
            uint64_t other = take();
            if (other < nearest) std::swap(other, nearest);
            int at = count++;
            for (; at > bottom && waiting[at - 1] < other; --at) waiting[at] = waiting[at - 1];
            waiting[at] = other;
            fetch(nodes, static_cast<uint32_t>(other), visitor);
        }
        next = static_cast<uint32_t>(nearest);
        return true;
    }
    HWY_INLINE uint32_t meet(const BoxNode* nodes, uint32_t number, float farthest, float* nears) const {
        uint32_t bits = 0;
        for (int first = 0; first < BoxNode::kMostChildren; first += kBoxWidth) {
            BoxVector near = hn::Zero(Boxes()), far = hn::Set(Boxes(), farthest);
            for (int axis = 0; axis < 3; ++axis) {
                const int side = near_side_[axis];
                const BoxVector entry = boxes_.children(nodes, number, axis, side, first, share_);
                const BoxVector exit = boxes_.children(nodes, number, axis, 1 - side, first, share_);
                near = hn::Max(near, hn::MulSub(entry, inverse_[axis], offset_[axis]));
                far = hn::Min(far, hn::MulSub(exit, inverse_[axis], offset_[axis]));
            }
            bits |= mask_bits(Boxes(), hn::Le(near, far)) << first;
            hn::Store(near, Boxes(), nears + first);
        }
        return bits & ((1u << nodes[number].count) - 1u);
    }
};

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
    HWY_INLINE void visit(const BoxNode* nodes, uint32_t lanes, float* farthest) {
        count_ = 0;
        WaitingPacket& root = waiting_[count_++];
        root.child = 0;
        root.lanes = lanes;
        for (float& near : root.near) near = 0.0f;
        while (count_ > 0) {
            const WaitingPacket& next = waiting_[--count_];
            const uint32_t child = next.child, left = next.lanes & reached(next.near, farthest);
            if (left == 0) continue;
            if ((child & BoxNode::kLeaf) != 0)
                visit_item(child & ~BoxNode::kLeaf, left, farthest);
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
    HWY_INLINE void visit_item(uint32_t item, uint32_t lanes, float* farthest) const {
        if (visitor_.oriented) {
            uint32_t met = 0;
            for (int first = 0; first < kPacketSize; first += kRayWidth)
                met |= lanes_that_meet(visitor_.oriented[item], rays_, farthest, first);
            lanes &= met;
            if (lanes == 0) return;
        }
        visitor_.visit(visitor_.owner, item, lanes, farthest);
    }
    HWY_INLINE void visit_one_by_one(const BoxNode* nodes, uint32_t child, uint32_t lanes, float* farthest) const {
        for (; lanes != 0; lanes &= lanes - 1) {
            const auto lane = static_cast<uint32_t>(__builtin_ctz(lanes));
            const float origin[3] = {rays_.near_origin[0][lane], rays_.near_origin[1][lane],
                                     rays_.near_origin[2][lane]};
            const float direction[3] = {rays_.unit_direction[0][lane], rays_.unit_direction[1][lane],
                                        rays_.unit_direction[2][lane]};
            OneRay<NodeBoxes>(origin, direction, boxes_, lane)
                .visit(nodes, child, origin, direction, lane, farthest, visitor_);
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

void traverse_packet(const BoxNode* nodes, const RayPacket& rays, uint32_t lanes, int few, float* farthest,
                     const BoxVisitor& visitor) {
    ManyRays<StillBoxes>(rays, few, {}, visitor).visit(nodes, lanes, farthest);
}

void traverse_moving_packet(const BoxNode* nodes, const MovingBoxes& boxes, const RayPacket& rays, uint32_t lanes,
                            int few, float* farthest, const BoxVisitor& visitor) {
    ManyRays<BoxesInMotion>(rays, few, {boxes}, visitor).visit(nodes, lanes, farthest);
}

void traverse_alone(const BoxNode* nodes, const Vec3f& origin, const Vec3f& direction, float* farthest,
                    const BoxVisitor& visitor) {
    const float from[3] = {origin.x, origin.y, origin.z}, along[3] = {direction.x, direction.y, direction.z};
    OneRay<StillBoxes>(from, along, {}, 0).visit(nodes, 0, from, along, 0, farthest, visitor);
}

void traverse_moving_alone(const BoxNode* nodes, const MovingBoxes& boxes, const Vec3f& origin, const Vec3f& direction,
                           float* farthest, const BoxVisitor& visitor) {
    const float from[3] = {origin.x, origin.y, origin.z}, along[3] = {direction.x, direction.y, direction.z};
    OneRay<BoxesInMotion>(from, along, {boxes}, 0).visit(nodes, 0, from, along, 0, farthest, visitor);
}

}  // namespace HWY_NAMESPACE
}  // namespace rayleaf
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rayleaf {

HWY_EXPORT(traverse_packet);
HWY_EXPORT(traverse_alone);
HWY_EXPORT(traverse_moving_packet);
HWY_EXPORT(traverse_moving_alone);

BoxTraversal box_traversal() {
    choose_kernels();
    return {&HWY_DYNAMIC_DISPATCH(traverse_packet), &HWY_DYNAMIC_DISPATCH(traverse_alone),
            &HWY_DYNAMIC_DISPATCH(traverse_moving_packet), &HWY_DYNAMIC_DISPATCH(traverse_moving_alone)};
}

}  // namespace rayleaf
#endif
