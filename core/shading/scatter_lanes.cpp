#include "shading/scatter_lanes.h"

#include "base/simd.h"
#include "shading/lobes.h"
#include "shading/scatter_rows.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "shading/scatter_lanes.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace rayleaf {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#include "base/lanes.inl"
#include "shading/scatter_vectors.inl"

// Each function does for every lane what closure_view.cpp, lobe_diffuse.cpp and lobe_microfacet.cpp do for one point.

/// Two lobes as they are seen; one that is not there has no probability.
struct Views {
    Float diffuse_probability, diffuse_cosine;
    Float facets_probability, facets_cosine, masking, mirrored;
    Truth has_both, any;
};

HWY_INLINE Views look(const ScatterLanes& lanes, size_t first, const Facets& facets, const Float3& outgoing) {
    const Truth diffuse = holds(lanes.diffuse.is_there + first), glossy = holds(lanes.facets.is_there + first);
    Views v;
    v.has_both = hn::And(diffuse, glossy);
    v.diffuse_cosine = dot(load(lanes.diffuse.normal, first), outgoing);
    v.facets_cosine = dot(facets.normal, outgoing);
    v.masking = facets.masking(v.facets_cosine, facets.spread2(outgoing, v.facets_cosine));
    v.mirrored =
        hn::IfThenElseZero(is_positive(v.facets_cosine), hn::Div(v.masking, hn::Mul(all(4.0f), v.facets_cosine)));
    const Float a = mean(load(lanes.diffuse.weight, first)), b = facets.choice_weight(v.facets_cosine);
    const Float total = hn::Add(a, b), one = all(1.0f);
    const Truth chooses = is_positive(total);
    const Float scale = hn::IfThenElseZero(chooses, hn::Div(one, total));
    v.any = hn::Or(hn::Not(v.has_both), chooses);
    v.diffuse_probability = hn::IfThenElse(v.has_both, hn::Mul(a, scale), hn::IfThenElseZero(diffuse, one));
    v.facets_probability = hn::IfThenElse(v.has_both, hn::Mul(b, scale), hn::IfThenElseZero(glossy, one));
    return v;
}

/// A direction that a lobe chose.
struct Chosen {
    Float3 direction;
    Truth is_valid, by_facets;
    Float local_z;  ///< by the diffuse lobe: its cosine
};

HWY_INLINE Chosen choose(const ScatterLanes& lanes, size_t first, const Facets& facets, const Float3& outgoing,
                         const Views& v) {
    const Float given = load(lanes.random_x + first);
    Chosen c;
    c.by_facets = hn::Or(hn::Not(holds(lanes.diffuse.is_there + first)),
                         hn::And(v.has_both, hn::Ge(given, v.diffuse_probability)));
    const Float probability = hn::IfThenElse(c.by_facets, v.facets_probability, v.diffuse_probability);
    const Float left = hn::IfThenElse(c.by_facets, hn::Sub(given, v.diffuse_probability), given);
    const Float x = hn::IfThenElse(v.has_both, hn::Min(hn::Div(left, probability), all(1.0f - 6e-8f)), given);
    const Float2 circle = on_circle(load(lanes.random_y + first));
    const Float root = hn::Sqrt(x);
    c.local_z = hn::Sqrt(not_negative(less_than_one(x)));
    const Float3 local{hn::Mul(circle.x, root), hn::Mul(circle.y, root), c.local_z};
    const Float3 o = facets.frame.to_local(outgoing), h = facets.visible_normal(o, x, circle);
    const Float3 i = times(h, hn::Mul(all(2.0f), dot(h, o))) - o;
    c.direction = select(c.by_facets, facets.frame.to_world(i), Frame(lanes.diffuse, first).to_world(local));
    const Truth reflects = hn::And(is_positive(v.mirrored), is_positive(i.z));
    c.is_valid = hn::And(hn::And(v.any, is_positive(probability)), hn::Or(hn::Not(c.by_facets), reflects));
    return c;
}

