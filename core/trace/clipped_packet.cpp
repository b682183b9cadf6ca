#include "trace/clipped_packet.h"

#include "base/simd_choice.h"
#include "trace/local_ray.h"

#include <bit>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "trace/clipped_packet.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace rayleaf {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Lanes = hn::CappedTag<double, 8>;
using FloatLanes = hn::Rebind<float, Lanes>;
using Vector = hn::Vec<Lanes>;
using FloatVector = hn::Vec<FloatLanes>;
using Mask = hn::Mask<Lanes>;
constexpr int kWidth = static_cast<int>(hn::MaxLanes(Lanes()));

#include "base/lanes.inl"

/// As std::min(a, b) and std::max(a, b): of numbers that are not comparable the first.
HWY_INLINE Vector least(Vector a, Vector b) {
    return hn::IfThenElse(hn::Lt(b, a), b, a);
}
HWY_INLINE Vector most(Vector a, Vector b) {
    return hn::IfThenElse(hn::Lt(a, b), b, a);
}

/// Some lanes of a packet on their way into a box.
class Clipping {
  public:
    HWY_INLINE Clipping(const WorldPacket& world, const RayMap& map, int first) : first_(first) {
        const Lanes lanes;
        t_min_ = hn::Load(lanes, world.t_min + first);
        t_max_ = hn::Load(lanes, world.t_max + first);
        Vector from[3], along[3];
        for (int axis = 0; axis < 3; ++axis) {
            from[axis] = hn::Sub(hn::Load(lanes, world.origin[axis] + first), hn::Set(lanes, map.translation[axis]));
            along[axis] = hn::Load(lanes, world.direction[axis] + first);
        }
        for (int axis = 0; axis < 3; ++axis) {
            origin_[axis] = mapped(map, from, axis);
            direction_[axis] = mapped(map, along, axis);
        }
    }
    /// The lanes that meet the box, which `rays` then holds; bit 0 is the first lane.
    HWY_INLINE uint32_t run(const Box3d& box, uint32_t asked, RayPacket& rays) const {
        const Lanes lanes;
        Vector begin;
        uint32_t bits = mask_bits(lanes, inside(box, begin)) & asked;
        if (bits == 0) return 0;
        const Vector speed = speeds(bits);
        const Vector inverse = hn::Div(hn::Set(lanes, 1.0), speed);
        const Vector start = hn::Sub(most(begin, t_min_), hn::Mul(hn::Set(lanes, kBackstep), inverse));
        for (int axis = 0; axis < 3; ++axis) {
            hn::Store(origin_[axis], lanes, rays.origin[axis] + first_);
            hn::Store(direction_[axis], lanes, rays.direction[axis] + first_);
        }
        hn::Store(t_min_, lanes, rays.t_min + first_);
        hn::Store(t_max_, lanes, rays.t_max + first_);
        hn::Store(start, lanes, rays.start + first_);
        hn::Store(speed, lanes, rays.speed + first_);
        set_reach(start, speed, rays);
        return bits & set_float_rays(start, inverse, rays);
    }

  private:
    int first_;
    Vector origin_[3], direction_[3], t_min_, t_max_;

