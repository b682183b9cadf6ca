// Ray caches that live longer than a frame. The caller owns the store and hands it to each render; without one, every
// render starts with empty caches.
//
// Idea: a cache depends on the content of its shape, on what a sample is, and on its thresholds, so these are its key.
// An object that moves keeps its cache; one that changes shape gets a new one, and the old one goes before
// (drop_changed). One whose material changes holds both for a frame: another view layer may ask for the old one. A kept
// cache interpolates more from frame to frame (RayCache::next_frame), within the same error.
//
// Scenes that are rendered in turn, as those of one composited frame, share what is equal: each has its own frames, and
// a cache goes when no scene has used it in its last frame.
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

/// One scene's view of the caches that are kept. Thread-safe.
class RayCacheStore {
  public:
    /// An object and the shape it has in a frame.
    struct ObjectShape {
        std::string object;
        ContentHash shape;
    };

    /// With nothing kept, for a scene without a name.
    RayCacheStore() : shared_(std::make_shared<Shared>()) {}
    /// The view of the scene of that name, of the same caches.
    RayCacheStore of_scene(const std::string& name) const { return RayCacheStore(shared_, name); }

    /// Drops what objects of this scene held that have another shape now, unless this frame has used it already,
    /// another of the objects has that shape, or another scene holds it. Give all of a scene, before the first is asked
    /// for.
    void drop_changed(std::span<const ObjectShape> shapes);
    /// The cache of that key, made where there is none for that object.
    std::shared_ptr<RayCache> find_or_make(const RayCacheKey& key, const std::string& object,
                                           const std::function<std::shared_ptr<RayCache>()>& make);
    /// Drops the caches that this scene did not ask for since its last call and no other scene holds, and tells the
    /// others that it has asked. Call it between frames of the scene, while no scene is rendered.
    void next_frame();
    /// Of all scenes.
    size_t count() const;
    uint64_t bytes() const;

  private:
    /// What a scene knows of a cache.
    struct Holder {
        std::string object;  ///< that asked for it first
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
    /// Takes this scene from the entries of which `is_over` says so, by key and holder.
    template <typename IsOver>
    void let_go(const IsOver& is_over);
};

}  // namespace rayleaf
