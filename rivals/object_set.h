// Several objects in one space, each answered by a ray cache, by tracing, or in the image plane, asked as one: for
// benchmarks and tests.
#pragma once

#include "ri_tree/path_answer.h"
#include "ri_tree/ray_cache.h"
#include "rivals/image_plane.h"

#include <memory>
#include <span>
#include <vector>

namespace rayleaf {

/// Traces every ray by a cache's own tracer, without asking the cache.
class TracedObject final : public RayCache {
  public:
    explicit TracedObject(const RayCache& cache) : cache_(&cache) {}
    using RayCache::ask;
    void ask(const RayQuestions& questions, std::span<CachedAnswer> answers, std::span<HitChanges> changes) override;
    OutputRay trace(const Ray& object_ray) const override { return cache_->trace(object_ray); }
    RayCacheStatistics statistics() const override { return {}; }

  private:
    const RayCache* cache_;
};

struct SetMember {
    std::shared_ptr<const Shape> shape;
    RayCache* cache = nullptr;    ///< or null,
    ImagePlane* plane = nullptr;  ///< then this one answers
};

/// Rays of one batch, neighbours if possible. All but the rays may be empty.
struct SetQuery {
    std::span<const Ray> rays;  ///< object space
    std::span<const RaySpacing> spacings;
    std::span<const Vec2d> points;  ///< in the picture, for image planes
    std::span<const int32_t> left;  ///< the object that a ray has just left and that is not asked again, or kNoObject
};

/// How the answers of several objects along a ray are combined.
enum class SetAnswer : uint8_t { Nearest, SumOfLengths };

class ObjectSet {
  public:
    ObjectSet(std::vector<SetMember> members, SetAnswer wanted);

    void ask(const SetQuery& query, std::span<PathAnswer> answers);

  private:
    /// A box that a ray enters.
    struct Entry {
        float begin;
        int32_t member;
    };

    std::vector<SetMember> members_;
    std::vector<Box3d> boxes_;  ///< theirs
    SetAnswer wanted_;
    // Kept from batch to batch.
    std::vector<Entry> entries_;  ///< of ray i: from i times the number of members on
    std::vector<size_t> next_, ends_;
    std::vector<double> nearest_;
    std::vector<uint32_t> asking_;
    std::vector<Ray> rays_;
    std::vector<RaySpacing> spacings_;
    std::vector<Vec2d> points_;
    std::vector<CachedAnswer> answers_;

    size_t find_entries(const Ray& ray, int32_t left, Entry* entries) const;
    void ask_member(int32_t member, const SetQuery& query);
    void ask_only_member(const SetQuery& query, std::span<PathAnswer> answers);
    bool gather(int32_t member, const SetQuery& query);
    void take(int32_t member, const Ray& ray, const CachedAnswer& got, double& nearest, PathAnswer& answer) const;
};

}  // namespace rayleaf
