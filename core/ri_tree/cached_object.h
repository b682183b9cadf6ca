// A ray cache as the tracer asks it: one ray, in the local space of the shape, and only what a hit needs.
#pragma once

#include "ri_tree/ray_cache.h"
#include "ri_tree/sample_tracer.h"
#include "trace/object_cache.h"

#include <memory>
#include <vector>

namespace rayleaf {

class CachedObject final : public ObjectCache {
  public:
    /// `distance_threshold`: what error to assume where the cache tells none, a share of the half extent.
    /// `neighbour_scale`: how far apart a picture's rays are against what their differentials say. Those are of one
    /// sample a pixel; with n samples rays lie closer by the root of n.
    CachedObject(uint32_t number, std::shared_ptr<RayCache> cache, std::shared_ptr<const Shape> shape, OutputKind kind,
                 double distance_threshold, double neighbour_scale, const CancelToken& cancel = kNeverCancelled);

    ObjectAnswer ask(const Vec3d& origin, const Vec3d& direction, const RayNeighbours& neighbours) const override;
    LengthAnswer ask_length(const Vec3d& origin, const Vec3d& direction,
                            const RayNeighbours& neighbours) const override;

    const RayCache& cache() const { return *cache_; }

  private:
    std::shared_ptr<RayCache> cache_;
    std::shared_ptr<const Shape> shape_;
    OutputKind kind_;
    double assumed_error_;  ///< share of the half extent
    double neighbour_scale_;
    double half_extent_;  ///< local units
    /// By class, an element that has it: whose material is the class's. Empty where one material is on everything.
    std::vector<uint32_t> element_of_class_;

    CachedAnswer answer(const Vec3d& origin, const Vec3d& direction, const RayNeighbours& neighbours,
                        HitChanges& changes) const;
    void list_elements(const CancelToken& cancel);
};

}  // namespace rayleaf
