// Blender's Principled shader since 4.0: layers, each of which takes from those below it what it reflects itself. From
// the top: sheen of microfibres, a coat of lacquer that may tint, emission, metal, glass, a dielectric's reflection,
// and the diffuse or scattering body.
//
// The models are those of Cycles: metals after Kutz, Hasan, Edmondson, "Novel aspects of the Adobe Standard Material"
// (2023); microfacets hide each other by Smith's joint masking.
#pragma once

#include "shading/closures.h"
#include "shading/subsurface.h"

namespace rayleaf {

struct PrincipledLayers {
    Color weight, base_color;
    float alpha = 1;
    float metallic = 0, roughness = 0.5f;
    float specular_level = 0.5f;          ///< 0.5: the reflectance of `ior`; in proportion otherwise
    Color specular_tint{1, 1, 1};         ///< at normal incidence; of metal, near 82 degrees
    float anisotropic = 0, rotation = 0;  ///< the rotation in turns
    float ior = 1.45f;                    ///< of the body over what surrounds it
    bool from_inside = false;             ///< seen from within the body
    float transmission = 0;
    bool is_sheet = false;  ///< so thin that light leaves where it entered, unbent (since Blender 5.2)
    float sheen = 0, sheen_roughness = 0.5f;
    Color sheen_tint{1, 1, 1};
    float coat = 0, coat_roughness = 0, coat_ior = 1.5f;
    bool coat_by_facets = false;  ///< keeps from what lies below what its facets reflect; else, as if it were smooth
    Color coat_tint{1, 1, 1};     ///< what is left of light that crosses the coat at normal incidence, twice
    Color emission{0, 0, 0};      ///< radiance, below the coat
    float diffuse_roughness = 0;
    float subsurface = 0;  ///< the share of the body's light that scatters below the surface
    Color subsurface_radius{0, 0, 0};
    float subsurface_ior = 1.4f, subsurface_anisotropy = 0;
    SubsurfaceMethod subsurface_method = SubsurfaceMethod::FixedRadius;
    ThinFilm film;                                   ///< over the body, seen from outside
    bool film_on_metal = true;                       ///< over metal too
    Vec3f normal, coat_normal;                       ///< of lobes that mirror, world; unit and on the viewer's side
    Vec3f matte_normal, matte_coat_normal, tangent;  ///< likewise; of the diffuse lobe and of sheen
    Vec3f outgoing;
    bool after_diffuse = false;  ///< light was scattered by a diffuse lobe before: nobody sees where it leaves a body
    bool multiple_scattering = false;  ///< give back the energy that single scattering loses
};

/// Adds the lobes, the emission and the transparency.
void add_principled_layers(const PrincipledLayers& parameters, Closures& closures);

}  // namespace rayleaf
