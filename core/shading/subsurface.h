// Light that enters a body and leaves it elsewhere: the lobe that stands for it, and the medium that a walk goes
// through (Chiang, Kutz, Burley: "Practical and Controllable Subsurface Scattering for Production Path Tracing",
// SIGGRAPH 2016; the fit to anisotropic media of Wrenninge, Villemin, Hery: "Path Traced Subsurface Scattering using
// Anisotropic Phase Functions and Non-Exponential Free Flights", 2017; with a mean free path, van de Hulst's albedo as
// the OpenPBR Surface specification gives it, section "Subsurface").
#pragma once

#include "shading/closures.h"

#include <cstdint>

namespace rayleaf {

/// How the radius is meant: scaled as in older models; such that light spreads that far in a body of that index; or as
/// the mean way between two scatterings. By a profile no light walks: the distance alone says how much of it leaves
/// where (integrators/subsurface_probe.h); the radius is scaled as in older models.
enum class SubsurfaceMethod : uint8_t { FixedRadius, Physical, MeanFreePath, Profile };

struct SubsurfaceParameters {
    Color weight{0, 0, 0};  ///< times the albedo already
    Color albedo{0, 0, 0};  ///< of the surface
    Color radius{0, 0, 0};  ///< as an artist sets it, world units
    float ior = 1.4f;
    float anisotropy = 0;  ///< -1..1
    SubsurfaceMethod method = SubsurfaceMethod::FixedRadius;
    /// By facets of `entry_alpha` and `entry_ior`, not all ways alike; by the physical method either, by chance.
    bool is_refracted = false;
    float entry_alpha = 1, entry_ior = 1.4f;
    Vec3f normal{0, 0, 1};
    bool is_disney = false;  ///< darkened at grazing, where light enters and leaves, with Disney's retro-reflection
    float roughness = 0;     ///< of that
};

/// Channels too small to scatter in are diffuse.
void add_subsurface(const SubsurfaceParameters& parameters, Closures& closures);

/// What a walk goes through.
struct SubsurfaceMedium {
    Color extinction{1, 1, 1};  ///< per world unit
    Color albedo{0, 0, 0};      ///< of one scattering
    Color factor{1, 1, 1};      ///< on the light of a walk
    float anisotropy = 0;       ///< of the phase function (Henyey, Greenstein)
};
SubsurfaceMedium subsurface_medium(const Lobe& lobe);

}  // namespace rayleaf