    static HWY_INLINE Vector mapped(const RayMap& map, const Vector (&v)[3], int axis) {
        const Lanes lanes;
        return hn::Add(hn::Add(hn::Mul(hn::Set(lanes, map.x[axis]), v[0]), hn::Mul(hn::Set(lanes, map.y[axis]), v[1])),
                       hn::Mul(hn::Set(lanes, map.z[axis]), v[2]));
    }
    /// As inside_box.
    HWY_INLINE Mask inside(const Box3d& box, Vector& begin) const {
        const Lanes lanes;
        constexpr double kInfinity = std::numeric_limits<double>::infinity();
        begin = hn::Set(lanes, -kInfinity);
        Vector end = hn::Set(lanes, kInfinity);
        Mask beside = hn::Lt(end, begin);  // nowhere
        for (int axis = 0; axis < 3; ++axis) {
            const Vector low = hn::Set(lanes, box.min[axis]), high = hn::Set(lanes, box.max[axis]);
            const Mask across = hn::Eq(direction_[axis], hn::Zero(lanes));
            const Mask outside = hn::Or(hn::Lt(origin_[axis], low), hn::Gt(origin_[axis], high));
            beside = hn::Or(beside, hn::And(across, outside));
            const Vector inverse = hn::Div(hn::Set(lanes, 1.0), direction_[axis]);
            const Vector a = hn::Mul(hn::Sub(low, origin_[axis]), inverse);
            const Vector b = hn::Mul(hn::Sub(high, origin_[axis]), inverse);
            begin = hn::IfThenElse(across, begin, most(begin, least(a, b)));
            end = hn::IfThenElse(across, end, least(end, most(a, b)));
        }
        const Mask within = hn::And(hn::Le(begin, end), hn::And(hn::Ge(end, t_min_), hn::Le(begin, t_max_)));
        return hn::AndNot(beside, within);
    }
    HWY_INLINE Vector speeds(uint32_t bits) const {
        const Lanes lanes;
        const Vector squared =
            hn::Add(hn::Add(hn::Mul(direction_[0], direction_[0]), hn::Mul(direction_[1], direction_[1])),
                    hn::Mul(direction_[2], direction_[2]));
        const Mask usual =
            hn::And(hn::Gt(squared, hn::Set(lanes, kSmallSquare)), hn::Lt(squared, hn::Set(lanes, kLargeSquare)));
        const Vector roots = hn::Sqrt(squared);
        bits &= ~mask_bits(lanes, usual);
        if (HWY_LIKELY(bits == 0)) return roots;
        HWY_ALIGN double speed[kWidth], direction[3][kWidth];
        hn::Store(roots, lanes, speed);
        for (int axis = 0; axis < 3; ++axis) hn::Store(direction_[axis], lanes, direction[axis]);
        for (; bits != 0; bits &= bits - 1) {
            const int lane = __builtin_ctz(bits);
            speed[lane] = length_of({direction[0][lane], direction[1][lane], direction[2][lane]});
        }
        return hn::Load(lanes, speed);
    }
    HWY_INLINE void set_reach(Vector start, Vector speed, RayPacket& rays) const {
        const Lanes lanes;
        const FloatLanes floats;
        const Vector from = hn::Mul(hn::Sub(t_min_, start), speed), to = hn::Mul(hn::Sub(t_max_, start), speed);
        const Vector farthest =
            hn::Add(hn::Mul(to, hn::Set(lanes, 1.0 + 0x1p-20)), hn::Set(lanes, kBackstep));  // LocalRay::float_distance
        // What float tests may be off, and the rounding of t.
        const Vector margin =
            hn::Add(hn::Set(lanes, 2.0 * kBackstep), hn::Mul(hn::Mul(hn::Abs(start), speed), hn::Set(lanes, 0x1p-49)));
        const Vector sure_to = hn::Sub(hn::Mul(to, hn::Set(lanes, 1.0 - 0x1p-20)), margin);
        hn::Store(hn::DemoteTo(floats, farthest), floats, rays.farthest + first_);
        hn::Store(hn::DemoteTo(floats, hn::Add(from, margin)), floats, rays.sure_from + first_);
        hn::Store(hn::DemoteTo(floats, sure_to), floats, rays.sure_to + first_);
    }
    /// Returns the lanes whose float rays Embree can take. `inverse`: of the speed.
    HWY_INLINE uint32_t set_float_rays(Vector start, Vector inverse, RayPacket& rays) const {
        const FloatLanes floats;
        FloatVector size = hn::Zero(floats);
        auto is_near = hn::Eq(size, size);
        const FloatVector far_off = hn::Set(floats, kFarOff);
        for (int axis = 0; axis < 3; ++axis) {
            const FloatVector origin = hn::DemoteTo(floats, hn::Add(origin_[axis], hn::Mul(direction_[axis], start)));
            const FloatVector direction = hn::DemoteTo(floats, hn::Mul(direction_[axis], inverse));
            hn::Store(origin, floats, rays.near_origin[axis] + first_);
            hn::Store(direction, floats, rays.unit_direction[axis] + first_);
            is_near = hn::And(is_near, hn::And(hn::Le(hn::Abs(origin), far_off), hn::Le(hn::Abs(direction), far_off)));
            size = hn::Max(size, hn::Abs(direction));
        }
        return mask_bits(floats, hn::And(is_near, hn::Gt(size, hn::Zero(floats))));
    }
};

uint32_t clip_packet(const WorldPacket& world, uint32_t asked, const RayMap& map, const Box3d& box, RayPacket& rays) {
    uint32_t met = 0;
    for (int first = 0; first < kPacketSize; first += kWidth) {
        const uint32_t bits = asked >> first & ((1u << kWidth) - 1u);
        if (bits != 0) met |= Clipping(world, map, first).run(box, bits, rays) << first;
    }
    return met;
}

}  // namespace HWY_NAMESPACE
}  // namespace rayleaf
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rayleaf {

HWY_EXPORT(clip_packet);

ClipPacket clip_kernel() {
    choose_kernels();
    return &HWY_DYNAMIC_DISPATCH(clip_packet);
}

}  // namespace rayleaf
#endif
