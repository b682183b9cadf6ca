// Rays that go on from another place: Blender's Ray Portal BSDF.
#pragma once

#include "integrators/medium_stack.h"
#include "integrators/vertex.h"

namespace rayleaf {

/// Of the light that the vertex does not scatter, the share that comes by its portal.
inline float portal_share(const Closures& closures) {
    const float portal = average(closures.portal.weight);
    return portal > 0.0f ? std::min(portal / average(closures.unscattered()), 1.0f) : 0.0f;
}

/// The ray that goes on from the vertex's portal. `media` are those on the viewer's side, and become those that it
/// starts in. (Cycles keeps those of the viewer's side, wherever the portal leads.)
Ray behind_portal(const Scene& scene, const Vertex& vertex, MediumStack& media);

}  // namespace rayleaf