/// Halfway between two directions.
struct Half {
    Float3 direction;
    Float cosine;

    HWY_INLINE Half(const Float3& outgoing, const Float3& incoming) {
        const Float3 both = outgoing + incoming;
        const Float length = hn::Sqrt(dot(both, both));
        direction = kept_where(is_positive(length), times(both, hn::Div(all(1.0f), length)));
        cosine = hn::Mul(all(0.5f), length);
    }
};

/// What a lobe makes of light: value and density; of the diffuse lobe also the one over the other, where it chose.
struct Light {
    Float3 value;
    Float density;
    Float3 weight;
};

HWY_INLINE Float bump_shadow(Truth by_facets, const Float3& smooth, const Float3& bent, const Float3& incoming) {
    const Float light = dot(smooth, incoming), bump = dot(smooth, bent), product = hn::Mul(dot(bent, incoming), bump);
    const Float g = hn::Div(light, product), one = all(1.0f);
    const Truth lit = hn::And(hn::Ne(product, hn::Zero(Floats())), is_positive(g));
    const Float cubic = hn::Mul(g, hn::Add(one, hn::Mul(g, less_than_one(g))));
    const Float cosine = hn::Abs(light), lean = hn::Abs(bump);
    const auto tangent2 = [&](Float x) HWY_ATTR { return hn::Sub(hn::Div(one, square(x)), one); };
    const Float alpha2 = hn::Min(hn::Mul(all(0.125f), tangent2(lean)), one);
    const Float root = hn::Sqrt(hn::Add(one, hn::Mul(alpha2, tangent2(cosine))));
    const Float facets = hn::Div(all(2.0f), hn::Add(one, root));
    const Truth is_soft = hn::Or(by_facets, hn::Lt(g, one));
    const Truth is_whole = hn::And(by_facets, hn::Or(hn::Ge(cosine, one), hn::Ge(lean, one)));
    const Float soft = hn::IfThenElse(by_facets, facets, cubic);
    return hn::IfThenElseZero(lit, hn::IfThenElse(hn::AndNot(is_whole, is_soft), soft, one));
}

HWY_INLINE Light diffuse_light(const ScatterLanes& lanes, size_t first, const Float3& outgoing, const Views& v,
                               const Chosen& c, const Half& half) {
    const Float3 normal = load(lanes.diffuse.normal, first), weight = load(lanes.diffuse.weight, first);
    const Float cosine = hn::IfThenElse(c.by_facets, dot(normal, c.direction), c.local_z);
    const Float density = hn::Mul(cosine, all(1.0f / kPi));
    const Float along = hn::Add(all(0.5f), hn::Mul(all(0.5f), dot(outgoing, c.direction)));
    const Float cos2_half = hn::IfThenElse(c.by_facets, square(half.cosine), along);
    const Float roughness = load(lanes.roughness + first), one = all(1.0f);
    const Float grazing = hn::Sub(hn::Mul(hn::Mul(all(2.0f), roughness), cos2_half), all(0.5f));
    const auto rise = [&](Float x) HWY_ATTR { return hn::Add(one, hn::Mul(grazing, schlick_weight(x))); };
    const Float disney =
        hn::IfThenElseZero(is_positive(v.diffuse_cosine), hn::Mul(rise(cosine), rise(v.diffuse_cosine)));
    const Float shape = hn::IfThenElse(holds(lanes.is_disney + first), disney, one);
    const Float shadow = hn::IfThenElse(
        holds(lanes.is_bent + first),
        bump_shadow(holds(lanes.is_by_facets + first), load(lanes.smooth_normal, first), normal, c.direction), one);
    const Truth lit = hn::And(holds(lanes.diffuse.is_there + first), is_positive(cosine));
    Light light;
    light.weight = times(times(weight, shape), shadow);
    const Float3 evaluated = times(times(weight, hn::Mul(density, shape)), shadow);
    light.value = kept_where(lit, select(c.by_facets, evaluated, times(light.weight, density)));
    light.density = hn::IfThenElseZero(lit, density);
    return light;
}

