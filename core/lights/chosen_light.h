// A sampled direction of a light, once the choice of that light counts.
#pragma once

#include "lights/lamp_sample.h"
#include "lights/light.h"

#include <algorithm>
#include <cmath>

namespace rayleaf {

/// Takes into account with which probability the light was chosen; empty where nothing that floats can hold arrives.
inline void choose_by(double probability, Maybe<LightSample>& light) {
    constexpr float kMostRadiance = 1e37f;  // can be multiplied on
    constexpr float kMostOfUnit = 2.0f;     // the sum of the sizes of a unit vector's components
    const auto size = [](const Vec3f& v) { return std::abs(v.x) + std::abs(v.y) + std::abs(v.z); };
    light->density = static_cast<float>(std::min(double{light->density} * probability, kLargestDensity));
    const float radiance = size(light->radiance);
    if (!(radiance > 0.0f && radiance < kMostRadiance && light->density > 0.0f && size(light->direction) < kMostOfUnit))
        light.reset();
}

/// The state of a path with this ray length.
inline PathState of_length(PathState path, double length) {
    path.ray_length = static_cast<float>(length);
    return path;
}

}  // namespace rayleaf
