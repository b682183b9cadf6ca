// Reflectance of smooth interfaces.
#pragma once

#include "base/vector.h"

namespace rayleaf {

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

/// Reflectance that rises from the colour `fresnel_0` at normal incidence to white at grazing, along the dielectric
/// curve of `ior` (where Schlick has a fifth power): Cycles' Principled shader up to 3.6.
inline Color coloured_fresnel(const Color& fresnel_0, float ior, float cosine) {
    const float least = normal_fresnel(ior);
    const float rise = least < 1.0f ? (dielectric_fresnel(cosine, ior) - least) / (1.0f - least) : 0.0f;
    const float h = std::clamp(rise, 0.0f, 1.0f);
    return fresnel_0 * (1.0f - h) + Color(h);
}

/// Schlick's fifth power, for diffuse retro-reflection and sheen (Burley 2012, section 5.3).
inline float schlick_weight(float cosine) {
    const float m = std::clamp(1.0f - cosine, 0.0f, 1.0f);
    const float m2 = m * m;
    return m2 * m2 * m;
}

}  // namespace rayleaf