HWY_INLINE Light facet_light(const ScatterLanes& lanes, size_t first, const Facets& facets, const Views& v,
                             const Float3& incoming, const Half& half) {
    const Float cosine = dot(facets.normal, incoming);
    const Float facet_density =
        facets.normal_density(dot(facets.normal, half.direction), facets.crossed2_in_world(half.direction));
    const Float masking = facets.masking(cosine, facets.spread2(incoming, cosine));
    const Truth there =
        hn::And(hn::And(holds(lanes.facets.is_there + first), is_positive(v.mirrored)), is_positive(cosine));
    Light light;
    light.density = hn::IfThenElseZero(there, hn::Mul(facet_density, v.mirrored));
    const Float3 coloured = times(facets.weight, facets.reflectance(half.cosine));
    const Float lit = hn::Mul(light.density, facets.shadowing(v.masking, masking));
    light.value = kept_where(there, times(coloured, lit));
    return light;
}

/// As two lobes make it together.
HWY_INLINE Light together(const Views& v, const Light& a, const Light& b) {
    Light both;
    both.value = a.value + b.value;
    both.density = hn::Add(hn::Mul(a.density, v.diffuse_probability), hn::Mul(b.density, v.facets_probability));
    return both;
}

/// Both sides of a surface, as closure_view.cpp asks for them; none of these lobes goes through.
HWY_INLINE Truth are_on_one_side(const Float3& normal, const Float3& a, const Float3& b) {
    return hn::Not(hn::Xor(is_positive(dot(normal, a)), is_positive(dot(normal, b))));
}

HWY_INLINE void light_lobes(ScatterLanes& lanes, ScatterLanes::Light& light, size_t first, const Facets& facets,
                            const Float3& outgoing, const Views& v) {
    Chosen c;  // as if another lobe had chosen it
    c.direction = load(light.incoming, first);
    c.by_facets = hn::Eq(all(0.0f), all(0.0f));
    c.local_z = all(0.0f);
    const Half half(outgoing, c.direction);
    const Light lit = together(v, diffuse_light(lanes, first, outgoing, v, c, half),
                               facet_light(lanes, first, facets, v, c.direction, half));
    const Truth counts = are_on_one_side(load(lanes.light_side, first), outgoing, c.direction);
    store(kept_where(counts, lit.value), light.value, first);
    store(hn::IfThenElseZero(counts, lit.density), light.density + first);
}

HWY_INLINE Truth is_finite(const Float3& v) {
    return hn::And(hn::And(hn::IsFinite(v.x), hn::IsFinite(v.y)), hn::IsFinite(v.z));
}
HWY_INLINE Truth is_black(const Float3& v) {
    const Float zero = hn::Zero(Floats());
    return hn::And(hn::And(hn::Eq(v.x, zero), hn::Eq(v.y, zero)), hn::Eq(v.z, zero));
}

