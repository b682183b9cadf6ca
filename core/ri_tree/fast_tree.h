// The ray cache that renders: thread-safe.
#pragma once

#include "ri_tree/reference_tree.h"

#include <mutex>

namespace rayleaf {

class FastTree final : public RayCache {
  public:
    /// Throws InputError for settings without meaning. Nothing is sampled yet.
    FastTree(std::shared_ptr<const Shape> shape, const SampleSettings& samples, const RayCacheSettings& settings);

    void ask(std::span<const Ray> rays, std::span<const RaySpacing> spacings, std::span<CachedAnswer> answers,
             Uninterpolated others) override;
    using RayCache::ask;
    OutputRay trace(const Ray& object_ray) const override;
    RayCacheStatistics statistics() const override;

    /// The final cell that answers a ray, whether or not it is held; empty for a ray that is none or misses the box.
    std::optional<CellKey> final_cell(const Ray& object_ray);
    const LineSpace& space() const { return tree_.space(); }
    const SampleTracer& tracer() const { return tree_.tracer(); }

  private:
    mutable std::mutex mutex_;
    ReferenceTree tree_;
};

}  // namespace rayleaf
