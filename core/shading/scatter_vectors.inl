// Numbers and vectors over the lanes of ScatterLanes, and the facets of a rough reflection, as lobe_microfacet.cpp,
// microfacet.h and fresnel.h have them, with the same operations in the same order. Include it after base/lanes.inl, as
// that is.

using Floats = hn::CappedTag<float, ScatterLanes::kMost>;
using Words = hn::RebindToUnsigned<Floats>;
using Float = hn::Vec<Floats>;
using Truth = hn::Mask<Floats>;
constexpr size_t kWidth = hn::MaxLanes(Floats());

HWY_INLINE Float all(float x) {
    return hn::Set(Floats(), x);
}
HWY_INLINE Float load(const float* row) {
    return hn::Load(Floats(), row);
}
HWY_INLINE Truth holds(const float* row) {
    return hn::Ne(load(row), hn::Zero(Floats()));
}
HWY_INLINE void store(Float x, float* row) {
    hn::Store(x, Floats(), row);
}
HWY_INLINE void store(Truth x, float* row) {
    hn::Store(hn::IfThenElseZero(x, all(1.0f)), Floats(), row);
}
HWY_INLINE Truth is_positive(Float x) {
    return hn::Gt(x, hn::Zero(Floats()));
}
HWY_INLINE Float not_negative(Float x) {
    return hn::Max(x, hn::Zero(Floats()));
}
HWY_INLINE Float square(Float x) {
    return hn::Mul(x, x);
}
HWY_INLINE Float less_than_one(Float x) {
    return hn::Sub(all(1.0f), x);
}

using Float3 = LaneVec3<Float>;
HWY_INLINE Float3 load(const ScatterLanes::Rows3& rows, size_t first) {
    return {load(rows.x + first), load(rows.y + first), load(rows.z + first)};
}
HWY_INLINE void store(const Float3& v, ScatterLanes::Rows3& rows, size_t first) {
    store(v.x, rows.x + first);
    store(v.y, rows.y + first);
    store(v.z, rows.z + first);
}
HWY_INLINE Float3 kept_where(Truth which, const Float3& a) {
    return {hn::IfThenElseZero(which, a.x), hn::IfThenElseZero(which, a.y), hn::IfThenElseZero(which, a.z)};
}
HWY_INLINE Float mean(const Float3& v) {
    return hn::Mul(hn::Add(hn::Add(v.x, v.y), v.z), all(1.0f / 3.0f));
}
HWY_INLINE Float3 unit_or_z(const Float3& v) {
    const Float length2 = dot(v, v);
    const Float3 along = times(v, hn::Div(all(1.0f), hn::Sqrt(length2)));
    return select(hn::Gt(length2, all(std::numeric_limits<float>::min())), along, {all(0.0f), all(0.0f), all(1.0f)});
}

struct Frame {
    Float3 x, y, z;

    HWY_INLINE Frame(const ScatterLanes::LobeRows& lobe, size_t first)
        : x(load(lobe.tangent, first)), y(cross(load(lobe.normal, first), x)), z(load(lobe.normal, first)) {}
    HWY_INLINE Float3 to_local(const Float3& v) const { return {dot(x, v), dot(y, v), dot(z, v)}; }
    HWY_INLINE Float3 to_world(const Float3& v) const { return times(x, v.x) + times(y, v.y) + times(z, v.z); }
};

struct Float2 {
    Float x, y;
};
HWY_INLINE Float2 on_circle(Float turns) {
    const Float half_turns = hn::Mul(all(2.0f), turns), shifted = hn::Add(half_turns, all(0x1.8p23f));
    const Float half = hn::Mul(hn::Sub(half_turns, hn::Sub(shifted, all(0x1.8p23f))), all(0.5f * kPi));
    const Float half2 = square(half);
    const auto series = [&](float a, float b, float c) HWY_ATTR {
        const Float inner = hn::Add(all(b), hn::Mul(half2, all(c)));
        return hn::Add(all(1.0f), hn::Mul(half2, hn::Add(all(a), hn::Mul(half2, inner))));
    };
    const Float sine = hn::Mul(half, series(-0.16666651f, 0.0083319582f, -0.00019493476f));
    const Float cosine = series(-0.49999893f, 0.041656181f, -0.0013596585f);
    const auto odd = hn::ShiftLeft<31>(hn::BitCast(Words(), shifted));
    const auto turned = [odd](Float x)
                            HWY_ATTR { return hn::BitCast(Floats(), hn::Xor(hn::BitCast(Words(), x), odd)); };
    return {turned(less_than_one(hn::Mul(hn::Mul(all(2.0f), sine), sine))),
            turned(hn::Mul(hn::Mul(all(2.0f), sine), cosine))};
}

HWY_INLINE Float dielectric_fresnel(Float cosine, Float ior) {
    const Float c = hn::Min(hn::Abs(cosine), all(1.0f)), one = all(1.0f);
    const Float beyond2 = hn::Add(hn::Mul(hn::Sub(ior, one), hn::Add(ior, one)), square(c));
    const Float beyond = hn::Sqrt(beyond2), bent = hn::Mul(square(ior), c);
    const Float perpendicular = hn::Div(hn::Sub(c, beyond), hn::Add(c, beyond));
    const Float parallel = hn::Div(hn::Sub(bent, beyond), hn::Add(bent, beyond));
    const Float share = hn::Mul(all(0.5f), hn::Add(square(perpendicular), square(parallel)));
    return hn::IfThenElse(is_positive(beyond2), share, hn::IfThenZeroElse(hn::Eq(ior, one), one));
}
HWY_INLINE Float3 coloured_fresnel(const Float3& fresnel_0, Float ior, Float cosine) {
    const Float above = hn::Add(ior, all(1.0f)), scale = hn::Div(square(above), hn::Mul(all(4.0f), ior));
    const Float rise = less_than_one(hn::Mul(less_than_one(dielectric_fresnel(cosine, ior)), scale));
    const Float h = hn::Min(not_negative(rise), all(1.0f));
    return times(fresnel_0, less_than_one(h)) + Float3{h, h, h};
}
HWY_INLINE Float schlick_weight(Float cosine) {
    const Float m = hn::Min(not_negative(less_than_one(cosine)), all(1.0f));
    return hn::Mul(square(square(m)), m);
}

