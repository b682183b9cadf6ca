#include "base/simd.h"
#include "splines/limit_normal.h"
#include "trace/surface_lanes.h"

#include <bit>
#include <cfloat>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "trace/patch_lanes.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace rayleaf {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#include "base/lanes.inl"
#include "trace/surface_vectors.inl"

/// The control points of each lane's patch.
struct Nets {
    OfEach<Vec4d> corners;
    int64_t stride;   ///< of the first lane's rows, points
    Offsets further;  ///< by how much more a lane's row is away from the one before, bytes

    HWY_INLINE Nets(const Vec4d* const* points, const int64_t* strides) : corners(points), stride(strides[0]) {
        const hn::RebindToSigned<Doubles> integers;
        const auto points_more = hn::Sub(hn::LoadU(integers, strides), hn::Set(integers, stride));
        further = hn::ShiftLeft<5>(points_more);
        static_assert(sizeof(Vec4d) == 1 << 5);
    }
};

/// Of one coordinate of the patches.
struct Derivatives {
    Double value, du, dv, duu, duv, dvv;
};

template <typename Degree, SurfaceDetail kDetail>
HWY_INLINE Derivatives evaluate(const Nets& nets, int coordinate, const Basis<Degree>& u, const Basis<Degree>& v) {
    Double value[Degree::kMost + 1], first[Degree::kMost + 1], second[Degree::kMost + 1];
    const Vec4d* points = &nets.corners.first();
    auto further = hn::Zero(hn::RebindToSigned<Doubles>());
    for (int j = 0; j <= v.degree; ++j, points += nets.stride, further = hn::Add(further, nets.further)) {
        Double row[Degree::kMost + 1];
        for (int i = 0; i <= u.degree; ++i) row[i] = nets.corners.number((&points[i].x)[coordinate], further);
        value[j] = u.value(row);
        first[j] = u.first(row);
        if (kDetail == SurfaceDetail::Curvature) second[j] = u.second(row);
    }
    Derivatives result{v.value(value), v.value(first), v.first(value), all(0.0), all(0.0), all(0.0)};
    if (kDetail == SurfaceDetail::Curvature) {
        result.duu = v.value(second);
        result.duv = v.first(first);
        result.dvv = v.second(value);
    }
    return result;
}

struct Point {
    Vec3 position, du, dv, duu, duv, dvv;
};

/// The quotient rule, as of project() for one point.
template <SurfaceDetail kDetail>
HWY_INLINE void divide_by_weight(Point& p, const Derivatives& w) {
    const auto two = all(2.0);
    p.position = divided(p.position, w.value);
    p.du = divided(p.du - times(p.position, w.du), w.value);
    p.dv = divided(p.dv - times(p.position, w.dv), w.value);
    if (kDetail == SurfaceDetail::Normal) return;
    p.duu = divided(p.duu - times(p.du, hn::Mul(two, w.du)) - times(p.position, w.duu), w.value);
    p.duv = divided(p.duv - times(p.du, w.dv) - times(p.dv, w.du) - times(p.position, w.duv), w.value);
    p.dvv = divided(p.dvv - times(p.dv, hn::Mul(two, w.dv)) - times(p.position, w.dvv), w.value);
}

template <typename Degree, bool kRational, SurfaceDetail kDetail>
HWY_INLINE Point evaluate(const Nets& points, const PatchForm& form, Double at_u, Double at_v) {
    const Basis<Degree> u(Degree(form.degree_u), at_u), v(Degree(form.degree_v), at_v);
    const Derivatives x = evaluate<Degree, kDetail>(points, 0, u, v), y = evaluate<Degree, kDetail>(points, 1, u, v),
                      z = evaluate<Degree, kDetail>(points, 2, u, v);
    Point p{{x.value, y.value, z.value}, {x.du, y.du, z.du},    {x.dv, y.dv, z.dv},
            {x.duu, y.duu, z.duu},       {x.duv, y.duv, z.duv}, {x.dvv, y.dvv, z.dvv}};
    if constexpr (kRational) divide_by_weight<kDetail>(p, evaluate<Degree, kDetail>(points, 3, u, v));
    return p;
}

/// The unit normal of the patches and its derivatives by u and v, as regular_normal() finds them.
struct Normal {
    Vec3 unit, by_u, by_v;
};

