// How much light of a sampled light arrives: nothing behind opaque surfaces, a product behind transparent ones.
#pragma once

#include "integrators/bounces.h"
#include "scene/scene.h"

namespace rayleaf {

/// Share of the light that reaches `point`. `differential` is the footprint at the point, for textured transparency.
Color shadow_transmittance(const Scene& scene, const SurfacePoint& point, const LightSample& light,
                           const RayDifferential& differential, const Bounces& bounces);

}  // namespace rayleaf
