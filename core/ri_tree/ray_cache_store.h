// Ray caches that live longer than a frame. The caller owns the store and hands it to each render; without one, every
// render starts with empty caches.
//
// Idea: a cache depends on the content of its shape, on the kind of its samples, and on its thresholds: its key.
// An object that moves keeps its cache. One that changes shape gets a new one, and the old one is dropped before
// (drop_changed). One whose material changes keeps both for a frame: another view layer may ask for the old one. A
// cache that is kept interpolates more from frame to frame (RayCache::next_frame), within the same error.
//
// Scenes that are rendered in turn, like those of one composited frame, share equal caches. Each scene has its own
// frames, and a cache is dropped when no scene has used it in its last frame.
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

/// Everything that a cache's answers depend on. A content hash of 128 bits stands for the shape.
struct RayCacheKey {
    ContentHash shape{};
    OutputKind kind = OutputKind::Mirror;
    int most_interior_hits = 0;
    double ior = 0, facet_tolerance = 0;
    double distance_threshold = 0, angle_threshold = 0, direction_threshold = 0, pruned_share = 0;
    double rays_per_cell = 0;
    int depth_limit = 0, mixed_depth_limit = 0;
    uint64_t cache_bytes = 0;  ///< changes no answer, but the memory of a cache

    auto operator<=>(const RayCacheKey&) const = default;  // NOLINT(modernize-use-nullptr): it has no pointers
};
/// Empty for a shape without a content hash.
std::optional<RayCacheKey> key_of(const Shape& shape, const SampleSettings& samples, const RayCacheSettings& settings);

/// One scene's view of the caches that are kept. Thread-safe.
class RayCacheStore {
  public:
    /// An object and the shape it has in a frame.
    struct ObjectShape {
        std::string object;
        ContentHash shape;
    };

    /// An empty store, as seen by a scene without a name.
    RayCacheStore() : shared_(std::make_shared<Shared>()) {}
    /// The same store, as seen by the scene of that name.
    RayCacheStore of_scene(const std::string& name) const { return RayCacheStore(shared_, name); }

    /// Drops the caches of this scene's objects that have changed their shape, unless this frame has used them already,
    /// another object has that shape, or another scene holds them. Call it with all objects of a scene, before it asks
    /// for the first cache.
    void drop_changed(std::span<const ObjectShape> shapes);
    /// The cache with that key; made if there is none.
    std::shared_ptr<RayCache> find_or_make(const RayCacheKey& key, const std::string& object,
                                           const std::function<std::shared_ptr<RayCache>()>& make);
    /// Drops the caches that this scene has not asked for since the last call and that no other scene holds; the others
    /// get their next frame. Call it between frames of the scene, while no scene is rendered.
    void next_frame();
    /// Of all scenes.
    size_t count() const;
    uint64_t bytes() const;

  private:
    /// A scene's use of a cache.
    struct Holder {
        std::string object;  ///< the first that asked for it
        bool used = true;    ///< in this frame
    };
    struct Entry {
        std::shared_ptr<RayCache> cache;
        std::map<std::string, Holder> scenes;  ///< by name; not empty
    };
    struct Shared {
        std::mutex mutex;
        std::map<RayCacheKey, Entry> entries;
    };
    std::shared_ptr<Shared> shared_;
    std::string scene_;

    RayCacheStore(std::shared_ptr<Shared> shared, std::string scene)
        : shared_(std::move(shared)), scene_(std::move(scene)) {}
    /// Removes this scene from the entries for which `is_over(key, holder)` holds.
    template <typename IsOver>
    void let_go(const IsOver& is_over);
};

}  // namespace rayleaf
