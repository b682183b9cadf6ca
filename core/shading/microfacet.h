// Microfacet distributions: GGX and Beckmann, anisotropic, with Smith's masking (Walter et al. 2007; Heitz 2014,
// "Understanding the Masking-Shadowing Function").
//
// Directions are unit, in the local frame: z the normal, x the tangent. Normals are sampled as they are seen: Heitz
// 2018, "Sampling the GGX Distribution of Visible Normals"; for Beckmann the visible slopes' distribution is inverted
// numerically (Heitz & d'Eon 2014).
#pragma once

#include "base/vector.h"
#include "shading/closures.h"

#include <cfloat>

namespace rayleaf {

/// The unit vector along `v`, or `otherwise` where it is zero; for vectors whose squares stay in the range of floats.
inline Vec3f unit_or(const Vec3f& v, const Vec3f& otherwise) {
    const float length2 = v.length2();
    return length2 > FLT_MIN ? v * (1.0f / std::sqrt(length2)) : otherwise;
}

/// The direction that a facet mirrors `w` to.
inline Vec3f mirrored(const Vec3f& w, const Vec3f& normal) {
    return normal * (2.0f * normal.dot(w)) - w;
}

struct Microfacets {
    MicrofacetDistribution distribution;
    float alpha_x, alpha_y;

    /// Density of facets with normal `h` per solid angle and unit area; 0 where h.z is not positive.
    float normal_density(const Vec3f& h) const { return normal_density(h.z, crossed2(h)); }
    float normal_density(float cosine, float crossed2) const {
        if (!(cosine > 0.0f)) return 0.0f;
        const float product = alpha_x * alpha_y, product2 = product * product, z2 = cosine * cosine;
        if (distribution == MicrofacetDistribution::Beckmann) {
            const float divisor =
                kPi * product * z2 * z2;  // too small: facets at right angles, of which there are none
            return divisor > 0.0f ? std::exp(-crossed2 / (product2 * z2)) / divisor : 0.0f;
        }
        const float spread = crossed2 + z2 * product2;
        return product * product2 / (kPi * spread * spread);
    }
    /// Share of the facets seen from `w` that are not masked; 0 below the horizon.
    float masking(const Vec3f& w) const { return masking(w.z, spread2(w)); }
    float masking(float cosine, float spread2) const {
        if (!(cosine > 0.0f)) return 0.0f;
        if (distribution == MicrofacetDistribution::Beckmann) return beckmann_masking(cosine, spread2);
        return 2.0f * cosine / (cosine + std::sqrt(spread2 + cosine * cosine));
    }
    /// Share of the facets that the viewer sees which are seen from where `towards` is the masking too; `seen` is his.
    static float shadowing(float seen, float towards, Masking kind) {
        if (kind == Masking::Separate || !(towards > 0.0f)) return towards;
        return towards / (towards + seen - towards * seen);  // Heitz 2014, equation 99, over the viewer's masking
    }
    float shadowing(float seen, const Vec3f& i, Masking kind) const { return shadowing(seen, masking(i), kind); }
    /// Squared sine of a direction's angle to the normal times the squared roughness that way, and across.
    float spread2(const Vec3f& w) const { return squared(w.x * alpha_x) + squared(w.y * alpha_y); }
    float crossed2(const Vec3f& w) const { return squared(w.x * alpha_y) + squared(w.y * alpha_x); }
    /// The first, of facets that are as rough all around.
    float even_spread2(float cosine) const { return alpha_x * alpha_x * std::max(1.0f - cosine * cosine, 0.0f); }
    /// A facet normal as seen from `w`, w.z > 0.
    Vec3f sample_visible(const Vec3f& w, const Vec2f& random) const;

  private:
    static float squared(float x) { return x * x; }
    static float beckmann_masking(float cosine, float spread2);
};

}  // namespace rayleaf
