// Reflectance of smooth interfaces.
#pragma once

#include "base/vector.h"

namespace rayleaf {

/// An interface whose index differs less from 1 bends rays by less than a milliradian: clear, whatever its roughness.
constexpr float kLeastIndexStep = 1e-3f;

/// Unpolarized reflectance of a dielectric. `ior` is the index beyond the surface over that on the viewer's side;
/// `cosine` is of the angle between the ray and the normal, its sign does not count. 1 under total internal reflection.
inline float dielectric_fresnel(float cosine, float ior) {
    const float c = std::min(std::abs(cosine), 1.0f);
    // Squared cosine beyond the surface times ior²; in this form an index of exactly 1 gives exactly no reflection.
    const float beyond2 = (ior - 1.0f) * (ior + 1.0f) + c * c;
    if (!(beyond2 > 0.0f)) return ior == 1.0f ? 0.0f : 1.0f;
    const float beyond = std::sqrt(beyond2);
    const float perpendicular = (c - beyond) / (c + beyond);
    const float parallel = (ior * ior * c - beyond) / (ior * ior * c + beyond);
    return 0.5f * (perpendicular * perpendicular + parallel * parallel);
}

/// The same at normal incidence.
inline float normal_fresnel(float ior) {
    const float r = (ior - 1.0f) / (ior + 1.0f);
    return r * r;
}

/// How far a dielectric's reflectance has risen from that at normal incidence, 0, to that at grazing, 1.
inline float fresnel_rise(float ior, float cosine) {
    const float above = ior + 1.0f, scale = above * above / (4.0f * ior);  // 1 / (1 - normal_fresnel)
    const float rise = 1.0f - (1.0f - dielectric_fresnel(cosine, ior)) * scale;
    return std::clamp(rise, 0.0f, 1.0f);
}

/// Reflectance that rises from the colour `fresnel_0` at normal incidence to white at grazing, along the dielectric
/// curve of `ior` (where Schlick has a fifth power): Cycles' Principled shader.
inline Color coloured_fresnel(const Color& fresnel_0, float ior, float cosine) {
    const float h = fresnel_rise(ior, cosine);
    return fresnel_0 * (1.0f - h) + Color(h);
}

/// The mean of `fresnel_rise` over a hemisphere of light.
inline float mean_fresnel_rise(float ior) {
    constexpr int kPoints = 8;  // even in the squared cosine
    float sum = 0.0f;
    for (int i = 0; i < kPoints; ++i) sum += fresnel_rise(ior, std::sqrt((static_cast<float>(i) + 0.5f) / kPoints));
    return sum / kPoints;
}

/// Schlick's fifth power, for diffuse retro-reflection and sheen (Burley 2012, section 5.3).
inline float schlick_weight(float cosine) {
    const float m = std::clamp(1.0f - cosine, 0.0f, 1.0f);
    const float m2 = m * m;
    return m2 * m2 * m;
}

// Metals: Schlick's curve, with a dip that makes the reflectance near 82 degrees, where the cosine is 1/7, `tint` times
// what Schlick has there (Kutz, Hasan, Edmondson: "Novel aspects of the Adobe Standard Material", 2023).

constexpr float kMetalEdge = 1.0f / 7.0f, kMetalFifth = 0.46266436f, kMetalSixth = 0.39656946f;  // powers of 6/7
inline Color metal_edge_without_dip(const Color& fresnel_0) {
    return fresnel_0 * (1.0f - kMetalFifth) + Color(kMetalFifth);
}
/// The factor of the dip.
inline Color metal_dip(const Color& fresnel_0, const Color& tint) {
    return metal_edge_without_dip(fresnel_0) * (Color(1.0f) - tint) / (kMetalEdge * kMetalSixth);
}
/// The inverse.
inline Color metal_tint(const Color& fresnel_0, const Color& dip) {
    return Color(1.0f) - dip * (kMetalEdge * kMetalSixth) / metal_edge_without_dip(fresnel_0);
}
inline Color metal_fresnel(const Color& fresnel_0, const Color& dip, float cosine) {
    const float c = std::clamp(cosine, 0.0f, 1.0f), fifth = schlick_weight(c);
    const Color f = fresnel_0 * (1.0f - fifth) + Color(fifth) - dip * (c * fifth * (1.0f - c));
    return {std::clamp(f.x, 0.0f, 1.0f), std::clamp(f.y, 0.0f, 1.0f), std::clamp(f.z, 0.0f, 1.0f)};
}
/// Its mean over a hemisphere of light.
inline Color mean_metal_fresnel(const Color& fresnel_0, const Color& dip) {
    return fresnel_0 * (20.0f / 21.0f) + Color(1.0f / 21.0f) - dip * (1.0f / 126.0f);
}

/// Unpolarized reflectance of a conductor by its index and extinction, one for each channel.
inline float conductor_fresnel(float index, float extinction, float cosine) {
    const float c = std::clamp(cosine, 0.0f, 1.0f), c2 = c * c, s2 = 1.0f - c2;
    const float both = 4.0f * index * index * extinction * extinction;
    const float difference = (index - extinction) * (index + extinction) - s2;
    const float modulus = std::sqrt(difference * difference + both);
    const float real = std::sqrt(std::max(0.5f * (modulus + difference), 0.0f)), across = 2.0f * real * c;
    const float perpendicular = (modulus + c2 - across) / (modulus + c2 + across);
    const float parallel = (c2 * modulus + s2 * s2 - across * s2) / (c2 * modulus + s2 * s2 + across * s2);
    return std::clamp(0.5f * perpendicular * (1.0f + parallel), 0.0f, 1.0f);
}
inline Color conductor_fresnel(const Color& index, const Color& extinction, float cosine) {
    return {conductor_fresnel(index.x, extinction.x, cosine), conductor_fresnel(index.y, extinction.y, cosine),
            conductor_fresnel(index.z, extinction.z, cosine)};
}

}  // namespace rayleaf
