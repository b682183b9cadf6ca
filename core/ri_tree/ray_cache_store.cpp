#include "ri_tree/ray_cache_store.h"

#include <algorithm>

namespace rayleaf {

std::optional<RayCacheKey> key_of(const Shape& shape, const SampleSettings& samples, const RayCacheSettings& settings) {
    const std::optional<ContentHash> content = shape.content_hash();
    if (!content) return std::nullopt;
    RayCacheKey key;
    key.shape = *content;
    key.kind = samples.kind;
    key.ior = samples.kind == OutputKind::Glass ? samples.ior : 0.0;
    key.most_interior_hits = samples.kind == OutputKind::Glass ? samples.most_interior_hits : 0;
    key.facet_tolerance = samples.facet_tolerance;
    key.distance_threshold = settings.distance_threshold;
    key.angle_threshold = settings.angle_threshold;
    key.direction_threshold = settings.direction_threshold;
    key.pruned_share = settings.pruned_share;
    key.rays_per_cell = settings.rays_per_cell;
    key.depth_limit = settings.depth_limit;
    key.mixed_depth_limit = settings.mixed_depth_limit;
    key.cache_bytes = settings.cache_bytes;
    return key;
}

template <typename IsOver>
void RayCacheStore::let_go(const IsOver& is_over) {
    for (auto& [key, entry] : shared_->entries) {
        const auto own = entry.scenes.find(scene_);
        if (own != entry.scenes.end() && is_over(key, own->second)) entry.scenes.erase(own);
    }
    std::erase_if(shared_->entries, [](const auto& item) { return item.second.scenes.empty(); });
}

void RayCacheStore::drop_changed(std::span<const ObjectShape> shapes) {
    const std::scoped_lock lock(shared_->mutex);
    let_go([&](const RayCacheKey& key, const Holder& holder) {
        if (holder.used) return false;
        const auto is_object = [&](const ObjectShape& each) { return each.object == holder.object; };
        const auto is_shape = [&](const ObjectShape& each) { return each.shape == key.shape; };
        return std::any_of(shapes.begin(), shapes.end(), is_object) &&
               std::none_of(shapes.begin(), shapes.end(), is_shape);
    });
}

std::shared_ptr<RayCache> RayCacheStore::find_or_make(const RayCacheKey& key, const std::string& object,
                                                      const std::function<std::shared_ptr<RayCache>()>& make) {
    const std::scoped_lock lock(shared_->mutex);
    const auto known = shared_->entries.find(key);
    Entry& entry = known != shared_->entries.end() ? known->second
                                                   : shared_->entries.emplace(key, Entry{make(), {}}).first->second;
    entry.scenes.try_emplace(scene_, Holder{object, true}).first->second.used = true;
    return entry.cache;
}

void RayCacheStore::next_frame() {
    const std::scoped_lock lock(shared_->mutex);
    let_go([](const RayCacheKey&, const Holder& holder) { return !holder.used; });
    for (auto& [key, entry] : shared_->entries) {
        const auto own = entry.scenes.find(scene_);
        if (own == entry.scenes.end()) continue;
        own->second.used = false;
        entry.cache->next_frame();
    }
}

size_t RayCacheStore::count() const {
    const std::scoped_lock lock(shared_->mutex);
    return shared_->entries.size();
}

uint64_t RayCacheStore::bytes() const {
    const std::scoped_lock lock(shared_->mutex);
    uint64_t sum = 0;
    for (const auto& [key, entry] : shared_->entries) sum += entry.cache->statistics().bytes;
    return sum;
}

}  // namespace rayleaf
