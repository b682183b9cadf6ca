// How much light of a sampled light arrives: nothing behind opaque surfaces, a product behind transparent ones.
#pragma once

#include "integrators/bounces.h"
#include "scene/scene.h"

namespace rayleaf {

/// The ray from a point to a light. Empty where nothing can be in the way.
std::optional<Ray> shadow_ray(const Scene& scene, const SurfacePoint& point, const LightSample& light);

/// Share of the light that reaches `point`. `differential` is the shadow ray's where it leaves the point.
Color shadow_transmittance(const Scene& scene, const SurfacePoint& point, const LightSample& light,
                           const RayDifferential& differential, const Bounces& bounces, const RayWidening& widening);

/// Share of light that surfaces let straight through along `ray`, which is of the given kind and in the given state;
/// more than `transparent_left` transparent surfaces let nothing through.
Color free_share(const Scene& scene, Ray ray, RayDifferential differential, Visibility kind, PathState state,
                 int transparent_left, const RayWidening& widening);

}  // namespace rayleaf
