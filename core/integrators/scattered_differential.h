// The differentials of rays that leave a surface, one rule for each kind (Christensen et al. 2003, section 4).
//
// All take the differential of the incoming ray, transferred to the surface. Where many rays are sent, each stands for
// its share of the directions (rays/ray_differential.h, share_width).
#pragma once

#include "geometry/surface_point.h"
#include "lights/light.h"
#include "rays/ray_differential.h"
#include "shading/closures.h"

namespace rayleaf {

/// Rays that share a lobe or a light where only one goes on from each surface: those of the other samples of a pixel,
/// some of which pass nearby. A global value, as section 4.6 has it for path tracing.
constexpr int kPathSiblings = 16;

/// Path tracing, one ray on from each surface: mirrors and refractions by the surface's curvature, rough lobes at least
/// by a global width. `direction` is the incoming ray's.
RayDifferential scattered_differential(const RayDifferential& differential, const Vec3f& direction,
                                       const SurfacePoint& point, const LobeSample& sample);

/// Section 4.4: the larger of what curvature makes of a mirrored or refracted ray and the lobe's cone shared among
/// `rays`. Singular samples: curvature alone (section 4.2).
RayDifferential glossy_differential(const RayDifferential& differential, const Vec3f& direction,
                                    const SurfacePoint& point, const LobeSample& sample, int rays);

/// Section 4.6: a cosine-weighted hemisphere shared among `rays`; `cosine` is that of `direction` to its pole.
RayDifferential hemisphere_differential(const RayDifferential& differential, const Vec3f& direction, float cosine,
                                        int rays);

/// Sections 4.3 and 4.5: rays to a point draw together there; a light with a size is shared among `rays`.
RayDifferential shadow_differential(const RayDifferential& differential, const LightSample& light, int rays);

}  // namespace rayleaf
