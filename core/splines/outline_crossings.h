// Whether closed polygons cross each other or themselves.
#pragma once

#include "base/vector.h"

#include <cstdint>
#include <span>

namespace rayleaf {

/// Polygon k has the points from begins[k] to begins[k + 1], exclusive; the last entry is the number of points. Edges
/// that only touch do not cross.
bool outlines_cross(std::span<const Vec2f> points, std::span<const uint32_t> begins);

}  // namespace rayleaf
