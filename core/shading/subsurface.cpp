#include "shading/subsurface.h"

#include <array>

namespace rayleaf {
namespace {

/// Walks end.
constexpr float kMostAlbedo = 0.999999f;

/// Diffuse reflectance of a half space by the dipole with an extended source (Jensen et al. 2001, equation 15), for an
/// albedo of one scattering and a boundary.
float dipole_reflectance(float albedo, float boundary) {
    const float root = std::sqrt(3.0f * (1.0f - albedo));
    return 0.5f * albedo * (1.0f + std::exp(-boundary * root)) * std::exp(-root);
}

/// The albedo of one scattering that gives a reflectance.
float dipole_albedo(float reflectance, float boundary) {
    constexpr float kBlack = 1e-4f, kWhite = 0.995f;
    if (reflectance < kBlack) return 0.0f;
    if (reflectance >= kWhite) return kMostAlbedo;
    constexpr int kHalvings = 12;  // as many as Cycles makes
    float low = 0.0f, high = 1.0f, middle = 0.5f;
    for (int i = 0; i < kHalvings; ++i) {
        middle = 0.5f * (low + high);
        (dipole_reflectance(middle, boundary) < reflectance ? low : high) = middle;
    }
    return middle;
}

/// Mean free paths for what an artist calls radius; reduced by the phase function but for the method of that name. Of a
/// profile, its widths: as in Cycles those are the mean free paths, whatever the albedo.
Color free_paths(const SubsurfaceParameters& p) {
    if (p.method == SubsurfaceMethod::MeanFreePath) return p.radius;
    if (p.method == SubsurfaceMethod::FixedRadius || p.method == SubsurfaceMethod::Profile)
        return p.radius * (0.25f / kPi);
    const float inverse = 1.0f / std::clamp(p.ior, 1.01f, 3.8f), ior = 1.0f / inverse;
    // Mean reflectance inside (Jensen et al. 2001, section 2.2).
    const float inner = inverse * (-1.440f * inverse + 0.710f) + 0.668f + 0.0636f * ior;
    const float boundary = (4.0f / 3.0f) * (1.0f + inner) / (1.0f - inner);
    Color paths = p.radius;
    for (int c = 0; c < 3; ++c) paths[c] *= std::sqrt(3.0f * (1.0f - dipole_albedo(p.albedo[c], boundary)));
    return paths;
}

float polynomial(const std::array<float, 8>& coefficients, float x) {
    float value = 0.0f;
    for (size_t i = coefficients.size(); i-- > 0;) value = value * x + coefficients[i];
    return value;
}

/// The albedo of one scattering that makes a body look like `color`: the fit of Wrenninge et al.
float scattering_albedo(float color, float g) {
    const float a = polynomial({1.8260523782f, -1.28451056436f, -1.79904629312f, 9.19393289202f, -22.8215585862f,
                                32.0234874259f, -23.6264803333f, 7.21067002658f},
                               g);
    const float b =
        4.98511194385f +
        0.127355959438f * std::exp(polynomial({0.0f, 31.1491581433f, -201.847017512f, 841.576016723f, -2018.09288505f,
                                               2731.71560286f, -1935.41424244f, 559.009054474f},
                                              g));
    const float c = polynomial({1.09686102424f, -0.394704063468f, 1.05258115941f, -8.83963712726f, 28.8643230661f,
                                -46.8802913581f, 38.5402837518f, -12.7181042538f},
                               g);
    const float d = polynomial({0.496310210422f, 0.360146581622f, -2.15139309747f, 17.8896899217f, -55.2984010333f,
                                82.065982243f, -58.5106008578f, 15.8478295021f},
                               g);
    const float e =
        4.23190299701f +
        0.00310603949088f * std::exp(polynomial({0.0f, 76.7316253952f, -594.356773233f, 2448.8834203f, -5576.68528998f,
                                                 7116.60171912f, -4763.54467887f, 1303.5318055f},
                                                g));
    const float f = polynomial({2.40602999408f, -2.51814844609f, 9.18494908356f, -79.2191708682f, 259.082868209f,
                                -403.613804597f, 302.85712436f, -87.4370473567f},
                               g);
    const float share = std::sqrt(std::sqrt(color));
    const float albedo =
        (1.0f - share) * a * std::pow(std::atan(b * color), c) + share * d * std::pow(std::atan(e * color), f);
    return std::clamp(albedo, 0.0f, kMostAlbedo);
}

/// The same by van de Hulst's fit, for a phase function that prefers a direction by similarity (OpenPBR Surface 1.1,
/// section 3.6.4).
float similar_albedo(float color, float g) {
    const float root = std::sqrt(9.59217f + color * (41.6808f + color * 17.7126f));
    const float s = 4.09712f + 4.20863f * color - root;
    return std::clamp((1.0f - s * s) / (1.0f - g * s * s), 0.0f, kMostAlbedo);
}

Lobe lobe_of(const SubsurfaceParameters& p, LobeType type, const Color& weight) {
    Lobe lobe;
    lobe.type = type;
    lobe.weight = weight;
    lobe.normal = p.normal;
    lobe.roughness = p.is_disney ? p.roughness : 0.0f;
    return lobe;
}

}  // namespace

void add_subsurface(const SubsurfaceParameters& p, Closures& closures) {
    constexpr float kLeastRadius = 1e-8f;  // as Cycles
    Color spread = p.weight, diffuse(0.0f);
    for (int c = 0; c < 3; ++c)
        if (!(p.radius[c] >= kLeastRadius)) std::swap(spread[c], diffuse[c]);
    closures.add(lobe_of(p, p.is_disney ? LobeType::PrincipledDiffuse : LobeType::Diffuse, diffuse));
    if (p.is_disney) closures.add(lobe_of(p, LobeType::RetroReflection, spread));
    Lobe lobe = lobe_of(p, LobeType::Subsurface, spread);
    lobe.fresnel_0 = p.albedo;
    lobe.radius = free_paths(p);
    lobe.is_reduced = p.method != SubsurfaceMethod::MeanFreePath;
    const bool is_physical = p.method == SubsurfaceMethod::Physical;
    lobe.by_profile = p.method == SubsurfaceMethod::Profile;
    if (p.is_refracted && !lobe.by_profile) lobe.entry = is_physical ? EntryKind::Either : EntryKind::Refracted;
    // The physical method's surface is as rough as can be, and has the index of the body, as in Cycles.
    lobe.alpha_x = lobe.alpha_y = is_physical ? 1.0f : p.entry_alpha;
    lobe.ior = std::max(is_physical ? p.ior : p.entry_ior, 1.0f);
    lobe.softness = std::clamp(p.anisotropy, 0.0f, 0.9f);  // Cycles' limits up to 4.4
    lobe.fresnel = p.is_disney ? Lobe::Fresnel::Schlick : Lobe::Fresnel::None;
    closures.add(lobe);
}

SubsurfaceMedium subsurface_medium(const Lobe& lobe) {
    // Below this albedo light leaves where it entered; weights make up for what is above.
    constexpr float kLeastAlbedo = 0.2f, kLeastPath = 1e-16f;
    SubsurfaceMedium medium;
    medium.anisotropy = lobe.softness;
    for (int c = 0; c < 3; ++c) {
        const float color = std::clamp(lobe.fresnel_0[c], 0.0f, 1.0f);
        const float g = medium.anisotropy, path = std::max(lobe.radius[c], kLeastPath);
        const float albedo = lobe.is_reduced ? scattering_albedo(color, g) : similar_albedo(color, g);
        medium.extinction[c] = 1.0f / (lobe.is_reduced ? path * (1.0f - g) : path);
        // The lobe's weight holds the surface's albedo, which the walk applies itself.
        medium.factor[c] = lobe.fresnel_0[c] > 0.0f ? std::min(albedo / kLeastAlbedo, 1.0f) / lobe.fresnel_0[c] : 0.0f;
        medium.albedo[c] = std::max(albedo, kLeastAlbedo);
    }
    return medium;
}

}  // namespace rayleaf
