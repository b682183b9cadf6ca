// The differential of a ray that a surface scattered.
#pragma once

#include "geometry/surface_point.h"
#include "rays/ray_differential.h"
#include "shading/closures.h"

namespace rayleaf {

/// `differential` is that of the incoming ray, transferred to the surface; `direction` the incoming ray's.
RayDifferential scattered_differential(const RayDifferential& differential, const Vec3f& direction,
                                       const SurfacePoint& point, const LobeSample& sample);

}  // namespace rayleaf
