// A normal bent by a height that varies over the surface.
#pragma once

#include "base/vector.h"
#include "rays/ray_differential.h"

namespace rayleaf {

/// Heights at a point and one pixel step to the right and up, world units.
struct Heights {
    float here = 0, right = 0, above = 0;
};

/// The unit normal of the surface raised by the heights along `normal`, which is unit (Mikkelsen, "Bump Mapping
/// Unparametrized Surfaces on the GPU", 2010). Strength 0 is `normal`, 1 the whole bump. `normal` where the footprint
/// has no area, or a height is not finite.
Vec3f bump_normal(const Vec3f& normal, const RayDifferential& footprint, const Heights& heights, float strength);

}  // namespace rayleaf
