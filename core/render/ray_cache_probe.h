// Estimates by a small probe of a frame whether ray caches make it faster.
//
// Idea: some blocks of neighbouring pixels, spread evenly over the picture, are rendered with temporary caches, a fresh
// one for each block. The cost of the counted operations is compared with tracing, in units of one traced ray.
// Neighbouring pixels share cells as they do in the whole picture; how much more they share in a picture than in a
// block is estimated from a quarter of each block. Not all objects are tried, because making a cache takes time too:
// its tracer's facets are finer than the view's. Only counts decide, never clocks or caches of other frames: a frame
// looks the same alone, in a sequence, or on another machine.
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
    std::string reason;               ///< with the numbers that decided
    std::shared_ptr<RayCache> cache;  ///< for the frame, if it is faster; without cells
};

/// One result for each candidate. The tried caches are removed from the scene. Throws Cancelled soon after `cancel` is
/// set; then tried caches may be left.
std::vector<ProbeResult> probe_ray_caches(const std::vector<PlannedRayCache>& candidates, Scene& scene,
                                          const Settings& settings, double neighbour_scale, const CancelToken& cancel);

}  // namespace rayleaf
