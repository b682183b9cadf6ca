#include "trace/capsules.h"

#include "base/simd_choice.h"

#include <bit>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "trace/capsules.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace rayleaf {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#include "base/lanes.inl"

using Pieces = hn::CappedTag<float, Capsules::kMost>;
using PieceVector = hn::Vec<Pieces>;
constexpr uint32_t kWidth = static_cast<uint32_t>(hn::MaxLanes(Pieces()));

HWY_INLINE PieceVector all(float x) {
    return hn::Set(Pieces(), x);
}

/// Three coordinates of each capsule.
struct Vectors {
    PieceVector x, y, z;

    HWY_INLINE PieceVector dot(const Vec3f& v) const {
        return hn::MulAdd(x, all(v.x), hn::MulAdd(y, all(v.y), hn::Mul(z, all(v.z))));
    }
};

HWY_INLINE Vectors load(const float (&rows)[3][Capsules::kMost], uint32_t first) {
    const Pieces tag;
    return {hn::Load(tag, rows[0] + first), hn::Load(tag, rows[1] + first), hn::Load(tag, rows[2] + first)};
}

uint32_t meet_capsules(const Capsules& capsules, const CapsuleRay& ray, const CapsuleRange& range,
                       float (&nears)[Capsules::kMost]) {
    constexpr float kLeastLength2 = 1e-30f;  // of what is no longer than a point
    uint32_t bits = 0;
    for (uint32_t first = 0; first < Capsules::kMost; first += kWidth) {
        const Pieces tag;
        Vectors begin = load(capsules.begin, first);
        begin = {hn::Sub(begin.x, all(ray.origin.x)), hn::Sub(begin.y, all(ray.origin.y)),
                 hn::Sub(begin.z, all(ray.origin.z))};
        const Vectors way = load(capsules.way, first);
        const PieceVector radius = hn::Load(tag, capsules.radius + first);
        // Across the ray: the place of the line that is nearest to it.
        const PieceVector x = begin.dot(ray.across_x), y = begin.dot(ray.across_y);
        const PieceVector dx = way.dot(ray.across_x), dy = way.dot(ray.across_y);
        const PieceVector length2 = hn::Max(hn::MulAdd(dx, dx, hn::Mul(dy, dy)), all(kLeastLength2));
        const PieceVector towards = hn::Neg(hn::MulAdd(x, dx, hn::Mul(y, dy)));
        const PieceVector s = hn::Min(hn::Max(hn::Div(towards, length2), hn::Zero(tag)), all(1.0f));
        const PieceVector nearest_x = hn::MulAdd(dx, s, x), nearest_y = hn::MulAdd(dy, s, y);
        const PieceVector distance2 = hn::MulAdd(nearest_x, nearest_x, hn::Mul(nearest_y, nearest_y));
        // Along it.
        const PieceVector z = begin.dot(ray.along), end_z = hn::Add(z, way.dot(ray.along));
        const PieceVector near = hn::Sub(hn::Min(z, end_z), radius), far = hn::Add(hn::Max(z, end_z), radius);
        const auto in_range = hn::And(hn::Le(near, all(range.end)), hn::Ge(far, all(range.begin)));
        const auto met = hn::And(in_range, hn::Le(distance2, hn::Mul(radius, radius)));
        hn::StoreU(near, tag, nears + first);
        bits |= mask_bits(tag, met) << first;
    }
    return bits & ((1u << capsules.count) - 1u);
}

}  // namespace HWY_NAMESPACE
}  // namespace rayleaf
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rayleaf {

HWY_EXPORT(meet_capsules);

MeetCapsules capsule_kernel() {
    choose_kernels();
    return &HWY_DYNAMIC_DISPATCH(meet_capsules);
}

}  // namespace rayleaf
#endif
