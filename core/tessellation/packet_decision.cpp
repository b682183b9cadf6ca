#include "tessellation/packet_decision.h"

#include "base/simd_choice.h"

#include <bit>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tessellation/packet_decision.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace rayleaf {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Lanes = hn::CappedTag<double, 8>;
using Vector = hn::Vec<Lanes>;
using Mask = hn::Mask<Lanes>;
constexpr int kWidth = static_cast<int>(hn::MaxLanes(Lanes()));

#include "base/lanes.inl"

using Vector3 = LaneVec3<Vector>;

/// a + b u + c v
HWY_INLINE Vector3 combined(const Vector3& a, const Vector3& b, Vector u, const Vector3& c, Vector v) {
    const auto sum = [&](Vector p, Vector q, Vector r) { return hn::Add(hn::Add(p, hn::Mul(q, u)), hn::Mul(r, v)); };
    return {sum(a.x, b.x, c.x), sum(a.y, b.y, c.y), sum(a.z, b.z, c.z)};
}
HWY_INLINE Vector edge(const Vector3& p, const Vector3& q) {
    return hn::Sub(hn::Mul(p.x, q.y), hn::Mul(p.y, q.x));
}
/// As std::min(a, b).
HWY_INLINE Vector least(Vector a, Vector b) {
    return hn::IfThenElse(hn::Lt(b, a), b, a);
}
HWY_INLINE Mask has_length(const Vector3& v) {
    const Lanes lanes;
    return hn::Or(hn::Ne(v.x, hn::Zero(lanes)), hn::Or(hn::Ne(v.y, hn::Zero(lanes)), hn::Ne(v.z, hn::Zero(lanes))));
}
/// Where rays meet a facet.
struct Met {
    Vector t, u, v;
    Vector3 position, normal;

    HWY_INLINE void store_in(FacetHits& hits, int first) const {
        const Lanes lanes;
        hn::Store(t, lanes, hits.t + first);
        hn::Store(u, lanes, hits.u + first);
        hn::Store(v, lanes, hits.v + first);
        store(lanes, position, hits.position, first);
        store(lanes, normal, hits.normal, first);
    }
};

HWY_INLINE Met one_of(Mask mask, const Met& a, const Met& b) {
    return {hn::IfThenElse(mask, a.t, b.t), hn::IfThenElse(mask, a.u, b.u), hn::IfThenElse(mask, a.v, b.v),
            select(mask, a.position, b.position), select(mask, a.normal, b.normal)};
}
HWY_INLINE Vector3 set(const Vec3d& v) {
    const Lanes lanes;
    return {hn::Set(lanes, v.x), hn::Set(lanes, v.y), hn::Set(lanes, v.z)};
}

/// FacetRay by lane.
class Frames {
  public:
    HWY_INLINE Frames(const RayPacket& rays, int first) {
        const Lanes lanes;
        const Vector3 origin = load(lanes, rays.origin, first), direction = load(lanes, rays.direction, first);
        begin_ = hn::Load(lanes, rays.start + first);
        origin_ = {hn::Add(origin.x, hn::Mul(direction.x, begin_)), hn::Add(origin.y, hn::Mul(direction.y, begin_)),
                   hn::Add(origin.z, hn::Mul(direction.z, begin_))};
        const Vector x = hn::Abs(direction.x), y = hn::Abs(direction.y), z = hn::Abs(direction.z);
        const Mask over_y = hn::Ge(x, y);
        along_x_ = hn::And(over_y, hn::Ge(x, z));
        along_y_ = hn::AndNot(over_y, hn::Ge(y, z));
        const Vector3 turned_direction = turned(direction);
        scale_z_ = hn::Div(hn::Set(lanes, 1.0), turned_direction.z);
        shear_x_ = hn::Div(turned_direction.x, turned_direction.z);
        shear_y_ = hn::Div(turned_direction.y, turned_direction.z);
    }
    /// The lanes that meet a facet; `hit` is where.
    HWY_INLINE Mask meet(const Vector3& p, const Vector3& q, const Vector3& r, Met& hit) const {
        const Lanes lanes;
        const Vector zero = hn::Zero(lanes), one = hn::Set(lanes, 1.0);
        const Vector3 a = sheared(p), b = sheared(q), c = sheared(r);
        const Vector ab = edge(a, b), bc = edge(b, c), ca = edge(c, a);
        const Mask negative = hn::Or(hn::Lt(ab, zero), hn::Or(hn::Lt(bc, zero), hn::Lt(ca, zero)));
        const Mask positive = hn::Or(hn::Gt(ab, zero), hn::Or(hn::Gt(bc, zero), hn::Gt(ca, zero)));
        const Mask outside = hn::And(negative, positive);
        if (hn::AllTrue(lanes, outside)) return hn::Not(outside);
        const Vector area = hn::Add(hn::Add(bc, ca), ab);
        const Vector3 edge1 = q - p, edge2 = r - p;
        const Vector depth = hn::Add(hn::Add(hn::Mul(bc, a.z), hn::Mul(ca, b.z)), hn::Mul(ab, c.z));
        hit.u = least(hn::Div(ca, area), one);
        hit.v = least(hn::Div(ab, area), hn::Sub(one, hit.u));
        hit.t = hn::Add(begin_, hn::Mul(hn::Div(depth, area), scale_z_));
        hit.position = combined(p, edge1, hit.u, edge2, hit.v);
        hit.normal = cross(edge1, edge2);
        const Mask is_finite = hn::Lt(hn::Abs(hit.t), hn::Set(lanes, std::numeric_limits<double>::infinity()));
        const Mask has_area = hn::And(hn::Ne(area, zero), has_length(hit.normal));
        return hn::AndNot(outside, hn::And(has_area, is_finite));
    }