/// Of a rough reflection.
struct Facets {
    Float alpha_x, alpha_y, ior;
    Float3 weight, normal, fresnel_0;
    Truth is_even, is_schlick, is_joint;
    Frame frame;

    HWY_INLINE Facets(const ScatterLanes& lanes, size_t first)
        : alpha_x(load(lanes.alpha_x + first)),
          alpha_y(load(lanes.alpha_y + first)),
          ior(load(lanes.ior + first)),
          weight(load(lanes.facets.weight, first)),
          normal(load(lanes.facets.normal, first)),
          fresnel_0(load(lanes.fresnel_0, first)),
          is_even(hn::Eq(alpha_x, alpha_y)),
          is_schlick(holds(lanes.is_schlick + first)),
          is_joint(holds(lanes.is_joint + first)),
          frame(lanes.facets, first) {}

    HWY_INLINE Float spread2(const Float3& local) const {
        return hn::Add(square(hn::Mul(local.x, alpha_x)), square(hn::Mul(local.y, alpha_y)));
    }
    HWY_INLINE Float crossed2(const Float3& local) const {
        return hn::Add(square(hn::Mul(local.x, alpha_y)), square(hn::Mul(local.y, alpha_x)));
    }
    /// Of directions of the world.
    HWY_INLINE Float spread2(const Float3& w, Float cosine) const {
        const Float even = hn::Mul(square(alpha_x), not_negative(less_than_one(square(cosine))));
        return hn::IfThenElse(is_even, even, spread2(frame.to_local(w)));
    }
    HWY_INLINE Float crossed2_in_world(const Float3& h) const {
        const Float3 across = cross(normal, h);
        const Float even = hn::Mul(square(alpha_x), dot(across, across));
        return hn::IfThenElse(is_even, even, crossed2(frame.to_local(h)));
    }
    HWY_INLINE Float normal_density(Float cosine, Float crossed) const {
        const Float product = hn::Mul(alpha_x, alpha_y), product2 = square(product);
        const Float spread = hn::Add(crossed, hn::Mul(square(cosine), product2));
        const Float density = hn::Div(hn::Mul(product, product2), hn::Mul(hn::Mul(all(kPi), spread), spread));
        return hn::IfThenElseZero(is_positive(cosine), density);
    }
    HWY_INLINE Float masking(Float cosine, Float spread) const {
        const Float root = hn::Sqrt(hn::Add(spread, square(cosine)));
        const Float seen = hn::Div(hn::Mul(all(2.0f), cosine), hn::Add(cosine, root));
        return hn::IfThenElseZero(is_positive(cosine), seen);
    }
    HWY_INLINE Float shadowing(Float seen, Float towards) const {
        const Float joint = hn::Div(towards, hn::Sub(hn::Add(towards, seen), hn::Mul(towards, seen)));
        return hn::IfThenElse(hn::And(is_joint, is_positive(towards)), joint, towards);
    }
    HWY_INLINE Float3 reflectance(Float cosine) const {
        const Float one = all(1.0f);
        return select(is_schlick, coloured_fresnel(fresnel_0, ior, cosine), {one, one, one});
    }
    HWY_INLINE Float choice_weight(Float cosine) const {
        const Float share = hn::Max(mean(reflectance(cosine)), all(0.05f)), whole = mean(weight);
        return hn::IfThenElse(is_schlick, hn::Mul(whole, share), whole);
    }
    HWY_INLINE Float3 visible_normal(const Float3& o, Float random_x, const Float2& circle) const {
        const Float3 stretched = unit_or_z({hn::Mul(o.x, alpha_x), hn::Mul(o.y, alpha_y), o.z});
        const Float zero = hn::Zero(Floats()), one = all(1.0f), root = hn::Sqrt(random_x);
        const Float length2 = hn::Add(square(stretched.x), square(stretched.y));
        const Float3 aside = times({hn::Neg(stretched.y), stretched.x, zero}, hn::Div(one, hn::Sqrt(length2)));
        const Float3 t1 = select(is_positive(length2), aside, {one, zero, zero}), t2 = cross(stretched, t1);
        const Float at_x = hn::Mul(circle.x, root), at_y = hn::Mul(circle.y, root), x2 = square(at_x);
        const Float room = hn::Sqrt(not_negative(less_than_one(x2)));
        const Float share = hn::Mul(all(0.5f), hn::Add(one, stretched.z));
        const Float p2 = hn::Add(hn::Mul(less_than_one(share), room), hn::Mul(share, at_y));
        const Float p3 = hn::Sqrt(not_negative(hn::Sub(less_than_one(x2), square(p2))));
        const Float3 h = times(t1, at_x) + times(t2, p2) + times(stretched, p3);
        return unit_or_z({hn::Mul(h.x, alpha_x), hn::Mul(h.y, alpha_y), not_negative(h.z)});
    }
};
