#include "trace/wall_lanes.h"

#include "base/simd.h"
#include "splines/sweep_frames.h"

#include <bit>
#include <cfloat>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "trace/wall_lanes.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace rayleaf {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#include "base/lanes.inl"
#include "trace/surface_vectors.inl"

HWY_INLINE Double row(const double* numbers, size_t first) {
    return hn::Load(Doubles(), numbers + first);
}

/// A number of the segments' control points, and its derivatives by the parameter.
struct Cubic {
    Double value, first, second;
};

/// SegmentPoint's.
struct AxisPoint {
    Vec3 position, first, tangent, tangent_change;
    Double radius, radius_change, tilt, tilt_change;
};

HWY_INLINE AxisPoint axis_point(const WallLanes& walls, size_t first, Mask& sound) {
    const OfEach<SweepControl> controls(walls.controls + first);
    const Basis<FixedDegree<3>> basis(FixedDegree<3>(3), row(walls.t, first));
    const auto cubic = [&](auto number_of) HWY_ATTR {
        Double numbers[4];
        for (int i = 0; i < 4; ++i) numbers[i] = controls.number(number_of((&controls.first())[i]));
        return Cubic{basis.value(numbers), basis.first(numbers), basis.second(numbers)};
    };
    const Cubic x = cubic([](const SweepControl& c) -> const double& { return c.point.x; });
    const Cubic y = cubic([](const SweepControl& c) -> const double& { return c.point.y; });
    const Cubic z = cubic([](const SweepControl& c) -> const double& { return c.point.z; });
    const Cubic radius = cubic([](const SweepControl& c) -> const double& { return c.radius; });
    const Cubic tilt = cubic([](const SweepControl& c) -> const double& { return c.tilt; });
    AxisPoint at{{x.value, y.value, z.value},
                 {x.first, y.first, z.first},
                 {},
                 {},
                 radius.value,
                 radius.first,
                 tilt.value,
                 tilt.first};
    const Vec3 second{x.second, y.second, z.second};
    const Double length = hn::Sqrt(dot(at.first, at.first));
    sound = hn::And(sound, hn::Gt(length, hn::Mul(all(kStandstill), row(walls.size, first))));
    at.tangent = divided(at.first, length);
    at.tangent_change = divided(second - times(at.tangent, dot(at.tangent, second)), length);
    return at;
}

/// The frame across the axis and its change, the turn apart.
struct Frame {
    Vec3 normal, side, normal_change, side_change;
};

HWY_INLINE Frame frame_at(const WallLanes& walls, size_t first, const AxisPoint& at, Mask& sound) {
    const Vec3 from = load(Doubles(), walls.tangent, first), across = load(Doubles(), walls.normal, first);
    const Vec3 &to = at.tangent, &to_change = at.tangent_change;
    const Double sum = hn::Add(all(1.0), dot(from, to));
    sound = hn::And(sound, hn::Gt(sum, all(kOpposite)));
    const Double share = hn::Div(dot(to, across), sum);
    const Double share_change = hn::Div(hn::Sub(dot(to_change, across), hn::Mul(share, dot(from, to_change))), sum);
    const Vec3 carried = across - times(from + to, share);
    const Vec3 part = carried - times(to, dot(to, carried));
    sound = hn::And(sound, hn::Gt(max_abs(part), all(kNoPart)));
    Frame frame;
    frame.normal = normalized(part, sound);
    frame.side = cross(to, frame.normal);
    frame.normal_change = times(to_change, hn::Neg(share)) - times(from + to, share_change);
    frame.side_change = cross(to_change, frame.normal) + cross(to, frame.normal_change);
    return frame;
}

/// SweepRingPoint's.
struct Ring {
    Vec3 center, across, up, center_change, across_change, up_change;
};

