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

/// Share of samples that a glass facet reflects.
float reflection_share(const Lobe& lobe, float cosine) {
    return lobe.type == LobeType::Glass ? dielectric_fresnel(cosine, lobe.ior) : 1.0f;
}

/// Direction of the refracted ray about unit `normal` on the side of `outgoing`; empty under total reflection.
std::optional<Vec3f> refracted_direction(const Vec3f& outgoing, const Vec3f& normal, float ior) {
    const float cosine = normal.dot(outgoing);
    const float beyond2 = (ior - 1.0f) * (ior + 1.0f) + cosine * cosine;  // squared cosine beyond, times ior²
    if (!(cosine > 0.0f) || !(beyond2 > 0.0f)) return std::nullopt;
    const Vec3f direction = (normal * (cosine - std::sqrt(beyond2)) - outgoing) / ior;
    return normalized_or(direction, -outgoing);
}

Vec3f mirrored(const Vec3f& outgoing, const Vec3f& normal) {
    return normal * (2.0f * normal.dot(outgoing)) - outgoing;
}

LobeValue evaluate_reflection(const Lobe& lobe, const LobeView& view, const DirectionPair& pair) {
    const LobeFrame frame(lobe);
    const Vec3f i = frame.to_local(pair.incoming);
    if (!(i.z > 0.0f)) return {};
    const Microfacets facets = microfacets(lobe);
    const float density = facets.normal_density(frame.to_local(pair.half)) * view.mirrored;
    const float lit = facets.shadowing(view.masking, i, lobe.masking);
    return {lobe.weight * reflectance(lobe, pair.cosine_half) * (density * lit),
            density * reflection_share(lobe, pair.cosine_half)};
}

LobeValue evaluate_refraction(const Lobe& lobe, const LobeView& view, const DirectionPair& pair) {
    const LobeFrame frame(lobe);
    const Vec3f o = frame.to_local(pair.outgoing), i = frame.to_local(pair.incoming);
    if (!(i.z < 0.0f)) return {};
    const Microfacets facets = microfacets(lobe);
    Vec3f h = normalized_or(o + i * lobe.ior, Vec3f(0.0f, 0.0f, 1.0f));
    if (h.z < 0.0f) h = -h;
    const float cos_o = o.dot(h), cos_i = i.dot(h);
    if (!(cos_o > 0.0f) || !(cos_i < 0.0f)) return {};
    const float change = cos_o + lobe.ior * cos_i;
    const float jacobian = lobe.ior * lobe.ior * -cos_i / (change * change);  // Walter et al. 2007, equation 17
    const float density = facets.normal_density(h) * view.mirrored * (4.0f * cos_o) * jacobian;
    const float share = 1.0f - (lobe.type == LobeType::Glass ? reflection_share(lobe, cos_o) : 0.0f);
    const float lit = facets.shadowing(view.masking, Vec3f(i.x, i.y, -i.z), lobe.masking);
    return {lobe.weight * transmittance(lobe, cos_o) * (density * lit), density * share};
}

/// Singular glass, mirror or refraction about the lobe's own normal.
std::optional<LobeDirection> sample_singular(const Lobe& lobe, const Vec3f& outgoing, float random) {
    const float cosine = lobe.normal.dot(outgoing);
    if (!(cosine > 0.0f)) return std::nullopt;
    const bool reflects =
        lobe.type == LobeType::Reflection || (lobe.type == LobeType::Glass && random < reflection_share(lobe, cosine));
    if (reflects) {
        const Color value = lobe.type == LobeType::Glass ? Color(1.0f) : reflectance(lobe, cosine);
        return LobeDirection{mirrored(outgoing, lobe.normal), lobe.weight * value, 1.0f};
    }
    const std::optional<Vec3f> direction = refracted_direction(outgoing, lobe.normal, lobe.ior);
    if (!direction) return std::nullopt;
    const Color value = lobe.type == LobeType::Glass ? Color(1.0f) : transmittance(lobe, cosine);
    return LobeDirection{*direction, lobe.weight * value, 1.0f / lobe.ior};
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

void look_at_facets(const Lobe& lobe, const Vec3f& outgoing, LobeView& view) {
    if (is_singular(lobe) || !(view.cosine > 0.0f)) return;
    const Vec3f o = LobeFrame(lobe).to_local(outgoing);
    view.masking = lobe.type == LobeType::Clearcoat ? kClearcoatMasks.masking(o) : microfacets(lobe).masking(o);
    view.mirrored = view.masking / (4.0f * o.z);
}

LobeValue evaluate_microfacet_lobe(const Lobe& lobe, const LobeView& view, const DirectionPair& pair) {
    if (!(view.mirrored > 0.0f)) return {};
    if (pair.side == Side::Reflected)
        return lobe.type == LobeType::Refraction ? LobeValue{} : evaluate_reflection(lobe, view, pair);
    return lobe.type == LobeType::Reflection ? LobeValue{} : evaluate_refraction(lobe, view, pair);
}

std::optional<LobeDirection> sample_microfacet_lobe(const Lobe& lobe, const Vec3f& outgoing, const Vec3f& random) {
    if (is_singular(lobe)) return sample_singular(lobe, outgoing, random.x);
    const LobeFrame frame(lobe);
    const Vec3f o = frame.to_local(outgoing);
    if (!(o.z > 0.0f)) return std::nullopt;
    const Vec3f h = microfacets(lobe).sample_visible(o, Vec2f(random.x, random.y));
    const bool reflects = lobe.type == LobeType::Reflection ||
                          (lobe.type == LobeType::Glass && random.z < reflection_share(lobe, o.dot(h)));
    if (reflects) {
        const Vec3f i = mirrored(o, h);
        if (!(i.z > 0.0f)) return std::nullopt;
        return LobeDirection{frame.to_world(i), Color(0.0f), 1.0f};
    }
    const std::optional<Vec3f> i = refracted_direction(o, h, lobe.ior);
    if (!i || !(i->z < 0.0f)) return std::nullopt;
    return LobeDirection{frame.to_world(*i), Color(0.0f), 1.0f / lobe.ior};
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
    return LobeDirection{frame.to_world(i), Color(0.0f), 1.0f};
}

}  // namespace rayleaf