void scatter_lanes(ScatterLanes& lanes) {
    for (size_t first = 0; first < lanes.count; first += kWidth) {
        const Facets facets(lanes, first);
        const Float3 outgoing = load(lanes.outgoing, first), side = load(lanes.facet_normal, first);
        const Views v = look(lanes, first, facets, outgoing);
        const Chosen c = choose(lanes, first, facets, outgoing, v);
        const Half half(outgoing, c.direction);
        const Light a = diffuse_light(lanes, first, outgoing, v, c, half);
        const Light b = facet_light(lanes, first, facets, v, c.direction, half);
        const Light both = together(v, a, b);
        const Float density = both.density;
        const Float3 evaluated = times(both.value, hn::Div(all(1.0f), density));
        const Truth diffuse_alone = hn::Not(holds(lanes.facets.is_there + first));
        const Float3 value = select(diffuse_alone, a.weight, evaluated);
        const Truth same = are_on_one_side(side, outgoing, c.direction);
        const Truth carries = hn::And(is_positive(density), hn::AndNot(is_black(value), is_finite(value)));
        store(v.diffuse_probability, lanes.diffuse.probability + first);
        store(v.diffuse_cosine, lanes.diffuse.cosine + first);
        store(v.facets_probability, lanes.facets.probability + first);
        store(v.facets_cosine, lanes.facets.cosine + first);
        store(v.masking, lanes.masking + first);
        store(v.mirrored, lanes.mirrored + first);
        store(v.any, lanes.is_any + first);
        store(hn::And(hn::And(c.is_valid, same), carries), lanes.is_found + first);
        store(c.by_facets, lanes.is_facets + first);
        store(c.direction, lanes.direction, first);
        store(value, lanes.value, first);
        store(density, lanes.density + first);
        for (size_t light = 0; light < lanes.light_count; ++light)
            light_lobes(lanes, lanes.lights[light], first, facets, outgoing, v);
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace rayleaf
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rayleaf {

HWY_EXPORT(scatter_lanes);

namespace {

/// From so many points on, lanes take less time.
constexpr size_t kLeastScatterLanes = 2;

bool is_plain_diffuse(const Lobe& lobe) {
    return lobe.type == LobeType::PrincipledDiffuse || (lobe.type == LobeType::Diffuse && lobe.roughness == 0.0f);
}
bool is_plain_reflection(const Lobe& lobe) {
    return lobe.type == LobeType::Reflection && lobe.alpha_x > 0.0f && lobe.film.thickness == 0.0f &&
           lobe.distribution == MicrofacetDistribution::Ggx &&
           (lobe.fresnel == Lobe::Fresnel::None || lobe.fresnel == Lobe::Fresnel::Schlick);
}

/// Its lobes, each null where there is none; both null where lanes do not know them.
struct KnownLobes {
    const Lobe *diffuse = nullptr, *facets = nullptr;

    KnownLobes() = default;
    explicit KnownLobes(const Closures& closures) {
        if (closures.size() == 1 && is_plain_reflection(closures[0])) facets = &closures[0];
        if (closures.size() == 0 || closures.size() > 2 || !is_plain_diffuse(closures[0])) return;
        if (closures.size() == 2 && !is_plain_reflection(closures[1])) return;
        diffuse = &closures[0];
        if (closures.size() == 2) facets = &closures[1];
    }
};

void set(const Vec3f& v, size_t i, ScatterLanes::Rows3& rows) {
    rows.x[i] = v.x;
    rows.y[i] = v.y;
    rows.z[i] = v.z;
}
Vec3f vector_at(const ScatterLanes::Rows3& rows, size_t i) {
    return {rows.x[i], rows.y[i], rows.z[i]};
}
float answer(bool yes) {
    return yes ? 1.0f : 0.0f;
}

void set_lobe(const Lobe& lobe, size_t i, ScatterLanes::LobeRows& rows) {
    rows.is_there[i] = 1.0f;
    set(lobe.weight, i, rows.weight);
    set(lobe.normal, i, rows.normal);
    set(lobe.tangent, i, rows.tangent);
}

void set_query(const ScatterQuery& query, const KnownLobes& lobes, size_t i, ScatterLanes& lanes) {
    set(query.outgoing, i, lanes.outgoing);
    set(query.facet_normal, i, lanes.facet_normal);
    lanes.random_x[i] = query.random.x;
    lanes.random_y[i] = query.random.y;
    set(query.light_side, i, lanes.light_side);
    for (size_t light = 0; light < kMostLights; ++light) {
        if (!query.lights[light]) continue;
        set(*query.lights[light], i, lanes.lights[light].incoming);
        lanes.light_count = std::max(lanes.light_count, light + 1);
    }
    if (lobes.diffuse) {
        const Vec3f& smooth = query.closures->smooth_normal;
        set_lobe(*lobes.diffuse, i, lanes.diffuse);
        set(smooth, i, lanes.smooth_normal);
        lanes.is_disney[i] = answer(lobes.diffuse->type == LobeType::PrincipledDiffuse);
        lanes.is_bent[i] = answer(is_bent(*lobes.diffuse, *query.closures));
        lanes.is_by_facets[i] = answer(query.closures->bump_shadow == BumpShadow::Facets);
        lanes.roughness[i] = lobes.diffuse->roughness;
    }
    if (lobes.facets) {
        const Lobe& lobe = *lobes.facets;
        set_lobe(lobe, i, lanes.facets);
        set(lobe.fresnel_0, i, lanes.fresnel_0);
        lanes.alpha_x[i] = lobe.alpha_x;
        lanes.alpha_y[i] = lobe.alpha_y;
        lanes.ior[i] = lobe.ior;
        lanes.is_schlick[i] = answer(lobe.fresnel == Lobe::Fresnel::Schlick);
        lanes.is_joint[i] = answer(lobe.masking == Masking::Joint);
    }
}

void take_view(const ScatterQuery& query, const KnownLobes& lobes, size_t i, const ScatterLanes& lanes) {
    ClosureView& view = *query.view;
    view.outgoing = query.outgoing;
    view.any = lanes.is_any[i] != 0.0f;
    view.halves = lobes.facets || lanes.is_disney[i] != 0.0f;
    LobeView* seen = view.lobes;
    if (lobes.diffuse)
        *seen++ = {lanes.diffuse.probability[i], lanes.diffuse.cosine[i], 0.0f, 0.0f, 1.0f, lanes.is_bent[i] != 0.0f};
    if (lobes.facets)
        *seen = {lanes.facets.probability[i], lanes.facets.cosine[i], lanes.masking[i], lanes.mirrored[i], 1.0f, false};
}

void take_sample(const ScatterQuery& query, const KnownLobes& lobes, size_t i, const ScatterLanes& lanes) {
    query.sample->reset();
    if (lanes.is_found[i] == 0.0f) return;
    const Lobe& lobe = lanes.is_facets[i] != 0.0f ? *lobes.facets : *lobes.diffuse;
    LobeSample& sample = query.sample->emplace();
    sample.direction = vector_at(lanes.direction, i);
    sample.weight = vector_at(lanes.value, i);
    sample.density = lanes.density[i];
    sample.kind = lobe.kind;
    sample.roughness = lobe_width(lobe);
}

void take_lights(const ScatterQuery& query, size_t i, const ScatterLanes& lanes) {
    for (size_t light = 0; light < kMostLights; ++light)
        if (query.lights[light])
            (*query.lit)[light] = {vector_at(lanes.lights[light].value, i), lanes.lights[light].density[i]};
}

/// Up to ScatterLanes::kMost queries that lanes know.
struct KnownQueries {
    std::array<ScatterQuery*, ScatterLanes::kMost> queries;
    std::array<KnownLobes, ScatterLanes::kMost> lobes;
    size_t count = 0;

    void answer() {
        ScatterLanes lanes;
        std::memset(&lanes, 0, sizeof lanes);
        lanes.count = count;
        for (size_t i = 0; i < count; ++i) set_query(*queries[i], lobes[i], i, lanes);
        HWY_DYNAMIC_DISPATCH(scatter_lanes)(lanes);
        for (size_t i = 0; i < count; ++i) {
            take_view(*queries[i], lobes[i], i, lanes);
            take_sample(*queries[i], lobes[i], i, lanes);
            take_lights(*queries[i], i, lanes);
            queries[i]->answered = true;
        }
    }
};

}  // namespace

void sample_together(std::span<ScatterQuery> queries) {
    KnownQueries known;
    const auto answer = [&known] {
        if (known.count >= kLeastScatterLanes) known.answer();
        known.count = 0;
    };
    for (ScatterQuery& query : queries) {
        const KnownLobes lobes(*query.closures);
        if (!lobes.diffuse && !lobes.facets) continue;
        known.queries[known.count] = &query;
        known.lobes[known.count++] = lobes;
        if (known.count == ScatterLanes::kMost) answer();
    }
    answer();
}

}  // namespace rayleaf
#endif
