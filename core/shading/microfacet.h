// Microfacet distributions: GGX and Beckmann, anisotropic, with Smith's masking (Walter et al. 2007; Heitz 2014,
// "Understanding the Masking-Shadowing Function").
//
// Directions are unit, in the local frame: z the normal, x the tangent. Normals are sampled as they are seen: Heitz
// 2018, "Sampling the GGX Distribution of Visible Normals"; for Beckmann the visible slopes' distribution is inverted
// numerically (Heitz & d'Eon 2014).
#pragma once

#include "base/vector.h"
#include "shading/closures.h"

namespace rayleaf {

struct Microfacets {
    MicrofacetDistribution distribution;
    float alpha_x, alpha_y;

    /// Density of facets with normal `h` per solid angle and unit area; 0 where h.z is not positive.
    float normal_density(const Vec3f& h) const {
        if (!(h.z > 0.0f)) return 0.0f;
        const float product = alpha_x * alpha_y, product2 = product * product;
        const float x = h.x * alpha_y, y = h.y * alpha_x, slope2 = x * x + y * y, z2 = h.z * h.z;
        if (distribution == MicrofacetDistribution::Beckmann)
            return std::exp(-slope2 / (product2 * z2)) / (kPi * product * z2 * z2);
        const float spread = slope2 + z2 * product2;
        return product * product2 / (kPi * spread * spread);
    }
    /// Share of the facets seen from `w` that are not masked; 0 below the horizon.
    float masking(const Vec3f& w) const {
        if (!(w.z > 0.0f)) return 0.0f;
        const float x = w.x * alpha_x, y = w.y * alpha_y, spread2 = x * x + y * y;
        if (distribution == MicrofacetDistribution::Beckmann) return beckmann_masking(w.z, spread2);
        return 2.0f * w.z / (w.z + std::sqrt(spread2 + w.z * w.z));
    }
    /// Share of the facets that the viewer sees which are seen from `i` too; `seen` is his masking.
    float shadowing(float seen, const Vec3f& i, Masking kind) const {
        const float towards = masking(i);
        if (kind == Masking::Separate || !(towards > 0.0f)) return towards;
        return towards / (towards + seen - towards * seen);  // Heitz 2014, equation 99, over the viewer's masking
    }
    /// A facet normal as seen from `w`, w.z > 0.
    Vec3f sample_visible(const Vec3f& w, const Vec2f& random) const;

  private:
    /// `spread2`: squared sine of the angle to the normal times the roughness that way.
    static float beckmann_masking(float cosine, float spread2);
};

}  // namespace rayleaf
