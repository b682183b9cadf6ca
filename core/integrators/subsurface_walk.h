// The way of light below a surface, from where it enters a body to where it leaves it (shading/subsurface.h).
#pragma once

#include "base/random.h"
#include "integrators/subsurface_guide.h"
#include "integrators/vertex.h"
#include "scene/scene.h"

#include <optional>

namespace rayleaf {

struct SubsurfaceExit {
    Ray ray;                    ///< the last one, inside the body
    Hit hit;                    ///< where it meets the surface
    Color throughput{1, 1, 1};  ///< what is left of light on the way
    Vec3f outwards{0, 0, 1};    ///< how light leaves, as the material is asked there
};

/// Where a ray may begin that enters a body: direction and start inside, with the width of what it does there.
struct SubsurfaceEntry {
    Ray ray;
    uint32_t instance = 0;
    SubsurfaceMedium medium;
    Vec3f normal{0, 0, 1};   ///< outwards, of the facet
    Color carried{1, 1, 1};  ///< what of light enters: channels that carry more have more samples
};

/// Scatters until the surface of the instance is met again, and meets nothing else; empty where light is lost on the
/// way. `dimension` is the first of the sampler's that the walk may use; it takes them from a branch of its own.
std::optional<SubsurfaceExit> walk_below(const Scene& scene, const SubsurfaceEntry& entry, const Sampler& sampler,
                                         uint32_t dimension);

/// Light that a vertex lets into its body: a sample of its Subsurface lobes.
struct SubsurfaceStart {
    const Vertex& vertex;
    const LobeSample& entry;
    PathState state;
    const Sampler& sampler;
    uint32_t dimension = 0;
};

/// Where it leaves the body.
struct SubsurfaceVertex {
    Vertex vertex;              ///< scatters by the cosine
    Color throughput{1, 1, 1};  ///< of entering and of the way
};

/// Empty where light is lost.
std::optional<SubsurfaceVertex> leave_below(const Scene& scene, const SubsurfaceStart& start);

}  // namespace rayleaf
