#include "scene/density_bounds.h"

#include <algorithm>
#include <limits>

namespace rayleaf {

DensityBounds& DensityBounds::operator+=(const DensityBounds& other) {
    majorant += other.majorant;
    certain += other.certain;
    residual += other.residual;
    limit += other.limit;
    mean += other.mean;
    return *this;
}

DensityBounds bounds_of(std::span<const FoundDensity> all, std::span<const FoundDensity> shown, float reserve) {
    Color least(std::numeric_limits<float>::infinity()), most(0.0f), sum(0.0f);
    float lookups = 0.0f;
    bool scatters = true;
    for (const FoundDensity& each : all) {
        scatters = scatters && each.scatters;
        for (int c = 0; c < 3; ++c) {
            least[c] = std::min(least[c], each.extinction[c]);
            most[c] = std::max(most[c], each.extinction[c]);
        }
        lookups = std::max(lookups, each.lookups);
    }
    for (const FoundDensity& each : shown) sum += each.extinction;
    DensityBounds bounds = DensityBounds::none();
    if (scatters) bounds.certain = std::min({least.x, least.y, least.z}) / reserve;
    bounds.majorant = bounds.limit = std::max(max_component(most), lookups) * reserve;
    for (int c = 0; c < 3; ++c) {
        bounds.mean[c] = std::clamp(sum[c] / static_cast<float>(shown.size()), least[c], most[c]);
        const float above = most[c] * reserve - bounds.mean[c], below = bounds.mean[c] - least[c] / reserve;
        bounds.residual = std::max({bounds.residual, above, below});
    }
    return bounds;
}

}  // namespace rayleaf
