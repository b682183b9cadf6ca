// How far a point is from a box.
#pragma once

#include "base/vector.h"

#include <algorithm>

namespace rayleaf {

/// From the nearest point of the box, which must not be empty; 0 inside.
inline double distance(const Box3d& box, const Vec3d& point) {
    Vec3d outside;
    for (int axis = 0; axis < 3; ++axis)
        outside[axis] = std::max({box.min[axis] - point[axis], 0.0, point[axis] - box.max[axis]});
    return outside.length();
}

}  // namespace rayleaf