  private:
    Vector3 origin_;
    Vector begin_, shear_x_, shear_y_, scale_z_;
    Mask along_x_, along_y_;

    /// The axis along which the ray is largest becomes the last.
    HWY_INLINE Vector3 turned(const Vector3& v) const {
        return {hn::IfThenElse(along_x_, v.y, hn::IfThenElse(along_y_, v.z, v.x)),
                hn::IfThenElse(along_x_, v.z, hn::IfThenElse(along_y_, v.x, v.y)),
                hn::IfThenElse(along_x_, v.x, hn::IfThenElse(along_y_, v.y, v.z))};
    }
    HWY_INLINE Vector3 sheared(const Vector3& corner) const {
        const Vector3 from = turned(corner - origin_);
        return {hn::Sub(from.x, hn::Mul(shear_x_, from.z)), hn::Sub(from.y, hn::Mul(shear_y_, from.z)), from.z};
    }
};

uint32_t bits_of_half(uint32_t bits, int first) {
    return bits >> first & ((1u << kWidth) - 1u);
}

uint32_t meet_facets(const RayPacket& rays, uint32_t asked, FacetLanes& facets) {
    const Lanes lanes;
    uint32_t hits = 0;
    for (int first = 0; first < kPacketSize; first += kWidth) {
        if (bits_of_half(asked, first) == 0) continue;
        Met met{};
        const Mask mask = Frames(rays, first)
                              .meet(load(lanes, facets.corners[0], first), load(lanes, facets.corners[1], first),
                                    load(lanes, facets.corners[2], first), met);
        met.store_in(facets.hits, first);
        hits |= mask_bits(lanes, mask) << first;
    }
    return hits & asked;
}

uint32_t meet_closest(const RayPacket& rays, uint32_t asked, std::span<const FacetCorners> facets,
                      NearestFacets& nearest) {
    const Lanes lanes;
    uint32_t hits = 0;
    for (int first = 0; first < kPacketSize; first += kWidth) {
        if (bits_of_half(asked, first) == 0) continue;
        const Frames frames(rays, first);
        const Vector from = hn::Load(lanes, rays.t_min + first), to = hn::Load(lanes, rays.t_max + first);
        Met best{};
        Vector number = hn::Zero(lanes);
        Mask found = hn::Lt(number, number);  // none
        for (size_t i = 0; i < facets.size(); ++i) {
            Met met{};
            const Mask inside = frames.meet(set(facets[i][0]), set(facets[i][1]), set(facets[i][2]), met);
            const Mask first_or_nearer = hn::Or(hn::Not(found), hn::Lt(met.t, best.t));
            const Mask counts =
                hn::And(hn::And(inside, first_or_nearer), hn::And(hn::Ge(met.t, from), hn::Le(met.t, to)));
            if (hn::AllFalse(lanes, counts)) continue;
            best = one_of(counts, met, best);
            number = hn::IfThenElse(counts, hn::Set(lanes, static_cast<double>(i)), number);
            found = hn::Or(found, counts);
        }
        best.store_in(nearest.hits, first);
        hn::Store(number, lanes, nearest.number + first);
        hits |= mask_bits(lanes, found) << first;
    }
    return hits & asked;
}

uint32_t meet_any(const RayPacket& rays, uint32_t asked, std::span<const FacetCorners> facets) {
    const Lanes lanes;
    uint32_t hits = 0;
    for (int first = 0; first < kPacketSize; first += kWidth) {
        const uint32_t wanted = bits_of_half(asked, first);
        if (wanted == 0) continue;
        const Frames frames(rays, first);
        const Vector from = hn::Load(lanes, rays.t_min + first), to = hn::Load(lanes, rays.t_max + first);
        uint32_t found = 0;
        for (size_t i = 0; i < facets.size() && (wanted & ~found) != 0; ++i) {
            Met met{};
            const Mask inside = frames.meet(set(facets[i][0]), set(facets[i][1]), set(facets[i][2]), met);
            found |= mask_bits(lanes, hn::And(inside, hn::And(hn::Ge(met.t, from), hn::Le(met.t, to))));
        }
        hits |= found << first;
    }
    return hits & asked;
}

}  // namespace HWY_NAMESPACE
}  // namespace rayleaf
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rayleaf {

HWY_EXPORT(meet_facets);
HWY_EXPORT(meet_closest);
HWY_EXPORT(meet_any);

MeetFacets decision_kernel() {
    choose_kernels();
    return &HWY_DYNAMIC_DISPATCH(meet_facets);
}

MeetFewFacets few_facets_kernel() {
    choose_kernels();
    return {&HWY_DYNAMIC_DISPATCH(meet_closest), &HWY_DYNAMIC_DISPATCH(meet_any)};
}

}  // namespace rayleaf
#endif
