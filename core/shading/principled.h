// Blender's Principled shader up to 3.6: Disney's model of 2012 with the transmission of 2015 (Burley, "Physically
// Based Shading at Disney"; "Extending the Disney BRDF to a BSDF"), with Cycles' choices where Disney's differ.
#pragma once

#include "shading/closures.h"
#include "shading/subsurface.h"

namespace rayleaf {

struct PrincipledParameters {
    Color weight, base_color;
    float metallic = 0, specular = 0.5f, specular_tint = 0, roughness = 0.5f;
    float anisotropic = 0, anisotropic_rotation = 0;  ///< the rotation in turns
    float sheen = 0, sheen_tint = 0, clearcoat = 0, clearcoat_roughness = 0;
    float ior = 1.45f;  ///< beyond the surface over the viewer's side
    float transmission = 0, transmission_roughness = 0;
    Color emission{0, 0, 0};  ///< radiance
    float alpha = 1;
    Vec3f normal, clearcoat_normal, tangent;  ///< world; normals unit and on the viewer's side
    Vec3f matte_normal;                       ///< likewise; of the diffuse lobe and of sheen
    Vec3f outgoing;
    float subsurface = 0;  ///< the share of its colour, and a factor on its radius
    Color subsurface_color{0, 0, 0}, subsurface_radius{0, 0, 0};
    float subsurface_ior = 1.4f, subsurface_anisotropy = 0;
    SubsurfaceMethod subsurface_method = SubsurfaceMethod::FixedRadius;
    bool after_diffuse =
        false;  ///< light was scattered by a diffuse lobe before: where it leaves a body is not visible
    bool multiple_scattering = false;  ///< give back the energy that single scattering loses
};

/// Adds the lobes, the emission and the transparency.
void add_principled(const PrincipledParameters& parameters, Closures& closures);

}  // namespace rayleaf
