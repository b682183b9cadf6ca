#include "trace/oriented_boxes.h"

#include "base/simd_choice.h"

#include <algorithm>
#include <bit>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "trace/oriented_boxes.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace rayleaf {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#include "base/lanes.inl"

/// Rays against slabs, a pair in each lane.
template <class D>
struct Crossing {
    using V = hn::Vec<D>;
    V near, far;

    HWY_INLINE explicit Crossing(V farthest) : near(hn::Zero(D())), far(farthest) {}
    /// Goes on into a slab. `place` and the speed: the ray's along its normal.
    HWY_INLINE void enter(V low, V high, V place, V inverse_of_speed) {
        const V a = hn::Mul(hn::Sub(low, place), inverse_of_speed), b = hn::Mul(hn::Sub(high, place), inverse_of_speed);
        near = hn::Max(near, hn::Min(a, b));
        far = hn::Min(far, hn::Max(a, b));
    }
    HWY_INLINE uint32_t bits() const { return mask_bits(D(), hn::Le(near, far)); }
};

/// One over a speed, to a few roundings, and never infinite.
template <class D>
HWY_INLINE hn::Vec<D> inverse(D lanes, hn::Vec<D> speed) {
    constexpr float kHuge = 1e18f;  // far beyond any box, yet times a box's size still finite
    const auto rough = hn::ApproximateReciprocal(speed);
    const auto usual = hn::Mul(rough, hn::NegMulAdd(speed, rough, hn::Set(lanes, 2.0f)));  // Newton's step
    const auto is_usual = hn::Gt(hn::Abs(speed), hn::Set(lanes, 1.0f / kHuge));
    return hn::IfThenElse(is_usual, usual, hn::CopySign(hn::Set(lanes, kHuge), speed));
}

using Boxes = hn::CappedTag<float, OrientedBoxes::kMost>;
using BoxVector = hn::Vec<Boxes>;

HWY_INLINE BoxVector in_all(float x) {
    return hn::Set(Boxes(), x);
}

/// How long a vector is along an axis of each box.
HWY_INLINE BoxVector along(const float (&rows)[3][OrientedBoxes::kMost], uint32_t first, const Vec3f& v) {
    const LaneVec3<BoxVector> axis = load(Boxes(), rows, first);
    return hn::MulAdd(axis.z, in_all(v.z), hn::MulAdd(axis.y, in_all(v.y), hn::Mul(axis.x, in_all(v.x))));
}

uint32_t meet_boxes(const OrientedBoxes& boxes, const Vec3f& origin, const Vec3f& direction, float farthest,
                    float (&nears)[OrientedBoxes::kMost]) {
    constexpr auto kWidth = static_cast<uint32_t>(hn::MaxLanes(Boxes()));
    const uint32_t all = (1u << boxes.count) - 1u;
    uint32_t bits = 0;
    for (uint32_t first = 0; first < OrientedBoxes::kMost; first += kWidth) {
        Crossing<Boxes> crossing(in_all(farthest));
        for (int slab = 0; slab < 3; ++slab) {
            const bool straight = boxes.straight == all;
            const auto& axis = boxes.axis[slab];
            const BoxVector place = straight ? in_all(origin[slab]) : along(axis, first, origin);
            const BoxVector speed = straight ? in_all(direction[slab]) : along(axis, first, direction);
            crossing.enter(hn::Load(Boxes(), boxes.low[slab] + first), hn::Load(Boxes(), boxes.high[slab] + first),
                           place, inverse(Boxes(), speed));
        }
        hn::StoreU(crossing.near, Boxes(), nears + first);
        bits |= crossing.bits() << first;
    }
    return bits & all;
}

using Rays = hn::CappedTag<float, kPacketSize>;
using RayVector = hn::Vec<Rays>;

void meet_boxes_together(const OrientedBoxes& boxes, const RayPacket& rays, const float* farthest, MetBoxes& met) {
    constexpr int kWidth = static_cast<int>(hn::MaxLanes(Rays()));
    const auto in_rays = [](float x) HWY_ATTR { return hn::Set(Rays(), x); };
    std::fill_n(met.lanes, boxes.count, 0u);
    for (int first = 0; first < kPacketSize; first += kWidth) {
        const LaneVec3<RayVector> origin = load(Rays(), rays.near_origin, static_cast<size_t>(first));
        const LaneVec3<RayVector> direction = load(Rays(), rays.unit_direction, static_cast<size_t>(first));
        const RayVector places[3] = {origin.x, origin.y, origin.z};
        const RayVector inverses[3] = {inverse(Rays(), direction.x), inverse(Rays(), direction.y),
                                       inverse(Rays(), direction.z)};
        for (uint32_t box = 0; box < boxes.count; ++box) {
            Crossing<Rays> crossing(hn::LoadU(Rays(), farthest + first));
            for (int slab = 0; slab < 3; ++slab) {
                const RayVector low = in_rays(boxes.low[slab][box]), high = in_rays(boxes.high[slab][box]);
                if ((boxes.straight >> box & 1u) != 0) {
                    crossing.enter(low, high, places[slab], inverses[slab]);
                    continue;
                }
                const auto& axis = boxes.axis[slab];
                const RayVector x = in_rays(axis[0][box]), y = in_rays(axis[1][box]), z = in_rays(axis[2][box]);
                const auto along_axis = [&](const LaneVec3<RayVector>& v) HWY_ATTR {
                    return hn::MulAdd(z, v.z, hn::MulAdd(y, v.y, hn::Mul(x, v.x)));
                };
                crossing.enter(low, high, along_axis(origin), inverse(Rays(), along_axis(direction)));
            }
            hn::Store(crossing.near, Rays(), met.nears[box] + first);
            hn::Store(crossing.far, Rays(), met.fars[box] + first);
            met.lanes[box] |= crossing.bits() << first;
        }
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace rayleaf
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rayleaf {

HWY_EXPORT(meet_boxes);
HWY_EXPORT(meet_boxes_together);

OrientedBoxKernels oriented_box_kernels() {
    choose_kernels();
    OrientedBoxKernels kernels;
    kernels.alone = &HWY_DYNAMIC_DISPATCH(meet_boxes);
    kernels.together = &HWY_DYNAMIC_DISPATCH(meet_boxes_together);
    return kernels;
}

}  // namespace rayleaf
#endif
