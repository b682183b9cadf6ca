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

    /// Density of facets with normal `h` per solid angle and unit area; h.z > 0.
    float normal_density(const Vec3f& h) const;
    /// Share of the facets seen from `w` that are not masked; 0 below the horizon.
    float masking(const Vec3f& w) const;
    /// Share of the facets seen from `w`, and not masked there, that are seen from `i` too.
    float shadowing(const Vec3f& w, const Vec3f& i, Masking kind) const;
    /// Density per solid angle with which `sample_visible` gives `h`: D(h) G1(w) max(w.h, 0) / w.z.
    float visible_density(const Vec3f& w, const Vec3f& h) const;
    /// A facet normal as seen from `w`, w.z > 0.
    Vec3f sample_visible(const Vec3f& w, const Vec2f& random) const;
};

}  // namespace rayleaf
