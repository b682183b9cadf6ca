#include "ri_tree/ray_cache.h"

#include "base/error.h"
#include "ri_tree/fast_tree.h"
#include "ri_tree/reference_tree.h"

namespace rayleaf {
namespace {

void require(bool holds, const std::string& name, const char* argument, double got, const char* wanted) {
    if (!holds) throw InputError(name, argument, std::to_string(got), wanted);
}

const char* const kAnswerNames[kAnswerKinds] = {
    "not a ray",           "box missed",       "cell missed",         "interpolated",  "two classes, interpolated",
    "two classes, missed", "traced: classes",  "traced: few corners", "traced: angle", "traced: origin in the box",
    "traced: large cell",  "traced: few rays", "traced: error"};

}  // namespace

std::span<const char* const> answer_names() {
    return kAnswerNames;
}

const RayCacheSettings& checked(const std::string& name, const RayCacheSettings& settings) {
    require(settings.distance_threshold >= 0.0, name, "distance_threshold", settings.distance_threshold, "0 or more");
    require(settings.angle_threshold >= 0.0, name, "angle_threshold", settings.angle_threshold, "0 or more");
    require(settings.direction_threshold >= 0.0, name, "direction_threshold", settings.direction_threshold,
            "0 or more");
    require(settings.depth_limit >= 0 && settings.depth_limit <= kGreatestCellDepth, name, "depth_limit",
            settings.depth_limit, "0 to 60");
    require(settings.mixed_depth_limit >= 0 && settings.mixed_depth_limit <= kGreatestCellDepth, name,
            "mixed_depth_limit", settings.mixed_depth_limit, "0 to 60");
    require(settings.pruned_share > 0.0 && settings.pruned_share <= 1.0, name, "pruned_share", settings.pruned_share,
            "above 0, at most 1");
    return settings;
}

std::unique_ptr<RayCache> make_ray_cache(RayCacheKind kind, std::shared_ptr<const Shape> shape,
                                         const SampleSettings& samples, const RayCacheSettings& settings) {
    if (kind == RayCacheKind::Reference) return std::make_unique<ReferenceTree>(std::move(shape), samples, settings);
    return std::make_unique<FastTree>(std::move(shape), samples, settings);
}

}  // namespace rayleaf
