// Ray caches that live longer than a frame. The caller owns the store and hands it to each render; without one, every
// render starts with empty caches.
//
// Idea: a cache depends on the content of its shape, on what a sample is, and on its thresholds, so these are its key.
// An object that moves keeps its cache; one that changes shape gets a new one, and the old one goes before
// (drop_changed). One whose material changes holds both for a frame: another view layer may ask for the old one. A kept
// cache interpolates more from frame to frame (RayCache::next_frame), within the same error.
#pragma once

#include "base/content_hash.h"
#include "ri_tree/ray_cache.h"
#include "ri_tree/sample_tracer.h"

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>

namespace rayleaf {

/// All that a cache's answers depend on. A content hash of 128 bits stands for the shape.
struct RayCacheKey {
    ContentHash shape{};
    OutputKind kind = OutputKind::Mirror;
    int most_interior_hits = 0;
    double ior = 0, facet_tolerance = 0;
    double distance_threshold = 0, angle_threshold = 0, direction_threshold = 0, pruned_share = 0;
    double rays_per_cell = 0;
    int depth_limit = 0, mixed_depth_limit = 0;
    uint64_t cache_bytes = 0;  ///< changes no answer, but what a cache may hold

    auto operator<=>(const RayCacheKey&) const = default;  // NOLINT(modernize-use-nullptr): it has no pointers
};
/// Empty for a shape without a content hash.
std::optional<RayCacheKey> key_of(const Shape& shape, const SampleSettings& samples, const RayCacheSettings& settings);

/// Thread-safe.
class RayCacheStore {
  public:
    /// An object and the shape it has in a frame.
    struct ObjectShape {
        std::string object;
        ContentHash shape;
    };

    /// Drops what objects held that have another shape now, unless this frame has used it already, or another of its
    /// objects has that shape. Give all of a scene, before the first is asked for.
    void drop_changed(std::span<const ObjectShape> shapes);
    /// The cache of that key, made where there is none for that object.
    std::shared_ptr<RayCache> find_or_make(const RayCacheKey& key, const std::string& object,
                                           const std::function<std::shared_ptr<RayCache>()>& make);
    /// Drops the caches that were not asked for since the last call, and tells the others. Call it between frames.
    void next_frame();
    size_t count() const;
    uint64_t bytes() const;

  private:
    struct Entry {
        std::shared_ptr<RayCache> cache;
        std::string object;  ///< that it was made for
        bool used = true;
    };
    mutable std::mutex mutex_;
    std::map<RayCacheKey, Entry> entries_;
};

}  // namespace rayleaf
