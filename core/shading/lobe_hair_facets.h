// Hair as a rough dielectric fibre: W. Huang, M. B. Hullin, J. Hanika, "A Microfacet-based Hair Scattering Model",
// Computer Graphics Forum 41 (4), 2022. Blender's Principled Hair BSDF since 4.0.
//
// A fibre is a cylinder of round or elliptical cross section. Its surface is made of tilted scales, and these of GGX
// facets. Light is followed through it from facet to facet: reflected (R), let through (TT), reflected once inside
// (TRT); what is reflected more often is one wide distribution, as in Chiang's model.
//
// The value for two directions is the mean over the offsets from the middle at which light may meet the fibre, and over
// the facets that it meets inside. The paper integrates over offsets by Simpson's rule; here they are even, from a
// random one, so that values are right in the mean at any roughness. A value is the same each time for the same
// directions. Where the camera sees the fibre wider than a pixel, light comes by the offset of the point.
//
// The density of sampling is that mean too, so it is not known: `is_alone` in shading/lobes.h.
#pragma once

#include "shading/lobes.h"

namespace rayleaf {

/// Needs neither the side nor the lobe's view.
LobeValue evaluate_hair_facets(const Lobe& lobe, const Vec3f& outgoing, const Vec3f& incoming);
std::optional<LobeDirection> sample_hair_facets(const Lobe& lobe, const Vec3f& outgoing, const Vec3f& random);
/// Of a smooth, round fibre.
Color hair_facets_albedo(const Lobe& lobe, const Vec3f& outgoing);
/// Whether the fibre's cross section, seen from `outgoing`, does not reach the point that was hit: a strand is traced
/// as a round one, by the longer axis.
bool passes_hair_facets(const Lobe& lobe, const Vec3f& outgoing);

}  // namespace rayleaf
