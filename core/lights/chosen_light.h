// A sampled direction of a light, once the choice of that light counts.
#pragma once

#include "lights/lamp_sample.h"
#include "lights/light.h"

#include <algorithm>
#include <cmath>

namespace rayleaf {

/// The choice of this light taken into account; empty where nothing that floats can hold arrives.
inline std::optional<LightSample> chosen(const LampSample& from, double probability, uint16_t visibility,
                                         bool casts_shadow) {
    std::optional<LightSample> result(std::in_place);
    LightSample& sample = *result;
    sample.direction = Vec3f(from.direction);
    sample.distance = from.distance;
    sample.target = from.target;
    sample.target_anchor = from.target_anchor;
    sample.radiance = from.radiance;
    sample.density = static_cast<float>(std::min(from.density * probability, kLargestDensity));
    sample.delta = from.delta;
    sample.casts_shadow = casts_shadow;
    sample.visibility = visibility;
    if (!is_usable(sample.radiance) || is_black(sample.radiance) || !(sample.density > 0) ||
        !is_finite(sample.direction))
        result.reset();
    return result;
}

/// The state of a path with this ray length.
inline PathState of_length(PathState path, double length) {
    path.ray_length = static_cast<float>(length);
    return path;
}

}  // namespace rayleaf
