#include "shading/principled_layers.h"

#include "shading/fresnel.h"
#include "shading/lobe_microfacet.h"
#include "shading/microfacet_albedo.h"
#include "shading/microfibres.h"
#include "shading/operands.h"
#include "shading/operations_math.h"

#include <utility>

namespace rayleaf {
namespace {

Color power(const Color& base, float exponent) {
    return {std::pow(base.x, exponent), std::pow(base.y, exponent), std::pow(base.z, exponent)};
}
Color blended(const Color& a, const Color& b, float share) {
    return a * (1.0f - share) + b * share;
}
Color at_most_one(const Color& c) {
    return {std::min(c.x, 1.0f), std::min(c.y, 1.0f), std::min(c.z, 1.0f)};
}

float cosine_to_viewer(const PrincipledLayers& p, const Vec3f& normal) {
    return saturate(normal.dot(p.outgoing));
}

/// What a layer leaves to those below: one share for all channels, by the one that it reflects most of, so that a
/// coloured layer does not tint what it covers.
Color below(const Color& weight, const Color& reflected) {
    float most = 0.0f;
    for (int c = 0; c < 3; ++c)
        if (weight[c] > 0.0f) most = std::max(most, reflected[c] / weight[c]);
    return weight * saturate(1.0f - most);
}

Lobe microfacet_lobe(LobeType type, LobeKind kind, const Vec3f& normal, float alpha, const Color& weight) {
    Lobe lobe;
    lobe.type = type;
    lobe.kind = kind;
    lobe.masking = Masking::Joint;
    lobe.normal = normal;
    lobe.alpha_x = lobe.alpha_y = alpha;
    lobe.weight = weight;
    return lobe;
}

/// Of the metal's and the body's reflection.
Lobe anisotropic_lobe(const PrincipledLayers& p, const Color& weight) {
    const float alpha = p.roughness * p.roughness, aspect = std::sqrt(1.0f - 0.9f * p.anisotropic);
    Lobe lobe = microfacet_lobe(LobeType::Reflection, LobeKind::Glossy, p.normal, alpha, weight);
    lobe.alpha_x = alpha / aspect;
    lobe.alpha_y = alpha * aspect;
    lobe.tangent = rotated(p.tangent, p.normal, p.rotation * 2.0f * kPi);
    return lobe;
}

Color add_sheen(const PrincipledLayers& p, const Color& weight, Closures& closures) {
    constexpr float kLeastAlbedo = 1e-5f;  // as Cycles
    Lobe lobe;
    lobe.normal = normalized_or(blended(p.matte_normal, p.matte_coat_normal, saturate(p.coat)), p.matte_normal);
    const Microfibres fibres = microfibres(p.sheen_roughness, cosine_to_viewer(p, lobe.normal));
    if (fibres.albedo < kLeastAlbedo) return weight;
    set_microfibres(lobe, fibres, p.outgoing);
    lobe.weight = weight * p.sheen_tint * (p.sheen * fibres.albedo);
    closures.add(lobe);
    return below(weight, lobe.weight);
}

float coat_reflectance(const PrincipledLayers& p, float cosine) {
    if (!p.coat_by_facets || !(p.coat_ior > 1.0f)) return dielectric_fresnel(cosine, p.coat_ior);
    const float straight = normal_fresnel(p.coat_ior);
    return std::lerp(straight, 1.0f, ggx_fresnel_rise(p.coat_roughness * p.coat_roughness, cosine, p.coat_ior));
}

Color add_coat(const PrincipledLayers& p, Color weight, Closures& closures) {
    const float cosine = cosine_to_viewer(p, p.coat_normal);
    Lobe lobe = microfacet_lobe(LobeType::Reflection, LobeKind::Glossy, p.coat_normal,
                                p.coat_roughness * p.coat_roughness, weight * p.coat);
    lobe.fresnel = Lobe::Fresnel::Dielectric;
    lobe.ior = p.coat_ior;
    closures.add(lobe);
    weight = below(weight, lobe.weight * coat_reflectance(p, cosine));
    if (p.coat_tint == Color(1.0f)) return weight;
    const float inside = std::sqrt(1.0f - (1.0f - cosine * cosine) / (p.coat_ior * p.coat_ior));
    return weight * blended(Color(1.0f), power(p.coat_tint, 1.0f / inside), p.coat);
}

/// The factor that gives back what a lobe's facets lose, and the share of it that a layer below counts.
std::pair<Color, Color> multiple_scattering(const PrincipledLayers& p, const Lobe& lobe, const Color& mean_fresnel) {
    if (!p.multiple_scattering) return {Color(1.0f), Color(1.0f)};
    const float alpha = even_alpha(lobe.alpha_x, lobe.alpha_y), cosine = cosine_to_viewer(p, p.normal);
    const float albedo = ggx_reflection_albedo(alpha, cosine, Masking::Joint);
    const Color again = repeated_fresnel(mean_fresnel, ggx_mean_albedo(alpha));
    const Color factor = energy_compensation(again, albedo);
    return {factor, factor * albedo};
}

void add_metal(const PrincipledLayers& p, const Color& weight, Closures& closures) {
    Lobe lobe = anisotropic_lobe(p, weight);
    lobe.fresnel = Lobe::Fresnel::Metal;
    lobe.fresnel_0 = at_most_one(p.base_color);
    lobe.radius = metal_dip(lobe.fresnel_0, at_most_one(p.specular_tint));
    if (p.film_on_metal) lobe.film = p.film;
    lobe.weight = lobe.weight * multiple_scattering(p, lobe, mean_metal_fresnel(lobe.fresnel_0, lobe.radius)).first;
    closures.add(lobe);
}

void add_glass(const PrincipledLayers& p, const Color& weight, Closures& closures) {
    const float alpha = p.roughness * p.roughness, cosine = cosine_to_viewer(p, p.normal);
    const float ior = p.from_inside ? 1.0f / p.ior : p.ior;
    const bool white = p.specular_tint == Color(1.0f);
    const Color scale = p.multiple_scattering
                            ? energy_compensation(Color(1.0f), ggx_glass_albedo(alpha, cosine, ior, Masking::Joint))
                            : Color(1.0f);
    Lobe lobe = microfacet_lobe(LobeType::Glass, LobeKind::Transmission, p.normal, alpha, weight * scale);
    lobe.refracted = power(at_most_one(p.base_color), 0.5f);  // light crosses the surface twice
    lobe.fresnel = white ? Lobe::Fresnel::Dielectric : Lobe::Fresnel::Schlick;
    lobe.ior = ior;
    lobe.fresnel_0 = p.specular_tint * normal_fresnel(ior);
    lobe.film = p.film;
    if (p.from_inside) lobe.film.ior /= p.ior;
    closures.add(lobe);
}

/// What a sheet of glass sends back and lets through, all reflections inside together; light is tinted once each way.
struct SheetShares {
    Color reflected, passed;
};
SheetShares sheet_shares(const Color& reflectance, const Color& tint, float cosine, float ior) {
    const float inside2 = 1.0f - (1.0f - cosine * cosine) / (ior * ior);
    SheetShares shares{reflectance, Color(0.0f)};
    if (!(inside2 > 0.0f)) return shares;  // total reflection
    const Color left = power(tint, 1.0f / std::sqrt(inside2));
    for (int c = 0; c < 3; ++c) {
        const float r = reflectance[c], entered = 1.0f - r;
        if (!(entered > 0.0f)) continue;
        shares.passed[c] = entered * entered * left[c] / (1.0f - r * r * left[c] * left[c]);
        shares.reflected[c] += shares.passed[c] * r * left[c];
    }
    return shares;
}

/// How rough what passes a sheet is, by its facets: two refractions of which the second undoes much of the first
/// (Kulla, Conty, "Revisiting Physically Based Shading at Imageworks", 2017, with the factor of Cycles).
float sheet_alpha(float alpha, float ior) {
    constexpr float kFactor = 3.4f;
    const float inverse = ior < 1.0f ? ior : 1.0f / ior, step = 1.0f - 0.5f * inverse;
    return saturate(alpha * std::sqrt(kFactor * (1.0f - inverse)) * step);
}

void add_sheet(const PrincipledLayers& p, const Color& weight, Closures& closures) {
    constexpr float kClear = 1e-3f;
    const float alpha = p.roughness * p.roughness, cosine = cosine_to_viewer(p, p.normal);
    const auto even_factor = [&](float of) {
        return energy_compensation(Color(1.0f), ggx_reflection_albedo(of, cosine, Masking::Joint));
    };
    Lobe lobe = microfacet_lobe(LobeType::Reflection, LobeKind::Glossy, p.normal, alpha, Color(0.0f));
    lobe.fresnel = Lobe::Fresnel::Schlick;
    lobe.ior = p.ior;
    lobe.fresnel_0 = p.specular_tint * normal_fresnel(p.ior);
    lobe.film = p.film;
    const SheetShares shares = sheet_shares(reflectance(lobe, cosine), at_most_one(p.base_color), cosine, p.ior);
    lobe.fresnel = Lobe::Fresnel::None;
    lobe.film = {};
    lobe.weight = weight * shares.reflected * even_factor(alpha);
    closures.add(lobe);
    const float through = sheet_alpha(alpha, p.ior);
    if (through < kClear) {  // shadows are as light as what is seen
        closures.transparency += weight * shares.passed;
        return;
    }
    lobe.type = LobeType::Sheet;
    lobe.kind = LobeKind::Transmission;
    lobe.alpha_x = lobe.alpha_y = through;
    lobe.weight = weight * shares.passed * even_factor(through);
    closures.add(lobe);
}

/// Index of refraction of a reflectance at normal incidence.
float index_of_reflectance(float reflectance) {
    constexpr float kMost = 0.99f;  // beyond, the index runs to infinity
    const float root = std::sqrt(std::clamp(reflectance, 0.0f, kMost));
    return (1.0f + root) / (1.0f - root);
}

/// Index of the body's surface: that which reflects as the specular level wants.
float index_of_surface(const PrincipledLayers& p) {
    if (p.specular_level == 0.5f) return p.ior;
    const float ior = index_of_reflectance(normal_fresnel(p.ior) * 2.0f * p.specular_level);
    return p.ior < 1.0f ? 1.0f / ior : ior;
}

Color add_reflection(const PrincipledLayers& p, const Color& weight, Closures& closures) {
    const float ior = index_of_surface(p);
    if (ior == 1.0f) return weight;
    const float fresnel_0 = normal_fresnel(p.ior) * (2.0f * p.specular_level);
    Lobe lobe = anisotropic_lobe(p, weight);
    lobe.fresnel = Lobe::Fresnel::Schlick;
    lobe.ior = ior;
    lobe.fresnel_0 = p.specular_tint * fresnel_0;
    lobe.film = p.film;
    const auto [factor, counted] =
        multiple_scattering(p, lobe, blended(lobe.fresnel_0, Color(1.0f), mean_fresnel_rise(lobe.ior)));
    lobe.weight = weight * factor;
    closures.add(lobe);
    if (p.film.thickness > 0.0f)
        return below(weight, weight * counted * reflectance(lobe, cosine_to_viewer(p, p.normal)));
    const float rise = ggx_fresnel_rise(p.roughness * p.roughness, cosine_to_viewer(p, p.normal), ior);
    return below(weight, weight * counted * blended(lobe.fresnel_0, Color(1.0f), rise));
}

/// Light that is scattered in a sheet leaves it on both sides, the more on the far one the more it keeps its direction.
void add_scattering_sheet(const PrincipledLayers& p, const Color& weight, Closures& closures) {
    const float forward = std::clamp(0.5f * (1.0f + p.subsurface_anisotropy), 0.0f, 1.0f);
    Lobe lobe;
    lobe.normal = p.normal;
    lobe.weight = weight * p.base_color * (1.0f - forward);
    closures.add(lobe);
    lobe.type = LobeType::Translucent;
    lobe.weight = weight * p.base_color * forward;
    closures.add(lobe);
}

void add_body(const PrincipledLayers& p, const Color& weight, Closures& closures) {
    float spread = p.after_diffuse ? 0.0f : p.subsurface;
    if (p.is_sheet && p.subsurface > 0.0f) {
        add_scattering_sheet(p, weight * p.subsurface, closures);
        spread = p.subsurface;
    } else if (spread > 0.0f) {
        SubsurfaceParameters body;
        body.albedo = at_most_one(p.base_color);
        body.weight = weight * body.albedo * spread;
        body.radius = p.subsurface_radius;
        body.ior = p.subsurface_ior;
        body.anisotropy = p.subsurface_anisotropy;
        body.method = p.subsurface_method;
        body.is_refracted = true;
        body.entry_alpha = p.roughness * p.roughness;
        body.entry_ior = index_of_surface(p);
        body.normal = p.normal;
        add_subsurface(body, closures);
    }
    Lobe diffuse;
    diffuse.normal = p.matte_normal;
    diffuse.roughness = p.diffuse_roughness;
    diffuse.fresnel_0 = at_most_one(p.base_color);
    diffuse.weight = weight * p.base_color * (1.0f - spread);
    closures.add(diffuse);
}

}  // namespace

void add_principled_layers(const PrincipledLayers& p, Closures& closures) {
    closures.transparency += p.weight * (1.0f - p.alpha);
    Color weight = p.weight * p.alpha;
    if (is_black(weight)) return;
    if (p.sheen > 0.0f) weight = add_sheen(p, weight, closures);
    if (p.coat > 0.0f) weight = add_coat(p, weight, closures);
    closures.emission += weight * p.emission;
    if (p.metallic > 0.0f) add_metal(p, weight * p.metallic, closures);
    weight = weight * (1.0f - p.metallic);
    if (p.transmission > 0.0f && !is_black(weight))
        (p.is_sheet ? add_sheet : add_glass)(p, weight * p.transmission, closures);
    weight = weight * (1.0f - p.transmission);
    if (is_black(weight)) return;
    add_body(p, add_reflection(p, weight, closures), closures);
}

}  // namespace rayleaf
