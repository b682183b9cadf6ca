#include "scene/ray_interpolation.h"

#include "base/error.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rayleaf {
namespace {

void check(const std::string& object, const char* argument, double value, double least, double most) {
    if (!(value >= least && value <= most))
        throw InputError(object, argument, number_text(value),
                         "a number from " + number_text(least) + " to " + number_text(most));
}

}  // namespace

RayCacheSettings thresholds_for(double error) {
    return quality_settings(error);
}

void validate(const std::string& object, const RayInterpolation& interpolation) {
    constexpr double kAny = std::numeric_limits<double>::infinity();
    const RayCacheSettings& t = interpolation.thresholds;
    check(object, "distance threshold", t.distance_threshold, 0, kAny);
    check(object, "angle threshold", t.angle_threshold, 0, kAny);
    check(object, "direction threshold", t.direction_threshold, 0, kAny);
    check(object, "depth limit", t.depth_limit, 0, 60);
    check(object, "rays per cell", t.rays_per_cell, 0, kAny);
    check(object, "pruned share", t.pruned_share, 0x1p-20, 1);
}

}  // namespace rayleaf
