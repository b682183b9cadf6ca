#include "shading/lobes.h"

#include "shading/lobe_diffuse.h"
#include "shading/lobe_fibre.h"
#include "shading/lobe_hair_facets.h"
#include "shading/lobe_microfacet.h"
#include "shading/lobe_microfibres.h"
#include "shading/lobe_toon.h"

namespace rayleaf {
namespace {

/// `g`: the light's cosine at the smooth normal, over its cosine at the bent one and that between the two normals.
float shadow_by_cubic(float g) {
    return g < 1.0f ? g * (1.0f + g * (1.0f - g)) : 1.0f;
}

/// By the cosines, positive, of the light and of the bump at the smooth surface.
float shadow_of_facets(float light, float bump) {
    if (!(light < 1.0f) || !(bump < 1.0f)) return 1.0f;
    const float alpha2 = std::min(0.125f * (1.0f / (bump * bump) - 1.0f), 1.0f);
    const float tangent2 = 1.0f / (light * light) - 1.0f;
    return 2.0f / (1.0f + std::sqrt(1.0f + alpha2 * tangent2));
}

}  // namespace

float bump_shadow(BumpShadow kind, const Vec3f& smooth, const Vec3f& bent, const Vec3f& incoming) {
    const float light = smooth.dot(incoming), bump = smooth.dot(bent), product = bent.dot(incoming) * bump;
    const float g = product != 0.0f ? light / product : 0.0f;
    if (!(g > 0.0f)) return 0.0f;
    return kind == BumpShadow::Facets ? shadow_of_facets(std::abs(light), std::abs(bump)) : shadow_by_cubic(g);
}

LobeValue evaluate_lobe(const Lobe& lobe, const LobeView& view, const DirectionPair& pair) {
    switch (lobe.type) {
        case LobeType::Reflection:
        case LobeType::Refraction:
        case LobeType::Glass:
        case LobeType::Sheet:
            return evaluate_microfacet_lobe(lobe, view, pair);
        case LobeType::Clearcoat:
            return evaluate_clearcoat(lobe, view, pair);
        case LobeType::ToonDiffuse:
        case LobeType::ToonGlossy:
            return evaluate_toon_lobe(lobe, pair.outgoing, pair.incoming, pair.side);
        case LobeType::HairReflection:
        case LobeType::HairTransmission:
        case LobeType::HairFibre:
            return evaluate_fibre_lobe(lobe, pair.outgoing, pair.incoming, pair.side);
        case LobeType::HairFacets:
            return evaluate_hair_facets(lobe, pair.outgoing, pair.incoming);
        case LobeType::Microfibres:
            return evaluate_microfibres(lobe, pair.incoming, pair.side);
        case LobeType::Subsurface:
            return {};
        default:
            return evaluate_diffuse_lobe(lobe, view, pair);
    }
}

std::optional<LobeDirection> sample_lobe(const Lobe& lobe, const LobeView& view, const Vec3f& outgoing,
                                         const Vec3f& random) {
    switch (lobe.type) {
        case LobeType::Reflection:
        case LobeType::Refraction:
        case LobeType::Glass:
        case LobeType::Sheet:
            return sample_microfacet_lobe(lobe, view, outgoing, random);
        case LobeType::Clearcoat:
            return sample_clearcoat(lobe, outgoing, random);
        case LobeType::ToonDiffuse:
        case LobeType::ToonGlossy:
            return sample_toon_lobe(lobe, outgoing, random);
        case LobeType::HairReflection:
        case LobeType::HairTransmission:
        case LobeType::HairFibre:
            return sample_fibre_lobe(lobe, outgoing, random);
        case LobeType::HairFacets:
            return sample_hair_facets(lobe, outgoing, random);
        case LobeType::Microfibres:
            return sample_microfibres(lobe, random);
        case LobeType::Subsurface:
            return sample_entry(lobe, view, outgoing, random);
        default:
            return sample_diffuse_lobe(lobe, view, outgoing, random);
    }
}

namespace {

/// Whether a lobe of a bent normal is darkened by `bump_shadow`: those that are as wide as the hemisphere, but for
/// velvet, as in Cycles.
bool is_shadowed_where_bent(const Lobe& lobe) {
    switch (lobe.type) {
        case LobeType::Diffuse:
        case LobeType::Translucent:
        case LobeType::Sheen:
        case LobeType::Microfibres:
        case LobeType::ToonDiffuse:
        case LobeType::PrincipledDiffuse:
        case LobeType::RetroReflection:
        case LobeType::LambertExit:
            return true;
        default:
            return false;
    }
}

}  // namespace

bool is_bent(const Lobe& lobe, const Closures& of) {
    return of.bump_shadow != BumpShadow::None && lobe.normal != of.smooth_normal && !is_black(of.smooth_normal) &&
           is_shadowed_where_bent(lobe);
}

namespace {

/// What a facet at the normal makes of light, before the weight.
Color seen_at_normal(const Lobe& lobe, float cosine) {
    if (lobe.type == LobeType::Refraction) return transmittance(lobe, cosine);
    if (lobe.type != LobeType::Glass) return reflectance(lobe, cosine);
    const GlassShares shares = glass_shares(lobe, cosine);
    return shares.reflected + shares.refracted;
}

}  // namespace

float choice_weight(const Lobe& lobe, float cosine) {
    const float mean = average(lobe.weight);
    // The root of the mean square over directions that a cosine chooses: of what these two reflect, most is at grazing.
    if (lobe.type == LobeType::RetroReflection) return mean * lobe.roughness * (0.14f + 1.05f * schlick_weight(cosine));
    if (lobe.type == LobeType::Sheen) {
        const float away = 1.0f - std::clamp(cosine, 0.0f, 1.0f);
        return mean * (0.001f + 0.23f * away * away);
    }
    if (lobe.type == LobeType::Subsurface || lobe.fresnel == Lobe::Fresnel::None) return mean;
    const float share = average(seen_at_normal(lobe, cosine));
    // Facets of a rough surface tilt, so their Fresnel factor may be far from that at the normal.
    constexpr float kLeastShare = 0.05f;
    return mean * (is_singular(lobe) ? share : std::max(share, kLeastShare));
}

float glint_weight(const Lobe& lobe, const LobeView& view) {
    if (view.glint == 1.0f) return 0.0f;
    return (view.glint - 1.0f) * average(lobe.weight) * average(reflectance(lobe, view.cosine));
}

void look_at(const Lobe& lobe, const Vec3f& outgoing, LobeView& view) {
    view.cosine = lobe.normal.dot(outgoing);
    view.masking = view.mirrored = 0.0f;
    view.glint = 1.0f;
    view.bent = false;
    if (has_facets(lobe)) look_at_facets(lobe, outgoing, view);
}

LobeKind kind_of(const Lobe& lobe, Side side) {
    if (lobe.type != LobeType::Glass) return lobe.kind;
    return side == Side::Reflected ? LobeKind::Glossy : LobeKind::Transmission;
}

LobeKind kind_of_ray(const Lobe& lobe, Side side) {
    return lobe.type == LobeType::Velvet ? LobeKind::Diffuse : kind_of(lobe, side);
}

Color lobe_albedo(const Lobe& lobe, const Vec3f& outgoing, LobeKind kind) {
    const float cosine = lobe.normal.dot(outgoing);
    if (lobe.type == LobeType::Glass) {
        if (kind == LobeKind::Diffuse) return Color(0.0f);
        const GlassShares shares = glass_shares(lobe, cosine);
        return lobe.weight * (kind == LobeKind::Glossy ? shares.reflected : shares.refracted);
    }
    if (lobe.kind != kind) return Color(0.0f);
    if (lobe.type == LobeType::Subsurface) return lobe.weight;
    if (lobe.type == LobeType::HairFacets) return hair_facets_albedo(lobe, outgoing);
    if (is_fibre(lobe)) return fibre_albedo(lobe);
    if (lobe.type == LobeType::Refraction) return lobe.weight * transmittance(lobe, cosine);
    return lobe.weight * reflectance(lobe, cosine);
}

float lobe_width(const Lobe& lobe) {
    switch (lobe.type) {
        case LobeType::Reflection:
        case LobeType::Refraction:
        case LobeType::Glass:
        case LobeType::Sheet:
        case LobeType::Clearcoat:
            return std::min(std::sqrt(std::max(lobe.alpha_x, lobe.alpha_y)), 1.0f);
        case LobeType::ToonGlossy:
            return std::min(lobe.roughness + lobe.softness, 1.0f);
        default:
            return 1.0f;
    }
}

}  // namespace rayleaf
