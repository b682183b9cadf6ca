// Answers the tracer's questions, one ray in the local space of a shape, from a ray cache, which is in object space.
#pragma once

#include "ri_tree/ray_cache.h"
#include "ri_tree/sample_tracer.h"
#include "trace/local_ray_cache.h"

#include <memory>
#include <vector>

namespace rayleaf {

class RayCacheAdapter final : public LocalRayCache {
  public:
    /// `neighbour_scale`: distance of a picture's neighbouring rays over what their differentials say. Differentials
    /// assume one sample a pixel; with n samples, rays lie closer by the root of n.
    RayCacheAdapter(uint32_t number, std::shared_ptr<RayCache> cache, std::shared_ptr<const Shape> shape,
                    OutputKind kind, double neighbour_scale, const CancelToken& cancel = kNeverCancelled);

    ObjectAnswer ask(const Vec3d& origin, const Vec3d& direction, const RayNeighbours& neighbours) const override;
    LengthAnswer ask_length(const Vec3d& origin, const Vec3d& direction,
                            const RayNeighbours& neighbours) const override;

    const RayCache& cache() const { return *cache_; }

  private:
    std::shared_ptr<RayCache> cache_;
    std::shared_ptr<const Shape> shape_;
    OutputKind kind_;
    double neighbour_scale_;
    double half_extent_;  ///< local units
    /// By class, an element that has it: whose material is the class's. Empty where one material is on everything.
    std::vector<uint32_t> element_of_class_;

    CachedAnswer answer(const Vec3d& origin, const Vec3d& direction, const RayNeighbours& neighbours,
                        HitChanges& changes) const;
    void list_elements(const CancelToken& cancel);
};

}  // namespace rayleaf
