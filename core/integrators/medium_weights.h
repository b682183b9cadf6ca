// How media weigh light, channel by channel.
#pragma once

#include "shading/closures.h"

#include <algorithm>
#include <cmath>

namespace rayleaf {

inline float exponential(float extinction, double t) {
    return extinction > 0.0f ? static_cast<float>(std::exp(-static_cast<double>(extinction) * t)) : 1.0f;
}

inline Color exponential(const Color& extinction, double t) {
    const float x = exponential(extinction.x, t);
    if (extinction.y == extinction.x && extinction.z == extinction.x) return Color(x);
    return {x, exponential(extinction.y, t), exponential(extinction.z, t)};
}

/// With which probability each channel decides on a distance: by how much of its light there is.
inline Color shares_of(const Color& throughput) {
    const Color size(std::max(throughput.x, 0.0f), std::max(throughput.y, 0.0f), std::max(throughput.z, 0.0f));
    const float sum = size.x + size.y + size.z;
    return sum > 0.0f && std::isfinite(sum) ? size / sum : Color(1.0f / 3.0f);
}

inline int channel_of(const Color& shares, float random) {
    if (random < shares.x) return 0;
    return random < shares.x + shares.y || !(shares.z > 0.0f) ? 1 : 2;
}

/// What is denser than the limit is as dense as that: else few paths would carry most of the light.
inline Closures limited(Closures closures, float limit) {
    MediumClosures& medium = closures.medium;
    const float largest = max_component(medium.extinction);
    if (!(largest > limit)) return closures;
    const float factor = limit / largest;
    medium.extinction *= factor;
    for (int i = 0; i < medium.count; ++i) medium.phases[static_cast<size_t>(i)].scattering *= factor;
    return closures;
}

}  // namespace rayleaf
