// Lobes of microfacets: reflection, refraction, both (glass), and the clearcoat; smooth ones among them are singular.
#pragma once

#include "shading/lobes.h"

namespace rayleaf {

LobeValue evaluate_microfacet_lobe(const Lobe& lobe, const Vec3f& outgoing, const Vec3f& incoming, Side side);
std::optional<LobeDirection> sample_microfacet_lobe(const Lobe& lobe, const Vec3f& outgoing, const Vec3f& random);

LobeValue evaluate_clearcoat(const Lobe& lobe, const Vec3f& outgoing, const Vec3f& incoming, Side side);
std::optional<LobeDirection> sample_clearcoat(const Lobe& lobe, const Vec3f& outgoing, const Vec3f& random);

/// Reflectance of a lobe's interface at a facet seen under `cosine`: colour of the reflection, before the weight.
Color reflectance(const Lobe& lobe, float cosine);
/// What the interface lets through: 1 without Fresnel.
Color transmittance(const Lobe& lobe, float cosine);

}  // namespace rayleaf
