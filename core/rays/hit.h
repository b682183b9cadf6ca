// Where a ray met a shape.
#pragma once

#include "base/vector.h"

#include <cstdint>

namespace rayleaf {

/// A hit in the local space of its shape (geometry/shape.h: centred, scaled to about [-1, 1]).
struct LocalHit {
    uint32_t primitive = 0;   ///< element of the shape: triangle, or Bezier patch before any splitting
    float u = 0, v = 0;       ///< triangle: weights of vertices 1 and 2. Patch: its parameters in [0,1]²
    Vec3d position{0, 0, 0};  ///< the point on the facet that was hit, exact to double precision
    Vec3f normal{0, 0, 1};    ///< of that facet by its winding; not unit, never zero
};

/// A hit in the scene.
struct Hit {
    double t = 0;           ///< along the world ray, world units
    uint32_t instance = 0;  ///< index of the instance
    LocalHit local;
};

}  // namespace rayleaf
