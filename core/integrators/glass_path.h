// A ray through a body of clear glass, from where it enters to where it leaves, as one step of a path.
//
// The model (scene/material_optics.h, GlassBody) is the same whether the way is interpolated or traced, so that a
// picture does not show which it was.
#pragma once

#include "integrators/vertex.h"
#include "scene/scene.h"

#include <optional>

namespace rayleaf {

struct GlassExit {
    Ray ray;  ///< that leaves
    RayDifferential differential;
    int crossings = 0, total_reflections = 0;  ///< hits from inside: that let the ray out, and that did not
    bool is_cut_off = false;                   ///< by the limit of hits: no ray leaves
};

/// The path through the glass as the hit's ray cache knows it; empty where it does not. `differential`: of the ray that
/// enters, where it hits; so is the one that leaves, unless the cache was asked how the way changes.
std::optional<GlassExit> interpolated_exit(const Scene& scene, const Hit& hit, const RayDifferential& differential,
                                           float time);

/// The way from `entered`, a ray that just passed the surface of `instance`, of at most so many hits from inside. Empty
/// where it finds no end.
std::optional<GlassExit> traced_exit(const Scene& scene, const GlassBody& body, uint32_t instance, const Ray& entered,
                                     const RayDifferential& differential, int most_hits);

}  // namespace rayleaf
