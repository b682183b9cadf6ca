#include "scene/ray_interpolation.h"

#include "base/error.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rayleaf {
namespace {

/// At the default error: twice the default depth's cells would be needed for half the error in all four line axes, and
/// corners more than this apart are beyond what a linear blend of directions can follow.
constexpr int kDefaultDepth = 28;
constexpr double kDefaultAngle = 20.0 * kPi / 180.0;
/// At the default error a direction may be off by one degree.
constexpr double kRadiansPerError = kPi / 180.0 / kDefaultRayError;
constexpr int kLeastDepth = 12, kMostDepth = 44;

void check(const std::string& object, const char* argument, double value, double least, double most) {
    if (!(value >= least && value <= most))
        throw InputError(object, argument, std::to_string(value),
                         "a number from " + std::to_string(least) + " to " + std::to_string(most));
}

}  // namespace

RayCacheSettings thresholds_for(double error) {
    if (!(error > 0.0 && std::isfinite(error)))
        throw InputError("ray interpolation", "error", std::to_string(error), "a finite number above 0");
    // A linear blend is off by the square of the cell's size: half the size along four axes, four halvings, is a
    // quarter of the error. Angles go with the size.
    const double finer = kDefaultRayError / error;
    RayCacheSettings thresholds;
    thresholds.distance_threshold = error;
    thresholds.direction_threshold = kRadiansPerError * error;
    thresholds.angle_threshold = std::min(kDefaultAngle / std::sqrt(finer), kPi / 2.0);
    const int depth = kDefaultDepth + static_cast<int>(std::lround(2.0 * std::log2(finer)));
    thresholds.depth_limit = std::clamp(depth, kLeastDepth, kMostDepth);
    return thresholds;
}

void validate(const std::string& object, const RayInterpolation& interpolation) {
    constexpr double kAny = std::numeric_limits<double>::infinity();
    const RayCacheSettings& t = interpolation.thresholds;
    check(object, "distance threshold", t.distance_threshold, 0, kAny);
    check(object, "angle threshold", t.angle_threshold, 0, kAny);
    check(object, "direction threshold", t.direction_threshold, 0, kAny);
    check(object, "depth limit", t.depth_limit, 0, 60);
    check(object, "pruned share", t.pruned_share, 0x1p-20, 1);
}

}  // namespace rayleaf
