// Ambient occlusion: how much of the hemisphere above a point is free, weighted by the cosine (Christensen et al. 2003,
// section 4.6).
#pragma once

#include "base/random.h"
#include "integrators/path.h"
#include "integrators/vertex.h"

namespace rayleaf {

/// The rays that ask how free a point is.
struct OcclusionRays {
    int count = 1;
    const Sampler& sampler;
    uint32_t dimension = 0;  ///< the sampler's first
    RayWidening widening;
};

/// The mean over rays from the viewer's side of the surface, no longer than the occlusion distance. Transparent
/// surfaces colour it.
Color ambient_occlusion(const Scene& scene, const PathSettings& settings, const Vertex& vertex,
                        const OcclusionRays& rays);

/// Shading normal on the viewer's side.
inline Vec3f facing_normal(const Vertex& vertex) {
    return vertex.point.normal.dot(vertex.outgoing) < 0.0f ? -vertex.point.normal : vertex.point.normal;
}

}  // namespace rayleaf
