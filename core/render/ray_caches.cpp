#include "render/ray_caches.h"

#include "render/ray_cache_probe.h"
#include "ri_tree/fast_tree.h"

#include <algorithm>

namespace rayleaf {
namespace {

RayCacheStatistics since(const RayCacheStatistics& before, RayCacheStatistics now) {
    for (size_t i = 0; i < kAnswerKinds; ++i) now.answers[i] -= before.answers[i];
    now.samples_taken -= before.samples_taken;
    now.prunes -= before.prunes;
    return now;
}

std::shared_ptr<RayCache> make(const PlannedRayCache& planned, const CancelToken& cancel) {
    return std::make_unique<FastTree>(planned.shape, planned.samples, planned.interpolation.thresholds, cancel);
}

/// What objects look like in this frame, by the name that the store knows them by.
std::vector<RayCacheStore::ObjectShape> shapes_of(const std::vector<PlannedRayCache>& all) {
    std::vector<RayCacheStore::ObjectShape> shapes;
    for (const PlannedRayCache& planned : all) {
        const std::optional<ContentHash> content = planned.shape->content_hash();
        if (content && !planned.objects.empty()) shapes.push_back({planned.objects.front(), *content});
    }
    return shapes;
}

/// Where a target error is set nobody knows yet how many samples there will be.
Settings likely(Settings settings) {
    constexpr int kLikely = 64;
    if (settings.target_error > 0.0) settings.samples = std::min(settings.samples, kLikely);
    return settings;
}

/// Thresholds that leave room for noise.
void tighten(RayCacheSettings& own, double target) {
    const RayCacheSettings wanted = quality_settings(kInterpolationShare * target);
    own.distance_threshold = std::min(own.distance_threshold, wanted.distance_threshold);
    own.direction_threshold = std::min(own.direction_threshold, wanted.direction_threshold);
    own.angle_threshold = std::min(own.angle_threshold, wanted.angle_threshold);
    own.depth_limit = std::max(own.depth_limit, wanted.depth_limit);
    own.mixed_depth_limit = std::max(own.mixed_depth_limit, wanted.mixed_depth_limit);
}

}  // namespace

bool RayCaches::any_used() const {
    return std::any_of(frame_.begin(), frame_.end(), [](const FrameCache& each) { return each.cache != nullptr; });
}

RayCaches::RayCaches(const SceneDescription& description, Scene& scene, const Settings& asked, RayCacheStore* store,
                     const CancelToken& cancel) {
    const Settings settings = likely(asked);
    const double neighbour_scale = 1.0 / std::sqrt(settings.samples);
    std::vector<PlannedRayCache> undecided;
    std::vector<size_t> places;
    std::vector<PlannedRayCache> all = plan_ray_caches(description, scene, settings, cancel);
    if (store && store->count() > 0) store->drop_changed(shapes_of(all));
    for (PlannedRayCache& planned : all) {
        if (settings.target_error > 0.0) tighten(planned.interpolation.thresholds, settings.target_error);
        frame_.push_back({std::move(planned), nullptr, {}, {}});
        FrameCache& each = frame_.back();
        each.reason = each.planned.obstacle;
        if (!each.reason.empty()) continue;
        if (each.planned.interpolation.mode == RayInterpolationMode::Auto) {
            undecided.push_back(each.planned);
            places.push_back(frame_.size() - 1);
        } else {
            use(each, scene, neighbour_scale, store, nullptr, cancel);
        }
    }
    const std::vector<ProbeResult> results = probe_ray_caches(undecided, scene, settings, neighbour_scale, cancel);
    for (size_t i = 0; i < results.size(); ++i) {
        FrameCache& each = frame_[places[i]];
        each.reason = results[i].reason;
        if (results[i].pays) use(each, scene, neighbour_scale, store, results[i].cache, cancel);
    }
}

void RayCaches::use(FrameCache& each, Scene& scene, double neighbour_scale, RayCacheStore* store,
                    const std::shared_ptr<RayCache>& made, const CancelToken& cancel) {
    const PlannedRayCache& planned = each.planned;
    const std::optional<RayCacheKey> key =
        store ? key_of(*planned.shape, planned.samples, planned.interpolation.thresholds) : std::nullopt;
    const auto make_one = [&] { return made ? made : make(planned, cancel); };
    each.cache = key ? store->find_or_make(*key, planned.objects.front(), make_one) : make_one();
    each.before = each.cache->statistics();
    const auto number = static_cast<uint32_t>(&each - frame_.data()) + 1;
    const auto object = std::make_shared<const RayCacheAdapter>(number, each.cache, planned.shape, planned.samples.kind,
                                                                neighbour_scale, cancel);
    scene.set_ray_cache(planned.instances, object);
}

std::vector<RayCacheReport> RayCaches::report() const {
    std::vector<RayCacheReport> reports;
    for (const FrameCache& each : frame_) {
        const PlannedRayCache& planned = each.planned;
        reports.push_back({planned.objects, planned.instances.size(), planned.samples.kind, planned.interpolation.mode,
                           each.cache != nullptr, each.reason,
                           each.cache ? since(each.before, each.cache->statistics()) : RayCacheStatistics{}});
    }
    return reports;
}

}  // namespace rayleaf
