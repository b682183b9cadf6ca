#include "shading/closures.h"

#include "shading/fresnel.h"
#include "shading/lobes.h"

#include <limits>
#include <memory>

namespace rayleaf {
namespace {

constexpr float kLeastLobeWeight = 1e-30f;  // what is chosen by less is divided by numbers that have no inverse
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

void mend_fibre(Lobe& lobe) {
    constexpr float kLeastWidth = 1e-7f, kGreatestWidth = 100.0f, kLeastFibreIndex = 1.001f;
    constexpr float kLeastWidthOfFacets = 1e-3f;  // as Cycles
    if (lobe.type == LobeType::HairFacets) {
        constexpr float kLeastRatio = 1e-3f, kMostOffsets = 64.0f;
        lobe.alpha_x = limited(lobe.alpha_x, kLeastWidthOfFacets, 1.0f);
        lobe.alpha_y = limited(lobe.alpha_y, 1.0f, kMostOffsets);
        lobe.roughness = limited(lobe.roughness, kLeastRatio, 1.0f);
        lobe.softness = limited(lobe.softness, 0.0f, 1.0f);
        if (!is_finite(lobe.radius)) lobe.radius = Color(0.0f);
    } else {
        lobe.alpha_x = limited(lobe.alpha_x, kLeastWidth, kGreatestWidth);
        lobe.alpha_y = limited(lobe.alpha_y, kLeastWidth, kGreatestWidth);
        lobe.roughness = limited(lobe.roughness, kLeastWidth, kGreatestWidth);
    }
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

/// Makes all its numbers such that can be computed with.
void mend(Lobe& lobe) {
    lobe.weight = positive(lobe.weight);
    lobe.fresnel_0 = positive(lobe.fresnel_0);
    lobe.refracted = positive(lobe.refracted);
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
           a.by_profile == b.by_profile && a.is_reduced == b.is_reduced && a.entry == b.entry &&
           a.fresnel == b.fresnel && a.radius == b.radius && a.refracted == b.refracted && a.across == b.across &&
           a.tilt == b.tilt && a.film == b.film;
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

}  // namespace

Closures& Closures::operator=(const Closures& other) {
    if (this == &other) return *this;
    emission = other.emission;
    transparency = other.transparency;
    portal = other.portal;
    holdout = other.holdout;
    smooth_normal = other.smooth_normal;
    bump_shadow = other.bump_shadow;
    clearing = other.clearing;
    aovs = other.aovs;
    medium = other.medium;
    count_ = other.count_;
    std::uninitialized_copy_n(other.lobes_, count_, lobes_);
    return *this;
}

void Closures::clear() {
    emission = transparency = portal.weight = Color(0.0f);
    holdout = 0.0f;
    medium.clear();
    count_ = 0;
}

void Closures::add(const Lobe& lobe) {
    Lobe clean = lobe;
    mend(clean);
    if (!(max_component(clean.weight) > kLeastLobeWeight)) return;
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

void Closures::add(const Portal& another) {
    const bool is_sound = is_finite(another.weight) && is_finite(another.position) && is_finite(another.direction) &&
                          max_component(another.weight) > kLeastLobeWeight;
    if (!is_sound) return;
    const Color sum = portal.weight + another.weight;
    if (average(another.weight) >= average(portal.weight)) portal = another;
    portal.weight = sum;
}

void Closures::take_turned(const Closures& other, const Vec3f& normal) {
    emission = other.emission;
    transparency = other.transparency;
    portal.weight = Color(0.0f);  // nothing that has one is turned
    holdout = other.holdout;
    medium.clear();
    count_ = other.count_;
    const Vec3f tangent = any_tangent(normal);
    for (int i = 0; i < count_; ++i) {
        std::construct_at(&lobes_[i], other.lobes_[i]);
        lobes_[i].normal = normal;
        lobes_[i].tangent = tangent;
    }
}

void Closures::widen(float alpha) {
    for (int i = 0; i < count_; ++i) {
        Lobe& lobe = lobes_[i];
        const bool is_strand = lobe.type == LobeType::HairFibre || lobe.type == LobeType::HairFacets;
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
        if ((lobe.type == LobeType::Refraction || lobe.type == LobeType::Sheet) && refractive) continue;
        if (lobe.type == LobeType::Glass && (reflective || refractive)) {
            if (reflective && refractive) continue;
            lobe.type = reflective ? LobeType::Refraction : LobeType::Reflection;
            lobe.kind = reflective ? LobeKind::Transmission : LobeKind::Glossy;
            if (lobe.fresnel == Lobe::Fresnel::None) lobe.fresnel = Lobe::Fresnel::Dielectric;
            if (reflective) lobe.weight = lobe.weight * lobe.refracted;
            lobe.refracted = Color(1.0f);
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

bool Closures::needs_third_number() const {
    return std::any_of(lobes_, lobes_ + count_, [](const Lobe& lobe) {
        return lobe.type == LobeType::HairFibre || lobe.type == LobeType::HairFacets ||
               (lobe.type == LobeType::Glass && !is_singular(lobe)) ||
               (lobe.type == LobeType::Subsurface && lobe.entry == EntryKind::Either);
    });
}

Vec3f Closures::lit_side() const {
    Vec3f side(0.0f);
    for (int i = 0; i < count_; ++i) {
        const Lobe& lobe = lobes_[i];
        if (!takes_light(lobe)) continue;
        const bool passes_on = lobe.type == LobeType::Sheet || lobe.type == LobeType::Translucent;
        if (refracts(lobe) || is_fibre(lobe) || passes_on) return Vec3f(0.0f);
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
