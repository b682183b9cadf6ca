#include "ri_tree/ray_cache.h"

#include "base/error.h"

#include <algorithm>
#include <cmath>

namespace rayleaf {
namespace {

void require(bool holds, const std::string& name, const char* argument, double got, const char* wanted) {
    if (!holds) throw InputError(name, argument, number_text(got), wanted);
}

const char* const kAnswerNames[kAnswerKinds] = {"not a ray",
                                                "box missed",
                                                "cell missed",
                                                "interpolated",
                                                "two classes, interpolated",
                                                "two classes, missed",
                                                "followed, missed",
                                                "followed",
                                                "traced: classes",
                                                "traced: few corners",
                                                "traced: angle",
                                                "traced: origin in the box",
                                                "traced: large cell",
                                                "traced: few rays",
                                                "traced: error"};

/// The error that the thresholds below belong to, and its depth limit: so deep that the number of crossing rays decides
/// how small cells get.
constexpr double kUsualError = 0.005;
constexpr int kUsualDepth = 36;
/// The error is largest at the centres; the mean over a cell's rays is a tenth of that.
constexpr double kDistancePerError = 10.0;
constexpr double kUsualDirection = kPi / 180.0, kUsualAngle = kPi / 6.0;
/// Directions more than a right angle apart say nothing about those in between.
constexpr double kMostAngle = kPi / 2.0;

}  // namespace

std::span<const char* const> answer_names() {
    return kAnswerNames;
}

RayCacheTotals totals_of(const RayCacheStatistics& statistics) {
    RayCacheTotals totals;
    for (size_t i = 0; i < kAnswerKinds; ++i) {
        const auto by = static_cast<AnsweredBy>(i);
        const uint64_t count = statistics.answers[i];
        totals.queries += count;
        if (is_traced(by))
            totals.traced += count;
        else if (by == AnsweredBy::Interpolated || by == AnsweredBy::TwoClassInterpolated)
            totals.interpolated += count;
        else if (by == AnsweredBy::Followed)
            totals.followed += count;
        else if (by != AnsweredBy::NotARay && by != AnsweredBy::BoxMissed)
            totals.missed += count;
    }
    return totals;
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
    require(settings.rays_per_cell >= 0.0, name, "rays_per_cell", settings.rays_per_cell, "0 or more");
    require(settings.pruned_share > 0.0 && settings.pruned_share <= 1.0, name, "pruned_share", settings.pruned_share,
            "above 0, at most 1");
    return settings;
}

RayCacheSettings quality_settings(double error) {
    if (!(error > 0.0 && std::isfinite(error)))
        throw InputError("ray interpolation", "error", number_text(error), "a finite number above 0");
    const double coarser = error / kUsualError;
    RayCacheSettings settings;
    settings.distance_threshold = kDistancePerError * error;
    settings.direction_threshold = kUsualDirection * coarser;
    settings.angle_threshold = std::min(kUsualAngle * std::sqrt(coarser), kMostAngle);
    // Four more halvings, one along each axis, divide the error by sixteen.
    const double steps = std::max(std::round(-std::log2(coarser) / 4.0), 0.0);
    settings.depth_limit = static_cast<int>(std::min(kUsualDepth + 4.0 * steps, double{kGreatestCellDepth}));
    settings.mixed_depth_limit = settings.depth_limit;
    return settings;
}

}  // namespace rayleaf
