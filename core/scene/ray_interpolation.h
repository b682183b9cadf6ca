// What an artist sets for ray interpolation: of the scene, or of one object in its place.
#pragma once

#include "ri_tree/ray_cache.h"

#include <cstdint>
#include <optional>
#include <string>

namespace rayleaf {

enum class RayInterpolationMode : uint8_t {
    Off,
    Auto,  ///< where a probe of the frame measures a gain (render/ray_cache_probe.h)
    On
};

/// The default error bound of interpolation (ri_tree/ray_cache.h: quality_settings).
inline constexpr double kDefaultRayError = 0.005;

/// The thresholds that together keep the error near `error`. Throws InputError unless it is above 0 and finite.
RayCacheSettings thresholds_for(double error);

struct RayInterpolation {
    RayInterpolationMode mode = RayInterpolationMode::Off;
    RayCacheSettings thresholds = thresholds_for(kDefaultRayError);

    bool operator==(const RayInterpolation&) const = default;
};

/// Throws InputError that names `object` and the first number without meaning.
void validate(const std::string& object, const RayInterpolation& interpolation);

}  // namespace rayleaf
