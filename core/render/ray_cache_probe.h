// Whether ray caches would pay in a frame, from a small probe of it.
//
// Idea: some blocks of neighbouring pixels, spread evenly over the picture, are rendered with caches that are made for
// this alone, one a block; what the caches count is set against tracing, in units of one traced ray. Neighbouring
// pixels share cells as they do in the whole picture; how much more they would share in a picture than in a block of it
// is told from what a quarter of each block takes. Before that it is settled which objects are worth a try: making a
// cache costs time too, its tracer's facets are finer than the view's. Counts alone decide, never clocks, nor what
// other frames left in a cache: a frame looks the same alone, in a sequence, or as a part of one on another machine.
#pragma once

#include "base/cancel.h"
#include "ri_tree/ray_cache.h"
#include "scene/ray_cache_plan.h"
#include "scene/scene.h"

#include <memory>
#include <string>
#include <vector>

namespace rayleaf {

struct ProbeResult {
    bool pays = false;
    std::string reason;               ///< with the figures that decided
    std::shared_ptr<RayCache> cache;  ///< for the frame, if it pays; empty
};

/// One result each. The scene is left without the caches that were tried. Throws Cancelled soon after `cancel` says so;
/// caches that were tried may be left then.
std::vector<ProbeResult> probe_ray_caches(const std::vector<PlannedRayCache>& candidates, Scene& scene,
                                          const Settings& settings, double neighbour_scale, const CancelToken& cancel);

}  // namespace rayleaf