template <SurfaceDetail kDetail>
HWY_INLINE Normal normal_of(const Point& p, Mask& sound) {
    const Double uu = dot(p.du, p.du), vv = dot(p.dv, p.dv);
    const Vec3 n = cross(p.du, p.dv);
    const Double shorter = hn::Sqrt(hn::Min(uu, vv)), longer = hn::Sqrt(hn::Max(uu, vv));
    sound = hn::And(sound, hn::Gt(dot(n, n), hn::Mul(hn::Mul(all(kDegenerateShare), uu), vv)));
    sound = hn::And(sound, hn::Gt(shorter, hn::Mul(all(kSuspiciousRatio), longer)));
    sound = hn::And(sound, hn::Gt(shorter, hn::Mul(all(kSuspiciousLength), max_abs(p.position))));
    const Double length = length_of(n, sound);
    Normal normal{normalized(n, sound), {}, {}};
    if constexpr (kDetail == SurfaceDetail::Curvature) {
        const auto change = [&](const Vec3& derivative) HWY_ATTR {
            return divided(derivative - times(normal.unit, dot(normal.unit, derivative)), length);
        };
        normal.by_u = change(cross(p.duu, p.dv) + cross(p.du, p.duv));
        normal.by_v = change(cross(p.duv, p.dv) + cross(p.du, p.dvv));
        sound = hn::And(sound, hn::And(is_finite(normal.by_u), is_finite(normal.by_v)));
    }
    return normal;
}

/// The lanes from `first` on.
template <typename Degree, bool kRational, SurfaceDetail kDetail>
HWY_INLINE uint32_t compute(SurfaceLanes& lanes, const PatchForm& form, size_t first) {
    const auto row = [&](const double* numbers) HWY_ATTR { return hn::Load(Doubles(), numbers + first); };
    const Nets points(lanes.points + first, lanes.strides + first);
    Mask sound = hn::FirstN(Doubles(), kWidth);
    const Point p = evaluate<Degree, kRational, kDetail>(points, form, row(lanes.u), row(lanes.v));
    const Normal exact = normal_of<kDetail>(p, sound);
    const FloatVec3 facet = normalized(load(Floats(), lanes.facet_normal, first), sound);
    const Double turn = hn::PromoteTo(Doubles(), dot(to_floats(exact.unit), facet));
    const Double side = hn::IfThenElse(hn::Gt(turn, all(0.0)), all(1.0), all(-1.0));
    const Double length_u = row(lanes.length_u), length_v = row(lanes.length_v);
    store(Doubles(), p.position, lanes.position, first);
    store(Floats(), to_floats(times(exact.unit, side)), lanes.normal, first);
    store(Floats(), to_floats(divided(p.du, length_u)), lanes.dp_du, first);
    store(Floats(), to_floats(divided(p.dv, length_v)), lanes.dp_dv, first);
    if constexpr (kDetail == SurfaceDetail::Curvature) {
        store(Floats(), to_floats(times(exact.by_u, hn::Div(side, length_u))), lanes.dn_du, first);
        store(Floats(), to_floats(times(exact.by_v, hn::Div(side, length_v))), lanes.dn_dv, first);
    }
    return mask_bits(Doubles(), sound);
}

template <typename Degree, bool kRational, SurfaceDetail kDetail>
void compute_all(const PatchForm& form, SurfaceLanes& lanes) {
    uint32_t done = 0;
    for (size_t first = 0; first < lanes.count; first += kWidth)
        done |= compute<Degree, kRational, kDetail>(lanes, form, first) << first;
    lanes.done &= done;
}

template <typename Degree>
void compute_degree(const PatchForm& form, SurfaceDetail detail, SurfaceLanes& lanes) {
    const bool curved = detail == SurfaceDetail::Curvature;
    if (form.rational)
        curved ? compute_all<Degree, true, SurfaceDetail::Curvature>(form, lanes)
               : compute_all<Degree, true, SurfaceDetail::Normal>(form, lanes);
    else
        curved ? compute_all<Degree, false, SurfaceDetail::Curvature>(form, lanes)
               : compute_all<Degree, false, SurfaceDetail::Normal>(form, lanes);
}

void patches_of_lanes(const PatchForm& form, SurfaceDetail detail, SurfaceLanes& lanes) {
    const auto both = [&](int degree) { return form.degree_u == degree && form.degree_v == degree; };
    if (both(3)) return compute_degree<FixedDegree<3>>(form, detail, lanes);
    if (both(2)) return compute_degree<FixedDegree<2>>(form, detail, lanes);
    compute_degree<AnyDegree>(form, detail, lanes);
}

}  // namespace HWY_NAMESPACE
}  // namespace rayleaf
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rayleaf {

HWY_EXPORT(patches_of_lanes);

bool has_lanes(const PatchForm& form) {
    const auto few = [](int degree) { return degree >= 1 && degree <= SurfaceLanes::kMostDegree; };
    return few(form.degree_u) && few(form.degree_v);
}

void compute_patches(const PatchForm& form, SurfaceDetail detail, SurfaceLanes& lanes) {
    HWY_DYNAMIC_DISPATCH(patches_of_lanes)(form, detail, lanes);
}

}  // namespace rayleaf
#endif
