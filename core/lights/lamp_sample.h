// What lamps are sampled by, shared by the files of this folder.
#pragma once

#include "base/vector.h"
#include "rays/ray.h"

#include <algorithm>
#include <cstdint>
#include <optional>

namespace rayleaf {

/// What a ray meets of one lamp.
struct LampIntersection {
    double t = 0;  ///< world units; infinity for suns
    Color radiance{0, 0, 0};
    double density = 0;  ///< with which the lamp alone is sampled there, per solid angle
};

/// Solid angles below this are sampled as if they had no extent: their densities would leave the range of floats.
/// No scattered ray can find them anyway.
constexpr double kSmallestSolidAngle = 1e-30;

/// Densities are clamped to this so that ratios of two of them stay finite.
constexpr double kLargestDensity = 1e35;

/// Solid angle of a cone with half angle `a`, from sin²(a); exact where the angle is tiny. Below a right angle only.
inline double cone_solid_angle(double sine_squared) {
    const double cosine = std::sqrt(std::max(0.0, 1.0 - sine_squared));
    return 2.0 * std::numbers::pi * sine_squared / (1.0 + cosine);
}

/// An orthonormal frame about a unit axis.
struct ConeFrame {
    Vec3d axis, tangent, bitangent;

    explicit ConeFrame(const Vec3d& axis);
};

/// A direction uniform in solid angle within a cone about the axis of a frame, given 1 - cos of its half angle. Returns
/// also 1 - cos of the angle to the axis, exact where it is tiny.
struct ConeDirection {
    Vec3d direction;
    double one_minus_cosine = 0;
};
ConeDirection sample_cone(const ConeFrame& frame, double one_minus_cosine, const Vec2f& random);

/// What a choice leaves of a random number, as a float in [0,1) again.
inline float below_one(double left_over) {
    return static_cast<float>(std::clamp(left_over, 0.0, 1.0 - 0x1p-24));
}

/// Whether a colour can be multiplied on without leaving the range of floats.
inline bool is_usable(const Color& c) {
    return is_finite(c) && max_abs(c) < 1e37f;
}

}  // namespace rayleaf
