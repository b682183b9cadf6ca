#include "shading/closures.h"

#include "shading/fresnel.h"
#include "shading/lobes.h"

#include <limits>
#include <memory>

namespace rayleaf {
namespace {

/// Below this product of the two roughnesses a lobe is singular (Cycles' limit; float cannot resolve narrower ones).
constexpr float kSingularAlphaProduct = 1e-7f;
/// The narrower direction of a lobe that is not singular.
constexpr float kLeastLobeAlpha = 1e-4f;
constexpr float kLeastIndex = 1e-5f, kLargestIndex = 1e5f;
/// Nanometres; light does not interfere in thicker ones.
constexpr float kThickestFilm = 1e6f;
/// Largest factor a lobe may have; what is larger is a mistake that would overflow.
constexpr float kLargestWeight = 1e10f;

/// NaN and negative values to 0.
float positive(float x) {
    return x > 0.0f ? std::min(x, kLargestWeight) : 0.0f;
}
Color positive(const Color& c) {
    return {positive(c.x), positive(c.y), positive(c.z)};
}
/// NaN to `least`.
float limited(float x, float least, float most) {
    return x > least ? std::min(x, most) : least;
}

bool refracts(const Lobe& lobe) {
    return lobe.type == LobeType::Refraction || lobe.type == LobeType::Glass;
}

void mend_fibre(Lobe& lobe) {
    constexpr float kLeastWidth = 1e-7f, kGreatestWidth = 100.0f, kLeastFibreIndex = 1.001f;
    lobe.alpha_x = limited(lobe.alpha_x, kLeastWidth, kGreatestWidth);
    lobe.alpha_y = limited(lobe.alpha_y, kLeastWidth, kGreatestWidth);
    lobe.roughness = limited(lobe.roughness, kLeastWidth, kGreatestWidth);
    lobe.ior = limited(lobe.ior, kLeastFibreIndex, kLargestIndex);
    lobe.across = limited(lobe.across, -1.0f, 1.0f);
    lobe.tilt = std::isfinite(lobe.tilt) ? lobe.tilt : 0.0f;
    lobe.tangent = normalized_or(lobe.tangent, Vec3f(0, 0, 1));
}

void mend_microfibres(Lobe& lobe) {
    constexpr float kLeastNarrowing = 1e-3f, kMostNarrowing = 1e3f, kMostSkew = 1e3f;
    lobe.alpha_x = limited(lobe.alpha_x, kLeastNarrowing, kMostNarrowing);
    lobe.alpha_y = limited(lobe.alpha_y, -kMostSkew, kMostSkew);
}

Vec3f any_tangent(const Vec3f& normal) {
    Vec3f tangent, bitangent;
    orthonormal_basis(normal, tangent, bitangent);
    return tangent;
}

void make_tangent_orthogonal(Lobe& lobe) {
    const Vec3f along = lobe.tangent - lobe.normal * lobe.normal.dot(lobe.tangent);
    lobe.tangent = normalized_or(along, any_tangent(lobe.normal));
}

/// An interface that light passes without being bent.
bool is_unbent(const Lobe& lobe) {
    return refracts(lobe) && std::abs(lobe.ior - 1.0f) < kLeastIndexStep;
}

/// Whether the lobe is of microfacets.
bool has_facets(const Lobe& lobe) {
    return refracts(lobe) || lobe.type == LobeType::Reflection || lobe.type == LobeType::Clearcoat;
}

/// Makes all its numbers such that can be computed with.
void mend(Lobe& lobe) {
    lobe.weight = positive(lobe.weight);
    lobe.fresnel_0 = positive(lobe.fresnel_0);
    if (is_fibre(lobe)) return mend_fibre(lobe);
    if (lobe.type == LobeType::Microfibres) {
        mend_microfibres(lobe);
        return make_tangent_orthogonal(lobe);
    }
    lobe.radius = positive(lobe.radius);
    lobe.roughness = limited(lobe.roughness, 0.0f, 1.0f);
    lobe.softness = limited(lobe.softness, 0.0f, 1.0f);
    lobe.ior = limited(lobe.ior, kLeastIndex, kLargestIndex);
    lobe.film.thickness = limited(lobe.film.thickness, 0.0f, kThickestFilm);
    lobe.film.ior = limited(lobe.film.ior, kLeastIndex, kLargestIndex);
    lobe.alpha_x = limited(lobe.alpha_x, 0.0f, 1.0f);
    lobe.alpha_y = limited(lobe.alpha_y, 0.0f, 1.0f);
    if (is_unbent(lobe) || lobe.alpha_x * lobe.alpha_y <= kSingularAlphaProduct) {
        lobe.alpha_x = lobe.alpha_y = 0.0f;
        if (lobe.type == LobeType::Clearcoat) lobe.type = LobeType::Reflection;
    } else {
        lobe.alpha_x = std::max(lobe.alpha_x, kLeastLobeAlpha);
        lobe.alpha_y = std::max(lobe.alpha_y, kLeastLobeAlpha);
    }
    if (lobe.alpha_x == lobe.alpha_y)
        lobe.tangent = any_tangent(lobe.normal);
    else
        make_tangent_orthogonal(lobe);
}

bool differ_in_weight_alone(const Lobe& a, const Lobe& b) {
    return a.type == b.type && a.kind == b.kind && a.distribution == b.distribution && a.normal == b.normal &&
           a.tangent == b.tangent && a.alpha_x == b.alpha_x && a.alpha_y == b.alpha_y && a.ior == b.ior &&
           a.roughness == b.roughness && a.softness == b.softness && a.fresnel_0 == b.fresnel_0 &&
           a.masking == b.masking && a.stays_sharp == b.stays_sharp && a.in_front == b.in_front &&
           a.fresnel == b.fresnel && a.radius == b.radius && a.across == b.across && a.tilt == b.tilt &&
           a.film == b.film;
}

/// How far two lobes are from each other; infinite for those that nothing makes alike: of two types, or a mirror and
/// what spreads. There are fewer such classes than lobes, so some two of too many are alike.
float difference(const Lobe& a, const Lobe& b) {
    if (a.type != b.type || is_singular(a) != is_singular(b)) return std::numeric_limits<float>::infinity();
    const bool same_family =
        a.kind == b.kind && a.fresnel == b.fresnel && a.distribution == b.distribution && a.masking == b.masking;
    constexpr float kOtherFamily = 100.0f;
    const float alphas = std::abs(a.alpha_x - b.alpha_x) + std::abs(a.alpha_y - b.alpha_y);
    return (same_family ? 0.0f : kOtherFamily) + (a.normal - b.normal).length() + alphas +
           std::min(std::abs(a.ior - b.ior), 1.0f) + std::abs(a.roughness - b.roughness) +
           std::abs(a.softness - b.softness) + std::min((a.fresnel_0 - b.fresnel_0).length(), 1.0f);
}

/// The heavier of two, with the weight of both.
Lobe joined(const Lobe& a, const Lobe& b) {
    Lobe result = b.weight.length2() > a.weight.length2() ? b : a;
    result.weight = a.weight + b.weight;
    return result;
}

/// Whether sampled lights can light it.
bool takes_light(const Lobe& lobe) {
    return !is_singular(lobe) && lobe.type != LobeType::Subsurface;
}

Side side_of(const Vec3f& outgoing, const Vec3f& incoming, const Vec3f& facet_normal) {
    const bool same = (facet_normal.dot(outgoing) > 0.0f) == (facet_normal.dot(incoming) > 0.0f);
    return same ? Side::Reflected : Side::Transmitted;
}

/// Probabilities with which `sample` chooses each lobe.
struct Choice {
    float probability[Closures::kMaxLobes] = {};
    bool any = false;

