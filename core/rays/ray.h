// A ray in world space, or in a shape's local space where the name says so.
#pragma once

#include "base/vector.h"

#include <limits>

namespace rayleaf {

struct Ray {
    Vec3d origin{0, 0, 0};                                   ///< world units
    Vec3d direction{0, 0, 1};                                ///< unit length, points away from the origin
    double t_min = 0.0;                                      ///< hits nearer than this are ignored, world units
    double t_max = std::numeric_limits<double>::infinity();  ///< and those beyond this

    Vec3d at(double t) const { return origin + direction * t; }
};

}  // namespace rayleaf
