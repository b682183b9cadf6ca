// Energy that single scattering among GGX facets loses, and what gives it back.
//
// Smith's masking discards light that a facet sends into another facet. Light scattered more often looks about like the
// rest, so the lobe is scaled (Turquin 2019, "Practical multiple scattering compensation for microfacet models"): a
// lobe of albedo E at the viewer's angle is multiplied by 1 + F (1 - E) / E, where F is the facets' reflectance. A
// white lobe then reflects all light; a coloured one is more saturated, as after several bounces. The scale depends on
// the viewer's direction alone, so compensated lobes are not reciprocal.
//
// The albedos are tables filled by quadrature at first use, some 0.1 s, and only programs with MULTI_GGX, or with
// layers of Blender 4, use them.
#pragma once

#include "base/vector.h"
#include "shading/closures.h"

namespace rayleaf {

/// The roughness of even facets that lose about as much energy as those of a lobe, which may be anisotropic: the root
/// mean square.
float even_alpha(float alpha_x, float alpha_y);
/// Albedo of white isotropic GGX reflection of roughness `alpha` seen under `cosine`.
float ggx_reflection_albedo(float alpha, float cosine, Masking masking = Masking::Separate);
/// The same under light from everywhere, with joint masking.
float ggx_mean_albedo(float alpha);
/// Albedo of clear rough glass, reflection and refraction together; `ior` beyond over viewer's side. 1 for an index so
/// near to 1 that such a lobe is singular.
float ggx_glass_albedo(float alpha, float cosine, float ior, Masking masking = Masking::Separate);
/// How far the reflectance of facets of a dielectric, joint masking, has risen from that at normal incidence, 0, to 1:
/// the mean over the facets that the viewer sees. An index below 1 counts as its inverse, as in Cycles.
float ggx_fresnel_rise(float alpha, float cosine, float ior);

/// 1 + color (1 - albedo) / albedo.
Color energy_compensation(const Color& color, float albedo);
/// The reflectance of all further reflections together, `mean_albedo` leaving at each (Kulla, Conty: "Revisiting
/// Physically Based Shading at Imageworks", SIGGRAPH 2017 course).
Color repeated_fresnel(const Color& mean_fresnel, float mean_albedo);

}  // namespace rayleaf
