#include "trace/surface_lanes.h"

#include "base/simd.h"
#include "splines/limit_normal.h"

#include <cfloat>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "trace/surface_lanes.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace rayleaf {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Doubles = hn::CappedTag<double, SurfaceLanes::kMost>;
using Floats = hn::Rebind<float, Doubles>;
using Double = hn::Vec<Doubles>;
using Float = hn::Vec<Floats>;
using Mask = hn::Mask<Doubles>;
constexpr size_t kWidth = hn::MaxLanes(Doubles());
static_assert(SurfaceLanes::kMost % kWidth == 0);

HWY_INLINE Double all(double x) {
    return hn::Set(Doubles(), x);
}

// Vectors of three, with the operations of Imath's in the same order.

struct Vec3 {
    Double x, y, z;
};
HWY_INLINE Vec3 operator+(const Vec3& a, const Vec3& b) {
    return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)};
}
HWY_INLINE Vec3 operator-(const Vec3& a, const Vec3& b) {
    return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
HWY_INLINE Vec3 times(const Vec3& a, Double factor) {
    return {hn::Mul(a.x, factor), hn::Mul(a.y, factor), hn::Mul(a.z, factor)};
}
HWY_INLINE Vec3 divided(const Vec3& a, Double by) {
    return {hn::Div(a.x, by), hn::Div(a.y, by), hn::Div(a.z, by)};
}
HWY_INLINE Double dot(const Vec3& a, const Vec3& b) {
    return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}
HWY_INLINE Vec3 cross(const Vec3& a, const Vec3& b) {
    return {hn::Sub(hn::Mul(a.y, b.z), hn::Mul(a.z, b.y)), hn::Sub(hn::Mul(a.z, b.x), hn::Mul(a.x, b.z)),
            hn::Sub(hn::Mul(a.x, b.y), hn::Mul(a.y, b.x))};
}
HWY_INLINE Double max_abs(const Vec3& a) {
    return hn::Max(hn::Abs(a.x), hn::Max(hn::Abs(a.y), hn::Abs(a.z)));
}
HWY_INLINE Mask is_finite(Double x) {
    return hn::Le(hn::Abs(x), all(DBL_MAX));
}
HWY_INLINE Mask is_finite(const Vec3& a) {
    return hn::And(is_finite(a.x), hn::And(is_finite(a.y), is_finite(a.z)));
}

struct FloatVec3 {
    Float x, y, z;
};
HWY_INLINE FloatVec3 to_floats(const Vec3& a) {
    const Floats tag;
    return {hn::DemoteTo(tag, a.x), hn::DemoteTo(tag, a.y), hn::DemoteTo(tag, a.z)};
}
HWY_INLINE Vec3 to_doubles(const FloatVec3& a) {
    const Doubles tag;
    return {hn::PromoteTo(tag, a.x), hn::PromoteTo(tag, a.y), hn::PromoteTo(tag, a.z)};
}
HWY_INLINE Float dot(const FloatVec3& a, const FloatVec3& b) {
    return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}

/// Numbers that lie at the same place of something that each lane has one of.
template <typename T>
class OfEach {
  public:
    HWY_INLINE explicit OfEach(const T* const* objects) : first_(objects[0]) {
        alignas(64) int64_t offsets[kWidth];
        for (size_t i = 0; i < kWidth; ++i) {
            offsets[i] =
                static_cast<int64_t>(reinterpret_cast<intptr_t>(objects[i]) - reinterpret_cast<intptr_t>(first_));
            is_one_ &= offsets[i] == 0;
        }
        offsets_ = hn::Load(hn::RebindToSigned<Doubles>(), offsets);
    }
    const T& first() const { return *first_; }
    /// `number` is the first lane's.
    HWY_INLINE Double number(const double& number) const {
        return is_one_ ? all(number) : hn::GatherOffset(Doubles(), &number, offsets_);
    }
    HWY_INLINE Vec3 vector(const Vec3d& v) const { return {number(v.x), number(v.y), number(v.z)}; }

  private:
    const T* first_;
    bool is_one_ = true;
    hn::Vec<hn::RebindToSigned<Doubles>> offsets_;
};

/// A degree that is known when this is compiled.
template <int kDegree>
struct FixedDegree {
    static constexpr int kMost = kDegree;
    HWY_INLINE explicit FixedDegree(int /*degree*/) {}
    HWY_INLINE constexpr operator int() const { return kDegree; }  // NOLINT(google-explicit-constructor): it is one
};
/// Any other.
struct AnyDegree {
    static constexpr int kMost = SurfaceLanes::kMostDegree;
    int degree;
    HWY_INLINE explicit AnyDegree(int of) : degree(of) {}
    HWY_INLINE operator int() const { return degree; }  // NOLINT(google-explicit-constructor): it is one
};

/// BernsteinBasis's.
template <typename Degree>
struct Basis {
    Degree degree;
    Double value_of[Degree::kMost + 1], first_of[Degree::kMost], second_of[Degree::kMost];

    HWY_INLINE Basis(Degree of, Double t) : degree(of) {
        value_of[0] = all(1.0);
        const Double s = hn::Sub(all(1.0), t);
        for (int k = 0; k < degree; ++k) {
            if (k == degree - 2)
                for (int i = 0; i <= k; ++i) second_of[i] = value_of[i];
            if (k == degree - 1)
                for (int i = 0; i <= k; ++i) first_of[i] = value_of[i];
            value_of[k + 1] = hn::Mul(value_of[k], t);
            for (int i = k; i > 0; --i) value_of[i] = hn::Add(hn::Mul(value_of[i], s), hn::Mul(value_of[i - 1], t));
            value_of[0] = hn::Mul(value_of[0], s);
        }
    }
    HWY_INLINE Double value(const Double* points) const {
        Double sum = hn::Mul(points[0], value_of[0]);
        for (int i = 1; i <= degree; ++i) sum = hn::Add(sum, hn::Mul(points[i], value_of[i]));
        return sum;
    }
    HWY_INLINE Double first(const Double* points) const {
        Double sum = hn::Mul(points[0], all(0.0));
        for (int i = 0; i < degree; ++i) sum = hn::Add(sum, hn::Mul(hn::Sub(points[i + 1], points[i]), first_of[i]));
        return hn::Mul(sum, all(degree));
    }
    HWY_INLINE Double second(const Double* points) const {
        Double sum = hn::Mul(points[0], all(0.0));
        for (int i = 0; i + 1 < degree; ++i)
            sum =
                hn::Add(sum, hn::Mul(hn::Sub(hn::Sub(points[i + 2], points[i + 1]), hn::Sub(points[i + 1], points[i])),
                                     second_of[i]));
        return hn::Mul(sum, all(degree * (degree - 1)));
    }
};

/// Of one coordinate of the patches.
struct Derivatives {
    Double value, du, dv, duu, duv, dvv;
};

template <typename Degree, SurfaceDetail kDetail>
HWY_INLINE Derivatives evaluate(const OfEach<Vec4d>& points, int coordinate, const Basis<Degree>& u,
                                const Basis<Degree>& v) {
    Double value[Degree::kMost + 1], first[Degree::kMost + 1], second[Degree::kMost + 1];
    for (int j = 0; j <= v.degree; ++j) {
        Double row[Degree::kMost + 1];
        for (int i = 0; i <= u.degree; ++i)
            row[i] = points.number((&(&points.first())[j * (u.degree + 1) + i].x)[coordinate]);
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
HWY_INLINE Point evaluate(const OfEach<Vec4d>& points, const PatchForm& form, Double at_u, Double at_v) {
    const Basis<Degree> u(Degree(form.degree_u), at_u), v(Degree(form.degree_v), at_v);
    const Derivatives x = evaluate<Degree, kDetail>(points, 0, u, v), y = evaluate<Degree, kDetail>(points, 1, u, v),
                      z = evaluate<Degree, kDetail>(points, 2, u, v);
    Point p{{x.value, y.value, z.value}, {x.du, y.du, z.du},    {x.dv, y.dv, z.dv},
            {x.duu, y.duu, z.duu},       {x.duv, y.duv, z.duv}, {x.dvv, y.dvv, z.dvv}};
    if constexpr (kRational) divide_by_weight<kDetail>(p, evaluate<Degree, kDetail>(points, 3, u, v));
    return p;
}

/// normalized_or() where there is a direction; clears the lanes of `sound` that have none.
HWY_INLINE Vec3 normalized(const Vec3& v, Mask& sound) {
    const Double largest = max_abs(v);
    const Vec3 scaled = divided(v, largest);
    const Double length = hn::Sqrt(dot(scaled, scaled));
    // The scaled vector's length is 1 at least, unless something was not a number.
    sound = hn::And(sound, hn::And(hn::Gt(largest, all(0.0)), hn::And(is_finite(largest), hn::Ge(length, all(1.0)))));
    return divided(scaled, length);
}
HWY_INLINE FloatVec3 normalized(const FloatVec3& v, Mask& sound) {
    const Float largest = hn::Max(hn::Abs(v.x), hn::Max(hn::Abs(v.y), hn::Abs(v.z)));
    const FloatVec3 scaled{hn::Div(v.x, largest), hn::Div(v.y, largest), hn::Div(v.z, largest)};
    const Float length = hn::Sqrt(dot(scaled, scaled));
    const Double of = hn::PromoteTo(Doubles(), largest);
    const Mask has_length = hn::Ge(hn::PromoteTo(Doubles(), length), all(1.0));
    sound = hn::And(sound, hn::And(hn::Gt(of, all(0.0)), hn::And(is_finite(of), has_length)));
    return {hn::Div(scaled.x, length), hn::Div(scaled.y, length), hn::Div(scaled.z, length)};
}

/// Imath's length(), of what is not tiny; clears the lanes of `sound` where it is.
HWY_INLINE Double length_of(const Vec3& v, Mask& sound) {
    const Double squared = dot(v, v);
    sound = hn::And(sound, hn::And(hn::Ge(squared, all(2.0 * DBL_MIN)), is_finite(squared)));
    return hn::Sqrt(squared);
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

/// What carries local vectors into the world.
struct Maps {
    Vec3 x, y, z;

    HWY_INLINE Vec3 apply(const Vec3& v) const { return times(x, v.x) + times(y, v.y) + times(z, v.z); }
};

/// A row of each coordinate.
HWY_INLINE void store(const Vec3& v, double (*rows)[SurfaceLanes::kMost], size_t first) {
    hn::Store(v.x, Doubles(), rows[0] + first);
    hn::Store(v.y, Doubles(), rows[1] + first);
    hn::Store(v.z, Doubles(), rows[2] + first);
}
HWY_INLINE void store(const FloatVec3& v, float (*rows)[SurfaceLanes::kMost], size_t first) {
    hn::Store(v.x, Floats(), rows[0] + first);
    hn::Store(v.y, Floats(), rows[1] + first);
    hn::Store(v.z, Floats(), rows[2] + first);
}

/// The lanes from `first` on.
template <typename Degree, bool kRational, SurfaceDetail kDetail>
HWY_INLINE uint32_t compute(SurfaceLanes& lanes, const PatchForm& form, size_t first) {
    const auto row = [&](const double* numbers) HWY_ATTR { return hn::Load(Doubles(), numbers + first); };
    const OfEach<Vec4d> points(lanes.points + first);
    const OfEach<InstanceRecord> records(lanes.records + first);
    const InstanceRecord& record = records.first();
    const Affine3d& map = record.local_to_world;
    const Maps to_world{records.vector(map.x), records.vector(map.y), records.vector(map.z)};
    const Maps normals{records.vector(record.normal_x), records.vector(record.normal_y),
                       records.vector(record.normal_z)};
    const Vec3 translation = records.vector(map.translation);
    Mask sound = hn::FirstN(Doubles(), kWidth);

    const Point p = evaluate<Degree, kRational, kDetail>(points, form, row(lanes.u), row(lanes.v));
    const Normal exact = normal_of<kDetail>(p, sound);
    const FloatVec3 facet{hn::Load(Floats(), lanes.facet_normal[0] + first),
                          hn::Load(Floats(), lanes.facet_normal[1] + first),
                          hn::Load(Floats(), lanes.facet_normal[2] + first)};
    const Double turn = hn::PromoteTo(Doubles(), dot(to_floats(exact.unit), normalized(facet, sound)));
    const Double side = hn::IfThenElse(hn::Gt(turn, all(0.0)), all(1.0), all(-1.0));

    store(to_world.apply(p.position) + translation, lanes.position, first);
    const Vec3 facet_position{row(lanes.facet_position[0]), row(lanes.facet_position[1]), row(lanes.facet_position[2])};
    const Vec3 start = to_world.apply(facet_position) + translation;
    store(start, lanes.facet_position_out, first);
    const FloatVec3 facet_normal = to_floats(normalized(normals.apply(to_doubles(facet)), sound));
    store(facet_normal, lanes.facet_normal_out, first);
    const Vec3 mapped = normals.apply(to_doubles(to_floats(times(exact.unit, side))));
    const Double mapped_length = length_of(mapped, sound);
    const FloatVec3 normal = to_floats(normalized(mapped, sound));
    store(normal, lanes.normal, first);
    const auto store_derivative = [&](const Vec3& v, float(*rows)[SurfaceLanes::kMost]) HWY_ATTR {
        store(to_floats(to_world.apply(to_doubles(to_floats(v)))), rows, first);
    };
    const Double length_u = row(lanes.length_u), length_v = row(lanes.length_v);
    store_derivative(divided(p.du, length_u), lanes.dp_du);
    store_derivative(divided(p.dv, length_v), lanes.dp_dv);
    if constexpr (kDetail == SurfaceDetail::Curvature) {
        const Vec3 n = to_doubles(normal);
        const auto store_change = [&](const Vec3& by, Double length, float(*rows)[SurfaceLanes::kMost]) HWY_ATTR {
            const Vec3 change = normals.apply(to_doubles(to_floats(times(by, hn::Div(side, length)))));
            store(to_floats(divided(change - times(n, dot(n, change)), mapped_length)), rows, first);
        };
        store_change(exact.by_u, length_u, lanes.dn_du);
        store_change(exact.by_v, length_v, lanes.dn_dv);
    }

    const Vec3 n = to_doubles(facet_normal);
    const Double reach = length_of({dot(to_world.x, n), dot(to_world.y, n), dot(to_world.z, n)}, sound);
    const Double world = hn::Add(hn::Add(row(lanes.size), max_abs(start)), max_abs(translation));
    const Double rounding =
        hn::Add(hn::Mul(records.number(record.shear), world), records.number(record.sum_of_lengths));
    const Double offset =
        hn::Add(hn::Mul(row(lanes.float_error), reach), hn::Mul(all(InstanceRecord::kRoundingUnit), rounding));
    hn::Store(offset, Doubles(), lanes.start_offset + first);
    hn::Store(hn::Add(offset, hn::Mul(row(lanes.vertex_error), records.number(record.longest))), Doubles(),
              lanes.facet_error + first);

    uint64_t bits = 0;  // Highway wants room for 8 bytes.
    hn::StoreMaskBits(Doubles(), sound, reinterpret_cast<uint8_t*>(&bits));
    return static_cast<uint32_t>(bits);
}

template <typename Degree, bool kRational, SurfaceDetail kDetail>
void compute_all(const PatchForm& form, SurfaceLanes& lanes) {
    lanes.done = 0;
    for (size_t first = 0; first < lanes.count; first += kWidth)
        lanes.done |= compute<Degree, kRational, kDetail>(lanes, form, first) << first;
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

void surfaces_of_lanes(const PatchForm& form, SurfaceDetail detail, SurfaceLanes& lanes) {
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

HWY_EXPORT(surfaces_of_lanes);

bool has_lanes(const PatchForm& form) {
    const auto few = [](int degree) { return degree >= 1 && degree <= SurfaceLanes::kMostDegree; };
    return few(form.degree_u) && few(form.degree_v);
}

void compute_surfaces(const PatchForm& form, SurfaceDetail detail, SurfaceLanes& lanes) {
    HWY_DYNAMIC_DISPATCH(surfaces_of_lanes)(form, detail, lanes);
}

}  // namespace rayleaf
#endif
