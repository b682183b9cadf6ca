// The largest lengths and coordinates that come in.
#pragma once

#include "base/error.h"
#include "base/vector.h"

#include <cmath>
#include <string>

namespace rayleaf {

/// In the units of the object or the world: products of three such lengths still are doubles.
inline constexpr double kLargestLength = 1e100;

/// What is wanted of coordinates, for messages.
inline constexpr const char* kCoordinatesWanted = "finite numbers up to 1e100";

inline bool is_length(double value) {
    return std::abs(value) <= kLargestLength;
}
inline bool is_place(const Vec3d& point) {
    return is_length(point.x) && is_length(point.y) && is_length(point.z);
}

/// For messages.
inline std::string place_text(const Vec3d& point) {
    return '(' + number_text(point.x) + ", " + number_text(point.y) + ", " + number_text(point.z) + ')';
}

}  // namespace rayleaf