    Choice(const Closures& closures, const Vec3f& outgoing) {
        const int count = closures.size();
        if (count == 1) {
            probability[0] = 1.0f;
            any = choice_weight(closures[0], outgoing) > 0.0f;
            return;
        }
        float sum = 0.0f;
        for (int i = 0; i < count; ++i) sum += probability[i] = choice_weight(closures[i], outgoing);
        any = sum > 0.0f;
        const float scale = any ? 1.0f / sum : 0.0f;
        for (int i = 0; i < count; ++i) probability[i] *= scale;
    }
};

Closures::Evaluation evaluate_all(const Closures& closures, const Choice& choice, const Vec3f& outgoing,
                                  const Vec3f& incoming, Side side) {
    Closures::Evaluation sum;
    for (int i = 0; i < closures.size(); ++i) {
        const LobeValue lobe = closures.evaluate_one(i, outgoing, incoming, side);
        sum.value += lobe.value;
        sum.density += choice.probability[i] * lobe.density;
    }
    return sum;
}

}  // namespace

Closures& Closures::operator=(const Closures& other) {
    if (this == &other) return *this;
    emission = other.emission;
    transparency = other.transparency;
    holdout = other.holdout;
    smooth_normal = other.smooth_normal;
    aovs = other.aovs;
    medium = other.medium;
    count_ = other.count_;
    std::uninitialized_copy_n(other.lobes_, count_, lobes_);
    return *this;
}

void Closures::clear() {
    emission = transparency = Color(0.0f);
    holdout = 0.0f;
    medium.clear();
    count_ = 0;
}

void Closures::add(const Lobe& lobe) {
    Lobe clean = lobe;
    mend(clean);
    if (is_black(clean.weight)) return;
    for (int i = 0; i < count_; ++i) {
        if (!differ_in_weight_alone(lobes_[i], clean)) continue;
        lobes_[i].weight += clean.weight;
        return;
    }
    if (count_ == kMaxLobes)
        join_most_alike(clean);
    else
        std::construct_at(&lobes_[count_++], clean);
}

void Closures::take_turned(const Closures& other, const Vec3f& normal) {
    const std::span<Vec4f> slots = aovs;
    *this = other;
    aovs = slots;
    const Vec3f tangent = any_tangent(normal);
    for (int i = 0; i < count_; ++i) {
        lobes_[i].normal = normal;
        lobes_[i].tangent = tangent;
    }
}

void Closures::widen(float alpha) {
    for (int i = 0; i < count_; ++i) {
        Lobe& lobe = lobes_[i];
        const bool is_strand = lobe.type == LobeType::HairFibre;
        if (!is_strand && (!has_facets(lobe) || lobe.stays_sharp || is_unbent(lobe))) continue;
        lobe.alpha_x = std::max(lobe.alpha_x, alpha);
        lobe.alpha_y = std::max(lobe.alpha_y, alpha);
        if (is_strand) lobe.roughness = std::max(lobe.roughness, alpha);
    }
}

void Closures::drop_caustics(bool reflective, bool refractive) {
    int kept = 0;
    for (int i = 0; i < count_; ++i) {
        Lobe lobe = lobes_[i];
        const bool reflects_alone =
            lobe.type == LobeType::Reflection || lobe.type == LobeType::Clearcoat || lobe.type == LobeType::ToonGlossy;
        if (reflects_alone && reflective) continue;
        if (lobe.type == LobeType::Refraction && refractive) continue;
        if (lobe.type == LobeType::Glass && (reflective || refractive)) {
            if (reflective && refractive) continue;
            lobe.type = reflective ? LobeType::Refraction : LobeType::Reflection;
            lobe.kind = reflective ? LobeKind::Transmission : LobeKind::Glossy;
            lobe.fresnel = Lobe::Fresnel::Dielectric;
        }
        lobes_[kept++] = lobe;
    }
    count_ = kept;
}

/// Of the lobes and one more.
void Closures::join_most_alike(const Lobe& lobe) {
    const auto at = [&](int i) -> const Lobe& { return i < kMaxLobes ? lobes_[i] : lobe; };
    int first = 0, second = kMaxLobes;
    for (int i = 0; i < kMaxLobes; ++i)
        for (int j = i + 1; j <= kMaxLobes; ++j)
            if (difference(at(i), at(j)) < difference(at(first), at(second))) {
                first = i;
                second = j;
            }
    lobes_[first] = joined(at(first), at(second));
    if (second < kMaxLobes) lobes_[second] = lobe;
}

LobeValue Closures::evaluate_one(int i, const Vec3f& outgoing, const Vec3f& incoming, Side side) const {
    const Lobe& lobe = lobes_[i];
    LobeValue result = evaluate_lobe(lobe, outgoing, incoming, side);
    if (lobe.normal != smooth_normal && is_shadowed_where_bent(lobe) && !is_black(smooth_normal))
        result.value *= bump_shadow(smooth_normal, lobe.normal, incoming);
    return result;
}

Color Closures::evaluate(const Vec3f& outgoing, const Vec3f& incoming, const Vec3f& facet_normal) const {
    const Side side = side_of(outgoing, incoming, facet_normal);
    Color sum(0.0f);
    for (int i = 0; i < count_; ++i) sum += evaluate_one(i, outgoing, incoming, side).value;
    return sum;
}

Color Closures::evaluate(const Vec3f& outgoing, const Vec3f& incoming, const Vec3f& facet_normal, LobeKind kind) const {
    const Side side = side_of(outgoing, incoming, facet_normal);
    Color sum(0.0f);
    for (int i = 0; i < count_; ++i)
        if (kind_of(lobes_[i], side) == kind) sum += evaluate_one(i, outgoing, incoming, side).value;
    return sum;
}

Closures::Evaluation Closures::evaluate_with_density(const Vec3f& outgoing, const Vec3f& incoming,
                                                     const Vec3f& facet_normal) const {
    return evaluate_all(*this, Choice(*this, outgoing), outgoing, incoming, side_of(outgoing, incoming, facet_normal));
}

Closures::EvaluationByKind Closures::evaluate_by_kind(const Vec3f& outgoing, const Vec3f& incoming,
                                                      const Vec3f& facet_normal) const {
    const Side side = side_of(outgoing, incoming, facet_normal);
    const Choice choice(*this, outgoing);
    EvaluationByKind sum;
    for (int i = 0; i < count_; ++i) {
        const LobeValue lobe = evaluate_one(i, outgoing, incoming, side);
        sum.values[static_cast<size_t>(kind_of(lobes_[i], side))] += lobe.value;
        sum.density += choice.probability[i] * lobe.density;
    }
    return sum;
}

float Closures::density(const Vec3f& outgoing, const Vec3f& incoming, const Vec3f& facet_normal) const {
    return evaluate_with_density(outgoing, incoming, facet_normal).density;
}

std::optional<LobeSample> Closures::sample(const Vec3f& outgoing, const Vec3f& facet_normal,
                                           const Vec3f& random) const {
    const Choice choice(*this, outgoing);
    if (!choice.any) return std::nullopt;
    int chosen = 0;
    float rest = random.x;
    while (chosen + 1 < count_ && rest >= choice.probability[chosen]) rest -= choice.probability[chosen++];
    const float probability = choice.probability[chosen];
    if (!(probability > 0.0f)) return std::nullopt;
    constexpr float kBelowOne = 1.0f - 6e-8f;
    const Vec3f reused(std::min(rest / probability, kBelowOne), random.y, random.z);

    const Lobe& lobe = lobes_[chosen];
    const std::optional<LobeDirection> direction = sample_lobe(lobe, outgoing, reused);
    if (!direction) return std::nullopt;
    const Side side = side_of(outgoing, direction->direction, facet_normal);
    LobeSample sample;
    sample.direction = direction->direction;
    sample.kind = kind_of(lobe, side);
    sample.singular = is_singular(lobe);
    sample.transmitted = side == Side::Transmitted;
    sample.eta = direction->eta;
    sample.roughness = lobe_width(lobe);
    sample.fibre = is_fibre(lobe);
    if (sample.fibre) sample.transmitted = direction->through;
    if (lobe.type == LobeType::Subsurface) {
        sample.subsurface = &lobe;
        const float darkening =
            lobe.fresnel == Lobe::Fresnel::Schlick ? 1.0f - 0.5f * schlick_weight(lobe.normal.dot(outgoing)) : 1.0f;
        sample.weight = lobe.weight * (darkening / probability);
    } else if (sample.singular) {
        // A shading normal bent far from the facet may send the ray to the wrong side.
        if (sample.transmitted != (lobe.normal.dot(direction->direction) < 0.0f)) return std::nullopt;
        sample.weight = direction->weight / probability;
    } else {
        const Evaluation all = evaluate_all(*this, choice, outgoing, direction->direction, side);
        if (!(all.density > 0.0f)) return std::nullopt;
        sample.density = all.density;
        sample.weight = all.value / all.density;
    }
    if (is_black(sample.weight) || !is_finite(sample.weight)) return std::nullopt;
    return sample;
}

bool Closures::needs_third_number() const {
    return std::any_of(lobes_, lobes_ + count_, [](const Lobe& lobe) {
        return lobe.type == LobeType::HairFibre || (lobe.type == LobeType::Glass && !is_singular(lobe));
    });
}

Vec3f Closures::lit_side() const {
    Vec3f side(0.0f);
    for (int i = 0; i < count_; ++i) {
        const Lobe& lobe = lobes_[i];
        if (!takes_light(lobe)) continue;
        if (refracts(lobe) || is_fibre(lobe) || lobe.type == LobeType::Translucent) return Vec3f(0.0f);
        if (side == Vec3f(0.0f)) side = lobe.normal;
    }
    return side;
}

bool Closures::has_smooth_lobes() const {
    return std::any_of(lobes_, lobes_ + count_, takes_light);
}

Color Closures::albedo(const Vec3f& outgoing, LobeKind kind) const {
    Color sum(0.0f);
    for (int i = 0; i < count_; ++i) sum += lobe_albedo(lobes_[i], outgoing, kind);
    return sum;
}

}  // namespace rayleaf
