#include "ri_tree/fast_tree.h"

namespace rayleaf {

FastTree::FastTree(std::shared_ptr<const Shape> shape, const SampleSettings& samples, const RayCacheSettings& settings)
    : tree_(std::move(shape), samples, settings) {}

void FastTree::ask(std::span<const Ray> rays, std::span<const RaySpacing> spacings, std::span<CachedAnswer> answers,
                   Uninterpolated others) {
    const std::lock_guard lock(mutex_);
    tree_.ask(rays, spacings, answers, others);
}

OutputRay FastTree::trace(const Ray& object_ray) const {
    return tree_.trace(object_ray);
}

RayCacheStatistics FastTree::statistics() const {
    const std::lock_guard lock(mutex_);
    return tree_.statistics();
}

std::optional<CellKey> FastTree::final_cell(const Ray& object_ray) {
    const std::lock_guard lock(mutex_);
    return tree_.final_cell(object_ray);
}

}  // namespace rayleaf
