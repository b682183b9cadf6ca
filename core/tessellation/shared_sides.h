// Directions of splines that must be split alike, because splines of one surface share a border there: the same control
// points, bit by bit, in either direction.
#pragma once

#include "base/joined_sets.h"
#include "geometry/patch_surface.h"

#include <cstdint>

namespace rayleaf {

class SharedSides {
  public:
    explicit SharedSides(const PatchSurface& surface);

    /// Equal for directions that are split together: along u (0) or v (1) of a spline.
    uint32_t group(size_t spline, int axis) { return groups_.root(number(spline, axis)); }

  private:
    JoinedSets groups_;

    static uint32_t number(size_t spline, int axis) { return static_cast<uint32_t>(2 * spline) + (axis == 0 ? 0 : 1); }
};

}  // namespace rayleaf
