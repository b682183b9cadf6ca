// The eyes of a panorama: they turn with the direction of sight, so that there is depth all around. As in Cycles 3.4.
#pragma once

#include "base/vector.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

namespace rayleaf {

/// Of one eye. In camera space: -z forward, y up.
struct SphericalStereo {
    double offset = 0;                  ///< to the right of the direction of sight, world units; 0: no stereo
    std::optional<double> convergence;  ///< where both eyes look at the same place; empty: they look in parallel
    /// Angles above and below the horizon, radians: eyes draw near each other from the first on and are one from the
    /// second on. Empty: nowhere.
    std::optional<std::pair<double, double>> pole_merge;
};

/// Where the eye is that sees a unit direction.
inline Vec3d eye_place(const SphericalStereo& eye, const Vec3d& direction) {
    double offset = eye.offset;
    if (eye.pole_merge) {
        const auto [from, to] = *eye.pole_merge;
        const double altitude = std::abs(std::asin(std::clamp(direction.y, -1.0, 1.0)));
        if (altitude > to)
            offset = 0.0;
        else if (altitude > from)
            offset *= std::cos((altitude - from) / (to - from) * std::numbers::pi / 2);
    }
    return normalized_or(direction.cross(Vec3d(0, 1, 0)), Vec3d(0.0)) * offset;
}

/// Where it looks from there.
inline Vec3d eye_direction(const SphericalStereo& eye, const Vec3d& place, const Vec3d& direction) {
    return eye.convergence ? normalized_or(direction * *eye.convergence - place, direction) : direction;
}

}  // namespace rayleaf
