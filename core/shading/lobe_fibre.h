// Lobes of fibres, which scatter light around themselves: hair. They know no inside and no outside: what a lobe sends
// through the fibre has left it on the other side.
//
// HairReflection and HairTransmission are Blender's Hair BSDF: Marschner's longitudinal and azimuthal parts as simple
// distributions. HairFibre is the Principled Hair BSDF (Chiang, Bitterli, Tappan, Burley: "A Practical and Controllable
// Hair and Fur Model for Production Path Tracing", Eurographics 2016), with the azimuthal offset of the point itself.
#pragma once

#include "shading/lobes.h"

namespace rayleaf {

/// The Hair BSDF reflects and transmits by the side of the facet, as in Cycles.
LobeValue evaluate_fibre_lobe(const Lobe& lobe, const Vec3f& outgoing, const Vec3f& incoming, Side side);
std::optional<LobeDirection> sample_fibre_lobe(const Lobe& lobe, const Vec3f& outgoing, const Vec3f& random);
/// What a fibre scatters in all, about.
Color fibre_albedo(const Lobe& lobe);

/// Sine of the angle around the fibre between the viewer and `normal`, -1..1; `along` is the fibre's unit direction.
float fibre_offset(const Vec3f& along, const Vec3f& outgoing, const Vec3f& normal);
/// Of an angle within a quarter turn.
inline float cosine_of(float sine) {
    return std::sqrt(std::max(1.0f - sine * sine, 0.0f));
}
/// Sine and cosine of an angle to the plane across a fibre.
struct SineCosine {
    float sine, cosine;
};
/// Longitudinal scattering of variance `v` (d'Eon et al. 2011, equation 7): density over `out`'s sine.
float longitudinal_density(const SineCosine& in, const SineCosine& out, float v);
/// A sample of it by two numbers in [0,1).
SineCosine longitudinal_sample(const SineCosine& in, float v, float u, float turn);

/// Absorption over a radius that makes many fibres look like `color` (section 4.2 of the paper).
Color absorption_of_color(const Color& color, float radial_roughness);
/// The same of melanin, 0..1, of which the share `redness` is pheomelanin.
Color absorption_of_melanin(float melanin, float redness);
/// The variance along the fibre and the scale around it for roughnesses of 0..1 (equations 7 and 8).
float longitudinal_variance(float roughness);
float azimuthal_scale(float roughness);

}  // namespace rayleaf
