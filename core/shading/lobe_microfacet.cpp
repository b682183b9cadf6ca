#include "shading/lobe_microfacet.h"

#include "base/circle.h"
#include "shading/lobe_frame.h"
#include "shading/microfacet.h"
#include "shading/thin_film.h"

namespace rayleaf {
namespace {

Microfacets microfacets(const Lobe& lobe) {
    return {lobe.distribution, lobe.alpha_x, lobe.alpha_y};
}

/// Direction of the refracted ray about unit `normal` on the side of `outgoing`; empty under total reflection.
std::optional<Vec3f> refracted_direction(const Vec3f& outgoing, const Vec3f& normal, float ior) {
    const float cosine = normal.dot(outgoing);
    const float beyond2 = (ior - 1.0f) * (ior + 1.0f) + cosine * cosine;  // squared cosine beyond, times ior²
    if (!(cosine > 0.0f) || !(beyond2 > 0.0f)) return std::nullopt;
    return unit_or(normal * (cosine - std::sqrt(beyond2)) - outgoing, -outgoing);
}

/// Microfacets::spread2 of a direction of the world, and crossed2. A lobe that is as rough all around needs no frame.
float spread2(const Lobe& lobe, const Vec3f& w, float cosine) {
    const Microfacets facets = microfacets(lobe);
    return lobe.alpha_x == lobe.alpha_y ? facets.even_spread2(cosine) : facets.spread2(LobeFrame(lobe).to_local(w));
}
float crossed2(const Lobe& lobe, const Vec3f& h) {
    if (lobe.alpha_x == lobe.alpha_y) return lobe.alpha_x * lobe.alpha_x * lobe.normal.cross(h).length2();
    return microfacets(lobe).crossed2(LobeFrame(lobe).to_local(h));
}

/// A way that light takes at a facet: the probability with which sampling takes it, and what it has of the lobe's
/// weight, over that.
struct FacetWay {
    float probability = 0;
    Color share{0, 0, 0};
};
FacetWay way_at(const Lobe& lobe, Side side, float cosine, float glint = 1.0f) {
    const bool reflects = side == Side::Reflected;
    if (lobe.type != LobeType::Glass) return {1.0f, reflects ? reflectance(lobe, cosine) : transmittance(lobe, cosine)};
    const GlassShares shares = glass_shares(lobe, cosine, glint);
    const float probability = reflects ? shares.reflects : 1.0f - shares.reflects;
    if (!(probability > 0.0f)) return {};
    return {probability, (reflects ? shares.reflected : shares.refracted) / probability};
}

float fresnel_cosine(const Lobe& lobe, float at_normal, float at_facet) {
    return lobe.fresnel_at_normal ? at_normal : at_facet;
}

LobeValue evaluate_reflection(const Lobe& lobe, const LobeView& view, const DirectionPair& pair) {
    const float cosine = lobe.normal.dot(pair.incoming);
    if (!(cosine > 0.0f)) return {};
    const Microfacets facets = microfacets(lobe);
    const FacetWay way = way_at(lobe, Side::Reflected, fresnel_cosine(lobe, view.cosine, pair.cosine_half));
    const float density =
        facets.normal_density(lobe.normal.dot(pair.half), crossed2(lobe, pair.half)) * view.mirrored * way.probability;
    const float masking = facets.masking(cosine, spread2(lobe, pair.incoming, cosine));
    const float lit = Microfacets::shadowing(view.masking, masking, lobe.masking);
    return {lobe.weight * way.share * (density * lit), density};
}

LobeValue evaluate_refraction(const Lobe& lobe, const LobeView& view, const DirectionPair& pair) {
    const float cosine = -lobe.normal.dot(pair.incoming);
    if (!(cosine > 0.0f)) return {};
    Vec3f h = unit_or(pair.outgoing + pair.incoming * lobe.ior, lobe.normal);
    if (lobe.normal.dot(h) < 0.0f) h = -h;
    const float cos_o = pair.outgoing.dot(h), cos_i = pair.incoming.dot(h);
    if (!(cos_o > 0.0f) || !(cos_i < 0.0f)) return {};
    const Microfacets facets = microfacets(lobe);
    const float change = cos_o + lobe.ior * cos_i;
    const float jacobian = lobe.ior * lobe.ior * -cos_i / (change * change);  // Walter et al. 2007, equation 17
    const FacetWay way = way_at(lobe, Side::Transmitted, fresnel_cosine(lobe, view.cosine, cos_o));
    const float density = facets.normal_density(lobe.normal.dot(h), crossed2(lobe, h)) * view.mirrored *
                          (4.0f * cos_o) * jacobian * way.probability;
    const float masking = facets.masking(cosine, spread2(lobe, pair.incoming, cosine));
    const float lit = Microfacets::shadowing(view.masking, masking, lobe.masking);
    return {lobe.weight * way.share * (density * lit), density};
}

LobeValue evaluate_sheet(const Lobe& lobe, const LobeView& view, const DirectionPair& pair) {
    const Vec3f back = -mirrored(pair.incoming, lobe.normal);
    return evaluate_reflection(lobe, view, {pair.outgoing, back, Side::Reflected, true});
}

/// Singular glass, mirror or refraction about the lobe's own normal.
std::optional<LobeDirection> sample_singular(const Lobe& lobe, const LobeView& view, const Vec3f& outgoing,
                                             float random) {
    const float cosine = view.cosine;
    if (!(cosine > 0.0f)) return std::nullopt;
    const bool reflects = lobe.type == LobeType::Reflection ||
                          (lobe.type == LobeType::Glass && random < glass_shares(lobe, cosine, view.glint).reflects);
    LobeDirection result;
    result.weighed = true;
    result.side = reflects ? Side::Reflected : Side::Transmitted;
    result.weight = lobe.weight * way_at(lobe, result.side, cosine, view.glint).share;
    if (reflects) {
        result.direction = mirrored(outgoing, lobe.normal);
        return result;
    }
    if (lobe.type == LobeType::Sheet) {
        result.direction = -outgoing;
        return result;
    }
    const std::optional<Vec3f> direction = refracted_direction(outgoing, lobe.normal, lobe.ior);
    if (!direction) return std::nullopt;
    result.direction = *direction;
    result.eta = 1.0f / lobe.ior;
    return result;
}

/// Disney's fixed masking of the clearcoat, whatever the gloss.
constexpr Microfacets kClearcoatMasks{MicrofacetDistribution::Ggx, 0.25f, 0.25f};

/// The clearcoat's distribution of normals: generalized Trowbridge-Reitz with exponent 1 (Burley 2012, appendix B).
float clearcoat_normal_density(float alpha, const Vec3f& h) {
    const float alpha2 = alpha * alpha;
    if (alpha2 >= 1.0f) return 1.0f / kPi;
    const float spread = h.x * h.x + h.y * h.y + alpha2 * h.z * h.z;
    return (alpha2 - 1.0f) / (kPi * std::log(alpha2) * spread);
}

/// Of a lobe that is coloured where it is seen straight on: how much of that colour is left, as the film's reflectance
/// rises to 1.
Color tinted(const Lobe& lobe, const Color& reflected) {
    const float least = normal_fresnel(lobe.ior);
    if (lobe.fresnel != Lobe::Fresnel::Schlick || !(least > 0.0f) || !(least < 1.0f)) return reflected;
    Color result;
    for (int c = 0; c < 3; ++c) {
        const float rise = std::clamp((reflected[c] - least) / (1.0f - least), 0.0f, 1.0f);
        result[c] = reflected[c] * (lobe.fresnel_0[c] / least * (1.0f - rise) + rise);
    }
    return result;
}

/// What a film sends back, untinted.
Color filmed_reflectance(const Lobe& lobe, float cosine) {
    switch (lobe.fresnel) {
        case Lobe::Fresnel::None:
            return Color(1.0f);
        case Lobe::Fresnel::Metal:
            return film_on_metal(lobe.film, lobe.fresnel_0, lobe.radius, cosine);
        case Lobe::Fresnel::Conductor:
            return film_on_conductor(lobe.film, lobe.fresnel_0, lobe.radius, cosine);
        default:
            return film_on_dielectric(lobe.film, lobe.ior, cosine);
    }
}

}  // namespace

Color any_reflectance(const Lobe& lobe, float cosine) {
    if (lobe.film.thickness > 0.0f) return tinted(lobe, filmed_reflectance(lobe, cosine));
    if (lobe.type == LobeType::Glass || lobe.fresnel == Lobe::Fresnel::Dielectric)
        return Color(dielectric_fresnel(cosine, lobe.ior));
    if (lobe.fresnel == Lobe::Fresnel::Schlick) return coloured_fresnel(lobe.fresnel_0, lobe.ior, cosine);
    if (lobe.fresnel == Lobe::Fresnel::Metal) return metal_fresnel(lobe.fresnel_0, lobe.radius, cosine);
    if (lobe.fresnel == Lobe::Fresnel::Conductor) return conductor_fresnel(lobe.fresnel_0, lobe.radius, cosine);
    return Color(1.0f);
}

Color transmittance(const Lobe& lobe, float cosine) {
    if (lobe.film.thickness > 0.0f) return Color(1.0f) - filmed_reflectance(lobe, cosine);
    const bool fresnel = lobe.type == LobeType::Glass || lobe.fresnel != Lobe::Fresnel::None;
    return fresnel ? Color(1.0f) - reflectance(lobe, cosine) : Color(1.0f);
}

GlassShares glass_shares(const Lobe& lobe, float cosine, float glint) {
    const Color reflected = reflectance(lobe, cosine), refracted = (Color(1.0f) - reflected) * lobe.refracted;
    const float share = average(reflected), other = average(refracted);
    const float often = std::max(share, std::min(share * glint, other)), sum = often + other;
    return {reflected, refracted, sum > 0.0f ? often / sum : 1.0f};
}

void look_at_facets(const Lobe& lobe, const Vec3f& outgoing, LobeView& view) {
    const float cosine = view.cosine;
    if (is_singular(lobe) || !(cosine > 0.0f)) return;
    view.masking = lobe.type == LobeType::Clearcoat
                       ? kClearcoatMasks.masking(cosine, kClearcoatMasks.even_spread2(cosine))
                       : microfacets(lobe).masking(cosine, spread2(lobe, outgoing, cosine));
    view.mirrored = view.masking / (4.0f * cosine);
}

LobeValue evaluate_microfacet_lobe(const Lobe& lobe, const LobeView& view, const DirectionPair& pair) {
    if (!(view.mirrored > 0.0f)) return {};
    if (lobe.type == LobeType::Sheet)
        return pair.side == Side::Reflected ? LobeValue{} : evaluate_sheet(lobe, view, pair);
    if (pair.side == Side::Reflected)
        return lobe.type == LobeType::Refraction ? LobeValue{} : evaluate_reflection(lobe, view, pair);
    return lobe.type == LobeType::Reflection ? LobeValue{} : evaluate_refraction(lobe, view, pair);
}

std::optional<LobeDirection> sample_microfacet_lobe(const Lobe& lobe, const LobeView& view, const Vec3f& outgoing,
                                                    const Vec3f& random) {
    if (is_singular(lobe)) return sample_singular(lobe, view, outgoing, random.x);
    if (!(view.mirrored > 0.0f)) return std::nullopt;
    const LobeFrame frame(lobe);
    const Vec3f o = frame.to_local(outgoing);
    const Vec3f h = microfacets(lobe).sample_visible(o, Vec2f(random.x, random.y));
    LobeDirection result;
    if (lobe.type == LobeType::Reflection || lobe.type == LobeType::Sheet ||
        (lobe.type == LobeType::Glass &&
         random.z < glass_shares(lobe, fresnel_cosine(lobe, view.cosine, o.dot(h))).reflects)) {
        Vec3f i = mirrored(o, h);
        if (!(i.z > 0.0f)) return std::nullopt;
        if (lobe.type == LobeType::Sheet) {
            i.z = -i.z;
            result.side = Side::Transmitted;
        }
        result.direction = frame.to_world(i);
        return result;
    }
    const std::optional<Vec3f> i = refracted_direction(o, h, lobe.ior);
    if (!i || !(i->z < 0.0f)) return std::nullopt;
    result.direction = frame.to_world(*i);
    result.eta = 1.0f / lobe.ior;
    return result;
}

LobeDirection sample_entry(const Lobe& lobe, const LobeView& view, const Vec3f& outgoing, const Vec3f& random) {
    constexpr float kDiffuseShare = 0.5f;  // as Cycles
    const bool refracts =
        lobe.entry == EntryKind::Refracted || (lobe.entry == EntryKind::Either && random.z >= kDiffuseShare);
    const LobeFrame frame(lobe);
    LobeDirection result;
    result.side = Side::Transmitted;
    result.weight = lobe.weight;
    if (refracts && view.cosine > 0.0f) {
        const Vec3f o = frame.to_local(outgoing);
        const bool is_flat = lobe.alpha_x == 0.0f;
        const Vec3f h = is_flat ? Vec3f(0, 0, 1) : microfacets(lobe).sample_visible(o, Vec2f(random.x, random.y));
        const std::optional<Vec3f> i = refracted_direction(o, h, lobe.ior);
        if (i && i->z < 0.0f) {
            result.direction = frame.to_world(*i);
            return result;
        }
    }
    const Vec3f local = cosine_hemisphere(random.x, random.y);
    result.direction = frame.to_world({local.x, local.y, -local.z});
    return result;
}

LobeValue evaluate_clearcoat(const Lobe& lobe, const LobeView& view, const DirectionPair& pair) {
    if (pair.side == Side::Transmitted || !(view.mirrored > 0.0f)) return {};
    const LobeFrame frame(lobe);
    const Vec3f i = frame.to_local(pair.incoming);
    const Vec3f h = frame.to_local(pair.half);
    if (!(i.z > 0.0f) || !(h.z > 0.0f)) return {};
    const float facets = clearcoat_normal_density(lobe.alpha_x, h);
    const float value = facets * view.mirrored * kClearcoatMasks.masking(i);
    return {lobe.weight * reflectance(lobe, pair.cosine_half) * value, facets * h.z / (4.0f * pair.cosine_half)};
}

std::optional<LobeDirection> sample_clearcoat(const Lobe& lobe, const Vec3f& outgoing, const Vec3f& random) {
    const LobeFrame frame(lobe);
    const Vec3f o = frame.to_local(outgoing);
    const float alpha2 = lobe.alpha_x * lobe.alpha_x;
    const float cos2 = alpha2 >= 1.0f ? 1.0f - random.x : (1.0f - std::pow(alpha2, 1.0f - random.x)) / (1.0f - alpha2);
    const float cosine = std::sqrt(std::clamp(cos2, 0.0f, 1.0f)), sine = std::sqrt(std::clamp(1.0f - cos2, 0.0f, 1.0f));
    const Vec2f across = on_circle(random.y) * sine;
    const Vec3f h(across.x, across.y, cosine);
    const Vec3f i = mirrored(o, h);
    if (!(o.z > 0.0f) || !(o.dot(h) > 0.0f) || !(i.z > 0.0f)) return std::nullopt;
    return LobeDirection{frame.to_world(i)};
}

}  // namespace rayleaf
