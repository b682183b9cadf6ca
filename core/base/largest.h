// The largest lengths and coordinates that are accepted.
#pragma once

#include "base/error.h"
#include "base/vector.h"

#include <cmath>
#include <string>

namespace rayleaf {

/// In units of the object or the world: the product of three such lengths is still a finite double.
inline constexpr double kLargestLength = 1e100;

/// The requirement on coordinates, for messages.
inline constexpr const char* kCoordinatesWanted = "finite numbers up to 1e100";

inline bool is_length(double value) {
    return std::abs(value) <= kLargestLength;
}
inline bool is_place(const Vec3d& point) {
    return is_length(point.x) && is_length(point.y) && is_length(point.z);
}

/// A point for messages.
inline std::string place_text(const Vec3d& point) {
    return '(' + number_text(point.x) + ", " + number_text(point.y) + ", " + number_text(point.z) + ')';
}

}  // namespace rayleaf