HWY_INLINE Ring ring_at(const WallLanes& walls, size_t first, Mask& sound) {
    const AxisPoint at = axis_point(walls, first, sound);
    const Frame frame = frame_at(walls, first, at, sound);
    alignas(64) double angles[kWidth], cosines[kWidth], sines[kWidth];
    hn::Store(hn::Add(row(walls.turn, first), at.tilt), Doubles(), angles);
    for (size_t i = 0; i < kWidth; ++i) {
        const CosineAndSine turn = cosine_and_sine(angles[i]);
        cosines[i] = turn.cosine;
        sines[i] = turn.sine;
    }
    const Double c = hn::Load(Doubles(), cosines), s = hn::Load(Doubles(), sines);
    const Double angle_change = hn::Add(row(walls.turn_change, first), at.tilt_change);
    const Double factor = row(walls.factor, first), scale = row(walls.scale, first), length = row(walls.length, first);
    const Double r = hn::Div(hn::Add(hn::Mul(factor, at.radius), row(walls.added, first)), scale);
    const Double by_points = hn::Mul(factor, at.radius_change);
    const Double r_change = hn::Add(hn::Add(hn::Mul(row(walls.factor_change, first), at.radius), by_points),
                                    row(walls.added_change, first));
    const Double dr = hn::Div(r_change, scale);
    const Vec3 across = times(frame.normal, c) + times(frame.side, s);
    const Vec3 up = times(frame.side, c) - times(frame.normal, s);
    const Vec3 across_change = times(frame.normal_change, c) + times(frame.side_change, s) + times(up, angle_change);
    const Vec3 up_change = times(frame.side_change, c) - times(frame.normal_change, s) - times(across, angle_change);
    return {at.position,
            times(across, r),
            times(up, r),
            times(at.first, length),
            times(times(across, dr) + times(across_change, r), length),
            times(times(up, dr) + times(up_change, r), length)};
}

/// The lanes from `first` on.
HWY_INLINE uint32_t compute(const WallLanes& walls, SurfaceLanes& lanes, size_t first) {
    Mask sound = hn::FirstN(Doubles(), kWidth);
    const Ring ring = ring_at(walls, first, sound);
    const Double x = row(walls.place[0], first), y = row(walls.place[1], first);
    const Vec3 along = ring.center_change + times(ring.across_change, x) + times(ring.up_change, y);
    const Vec3 round =
        times(ring.across, row(walls.direction[0], first)) + times(ring.up, row(walls.direction[1], first));
    const Vec3 crossing = cross(round, along);
    const Double least = hn::Mul(hn::Mul(all(kDegenerateWall), dot(along, along)), dot(round, round));
    sound = hn::And(sound, hn::Gt(dot(crossing, crossing), least));
    const Vec3 n = divided(crossing, length_of(crossing, sound));
    const FloatVec3 facet = normalized(load(Floats(), lanes.facet_normal, first), sound);
    const Double turn = hn::PromoteTo(Doubles(), dot(to_floats(n), facet));
    const Double side = hn::IfThenElse(hn::Lt(turn, all(0.0)), all(-1.0), all(1.0));
    const Double length_u = row(walls.length_u, first);
    const FloatVec3 dp_du = to_floats(divided(along, length_u));
    const FloatVec3 dp_dv = to_floats(divided(round, row(walls.length_v, first)));
    sound = hn::And(sound, hn::And(hn::Gt(length_u, all(0.0)),
                                   hn::And(is_finite(to_doubles(dp_du)), is_finite(to_doubles(dp_dv)))));
    store(Doubles(), ring.center + times(ring.across, x) + times(ring.up, y), lanes.position, first);
    store(Floats(), to_floats(times(n, side)), lanes.normal, first);
    store(Floats(), dp_du, lanes.dp_du, first);
    store(Floats(), dp_dv, lanes.dp_dv, first);
    return mask_bits(Doubles(), sound);
}

void walls_of_lanes(const WallLanes& walls, SurfaceLanes& lanes) {
    uint32_t done = 0;
    for (size_t first = 0; first < lanes.count; first += kWidth) done |= compute(walls, lanes, first) << first;
    lanes.done &= done;
}

}  // namespace HWY_NAMESPACE
}  // namespace rayleaf
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rayleaf {

HWY_EXPORT(walls_of_lanes);

bool has_wall_lanes(const SweepPath& path, const SweepPiece& piece) {
    if (path.space != SweepSpace::Spatial || piece.kind != SweepPieceKind::Curved) return false;
    const SweepSegment& segment = path.segments[piece.source];
    return segment.degree == 3 && !segment.rational;
}

void compute_walls(const WallLanes& walls, SurfaceLanes& lanes) {
    HWY_DYNAMIC_DISPATCH(walls_of_lanes)(walls, lanes);
}

}  // namespace rayleaf
#endif
