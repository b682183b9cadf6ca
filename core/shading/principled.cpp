#include "shading/principled.h"

#include "shading/fresnel.h"
#include "shading/microfacet_albedo.h"
#include "shading/operands.h"
#include "shading/operations_math.h"

namespace rayleaf {
namespace {

using Parameters = PrincipledParameters;

Color mixed(const Color& a, const Color& b, float share) {
    return a * (1.0f - share) + b * share;
}

/// The hue and saturation of `color`, its brightness by `channel_weights` taken out; white for black.
Color tint(const Color& color, const Color& channel_weights) {
    const float brightness = color.dot(channel_weights);
    return brightness > 0.0f ? color / brightness : Color(1.0f);
}

Lobe lobe_of(LobeType type, LobeKind kind, const Parameters& p, const Color& weight) {
    Lobe lobe;
    lobe.type = type;
    lobe.kind = kind;
    lobe.weight = weight;
    lobe.normal = p.normal;
    return lobe;
}

void add_spread(const Parameters& p, const Color& weight, const Color& color, Closures& closures) {
    SubsurfaceParameters spread;
    spread.weight = weight * color;
    spread.albedo = color;
    spread.radius = p.subsurface_radius * p.subsurface;
    spread.ior = p.subsurface_ior;
    spread.anisotropy = p.subsurface_anisotropy;
    spread.method = p.subsurface_method;
    spread.normal = p.normal;
    spread.is_disney = true;
    spread.roughness = p.roughness;
    add_subsurface(spread, closures);
}

void add_diffuse(const Parameters& p, const Color& weight, Closures& closures) {
    constexpr float kLeastShare = 1e-5f;  // as Cycles
    const Color color = mixed(p.base_color, p.subsurface_color, p.subsurface);
    if (p.subsurface > kLeastShare && !p.after_diffuse) {
        add_spread(p, weight, color, closures);
    } else {
        Lobe diffuse = lobe_of(LobeType::PrincipledDiffuse, LobeKind::Diffuse, p, weight * color);
        diffuse.roughness = p.roughness;
        diffuse.normal = p.matte_normal;
        closures.add(diffuse);
    }
    if (!(p.sheen > 0.0f)) return;
    const Color sheen = mixed(Color(1.0f), tint(p.base_color, Color(0.2126729f, 0.7151522f, 0.0721750f)), p.sheen_tint);
    Lobe fibres = lobe_of(LobeType::Sheen, LobeKind::Diffuse, p, weight * sheen * p.sheen);
    fibres.normal = p.matte_normal;
    closures.add(fibres);
}

/// Index of refraction whose reflectance at normal incidence is 8 % of `specular`.
float index_of(float specular) {
    constexpr float kMost = 0.99f;  // beyond, the index runs to infinity
    return 2.0f / (1.0f - std::min(std::sqrt(0.08f * std::max(specular, 0.0f)), kMost)) - 1.0f;
}

void add_specular(const Parameters& p, const Color& weight, Closures& closures) {
    if (!(p.specular > 0.0f) && !(p.metallic > 0.0f)) return;
    Lobe lobe = lobe_of(LobeType::Reflection, LobeKind::Glossy, p, weight);
    const float aspect = std::sqrt(1.0f - 0.9f * p.anisotropic), alpha = p.roughness * p.roughness;
    lobe.alpha_x = alpha / aspect;
    lobe.alpha_y = alpha * aspect;
    lobe.tangent = rotated(p.tangent, p.normal, p.anisotropic_rotation * 2.0f * kPi);
    lobe.fresnel = Lobe::Fresnel::Schlick;
    lobe.ior = index_of(p.specular);
    const Color dielectric =
        mixed(Color(1.0f), tint(p.base_color, Color(0.3f, 0.6f, 0.1f)), p.specular_tint) * (0.08f * p.specular);
    lobe.fresnel_0 = saturate(mixed(dielectric, p.base_color, p.metallic));
    if (p.multiple_scattering) {
        const float even = even_alpha(lobe.alpha_x, lobe.alpha_y);
        const float albedo = ggx_reflection_albedo(even, std::max(p.normal.dot(p.outgoing), 0.0f));
        lobe.weight = lobe.weight * energy_compensation(lobe.fresnel_0, albedo);
    }
    closures.add(lobe);
}

void add_transmission(const Parameters& p, const Color& weight, Closures& closures) {
    const float alpha = p.roughness * p.roughness;
    const float cosine = std::max(p.normal.dot(p.outgoing), 0.0f);
    constexpr float kSmooth = 0.05f;  // no light is followed from facet to facet there, in Cycles up to 3.5
    const bool multiple = p.multiple_scattering && p.roughness > kSmooth;
    const Color scale =
        multiple ? energy_compensation(Color(1.0f), ggx_glass_albedo(alpha, cosine, p.ior)) : Color(1.0f);
    const Color reflection_color = saturate(mixed(Color(1.0f), p.base_color, p.specular_tint));
    Lobe lobe = lobe_of(LobeType::Glass, LobeKind::Transmission, p, weight * reflection_color * scale);
    lobe.alpha_x = lobe.alpha_y = alpha;
    lobe.fresnel = Lobe::Fresnel::Dielectric;
    lobe.fresnel_at_normal = !multiple;
    lobe.ior = p.ior;
    // Cycles applies the transmission's own roughness with single scattering only.
    if (p.multiple_scattering || p.transmission_roughness == 0.0f) {
        // Where the reflection has nothing of a colour, the base has nothing of it either.
        for (int c = 0; c < 3; ++c)
            if (reflection_color[c] > 0.0f) lobe.refracted[c] = p.base_color[c] / reflection_color[c];
        closures.add(lobe);
        return;
    }
    lobe.type = LobeType::Reflection;
    lobe.kind = LobeKind::Glossy;
    closures.add(lobe);
    lobe.type = LobeType::Refraction;
    lobe.kind = LobeKind::Transmission;
    lobe.weight = weight * p.base_color * scale;
    const float roughness = 1.0f - (1.0f - p.roughness) * (1.0f - p.transmission_roughness);
    lobe.alpha_x = lobe.alpha_y = roughness * roughness;
    closures.add(lobe);
}

void add_clearcoat(const Parameters& p, const Color& weight, Closures& closures) {
    constexpr float kShare = 0.25f;  // Disney's: a full clearcoat is a quarter of a lacquer's reflection
    Lobe lobe = lobe_of(LobeType::Clearcoat, LobeKind::Glossy, p, weight * (kShare * p.clearcoat));
    lobe.normal = p.clearcoat_normal;
    lobe.alpha_x = lobe.alpha_y = p.clearcoat_roughness * p.clearcoat_roughness;
    lobe.fresnel = Lobe::Fresnel::Schlick;
    lobe.ior = 1.5f;
    lobe.fresnel_0 = Color(normal_fresnel(lobe.ior));
    closures.add(lobe);
}

}  // namespace

void add_principled(const PrincipledParameters& parameters, Closures& closures) {
    closures.transparency += parameters.weight * (1.0f - parameters.alpha);
    const Color weight = parameters.weight * parameters.alpha;
    if (is_black(weight)) return;
    closures.emission += weight * parameters.emission;
    const float opaque = 1.0f - parameters.transmission, dielectric = 1.0f - parameters.metallic;
    const float glass = parameters.transmission * dielectric;
    if (opaque * dielectric > 0.0f) add_diffuse(parameters, weight * (opaque * dielectric), closures);
    if (glass < 1.0f) add_specular(parameters, weight * (1.0f - glass), closures);
    if (glass > 0.0f) add_transmission(parameters, weight * glass, closures);
    if (parameters.clearcoat > 0.0f) add_clearcoat(parameters, weight, closures);
}

}  // namespace rayleaf
