// Lobes of microfacets: reflection, refraction, both (glass), and the clearcoat; smooth ones among them are singular.
#pragma once

#include "shading/fresnel.h"
#include "shading/lobes.h"

namespace rayleaf {

/// Completes the view of a lobe of microfacets.
void look_at_facets(const Lobe& lobe, const Vec3f& outgoing, LobeView& view);

LobeValue evaluate_microfacet_lobe(const Lobe& lobe, const LobeView& view, const DirectionPair& pair);
std::optional<LobeDirection> sample_microfacet_lobe(const Lobe& lobe, const LobeView& view, const Vec3f& outgoing,
                                                    const Vec3f& random);

/// Of a Subsurface lobe: the way into the body.
LobeDirection sample_entry(const Lobe& lobe, const LobeView& view, const Vec3f& outgoing, const Vec3f& random);

LobeValue evaluate_clearcoat(const Lobe& lobe, const LobeView& view, const DirectionPair& pair);
std::optional<LobeDirection> sample_clearcoat(const Lobe& lobe, const Vec3f& outgoing, const Vec3f& random);

/// By the lobe's Fresnel and film, whatever they are.
Color any_reflectance(const Lobe& lobe, float cosine);
/// Reflectance of a lobe's interface at a facet seen under `cosine`: colour of the reflection, before the weight.
inline Color reflectance(const Lobe& lobe, float cosine) {
    if (lobe.fresnel != Lobe::Fresnel::Schlick || lobe.film.thickness > 0.0f) return any_reflectance(lobe, cosine);
    return coloured_fresnel(lobe.fresnel_0, lobe.ior, cosine);
}
/// What the interface lets through: 1 without Fresnel.
Color transmittance(const Lobe& lobe, float cosine);

/// What a facet of glass seen under `cosine` sends each way, before the weight, and how often sampling reflects there:
/// by its share of that. With a `glint` that many times its share, if it refracts more, but no more often than it
/// refracts: so a sample weighs at most twice its light.
struct GlassShares {
    Color reflected, refracted;
    float reflects = 0;
};
GlassShares glass_shares(const Lobe& lobe, float cosine, float glint = 1.0f);

}  // namespace rayleaf
