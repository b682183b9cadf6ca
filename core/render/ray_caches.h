// The ray caches of one frame: made or found, tried where that is to be decided, and given to the scene.
#pragma once

#include "ri_tree/ray_cache_adapter.h"
#include "ri_tree/ray_cache_store.h"
#include "scene/ray_cache_plan.h"
#include "scene/scene.h"

#include <memory>
#include <string>
#include <vector>

namespace rayleaf {

/// One cache, or why there is none.
struct RayCacheReport {
    std::vector<std::string> objects;  ///< the first few that share it
    size_t instances = 0;
    OutputKind kind = OutputKind::Simple;
    RayInterpolationMode mode = RayInterpolationMode::On;
    bool used = false;
    std::string reason;             ///< of a decision by a probe, or why there can be none
    RayCacheStatistics statistics;  ///< of this frame; what is held, at its end
};

class RayCaches {
  public:
    /// Plans caches for the scene and gives it those that are on. `store` may be null. Throws Cancelled soon after
    /// `cancel` says so.
    RayCaches(const SceneDescription& description, Scene& scene, const Settings& asked, RayCacheStore* store,
              const CancelToken& cancel = kNeverCancelled);

    bool any() const { return !frame_.empty(); }
    bool any_used() const;
    /// What happened since construction.
    std::vector<RayCacheReport> report() const;

  private:
    struct FrameCache {
        PlannedRayCache planned;
        std::shared_ptr<RayCache> cache;  ///< null: not used
        RayCacheStatistics before;
        std::string reason;
    };
    std::vector<FrameCache> frame_;

    /// `made` by a probe, or null.
    void use(FrameCache& each, Scene& scene, double neighbour_scale, RayCacheStore* store,
             const std::shared_ptr<RayCache>& made, const CancelToken& cancel);
};

}  // namespace rayleaf
